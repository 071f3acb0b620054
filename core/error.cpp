/// Texts of errors and outcomes, and the search for the nearest known name.
#include "core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>

namespace rosin {

std::string name(Ending ending) {
  switch (ending) {
    case Ending::reached_end:
      return "reached the end";
    case Ending::event:
      return "event";
    case Ending::none_exists:
      return "none exists";
    case Ending::tolerance_not_met:
      return "tolerance not met";
    case Ending::budget_spent:
      return "budget spent";
    case Ending::not_finite:
      return "not finite";
    case Ending::unbounded:
      return "grows without bound";
    case Ending::interrupted:
      return "interrupted";
  }
  return "unknown";
}

std::string readable_unit(std::string_view unit) { return unit == "1" ? "dimensionless" : std::string(unit); }

std::string text(const Range& range) {
  std::string interval = fmt::format("{} … {}", range.low, range.high);
  if (range.smallest > 0) interval += fmt::format(", with magnitudes other than 0 from {} on", range.smallest);
  if (range.largest < infinity) interval += fmt::format(" up to {}", range.largest);
  return interval;
}

void require(double value, const Range& range, std::string_view path, std::string_view meaning, std::string_view unit) {
  if (std::isnan(value))
    throw InputError(fmt::format("{} is not a number (NaN) ({}, {})", path, meaning, readable_unit(unit)));
  if (range.contains(value)) return;
  throw InputError(
      fmt::format("{} = {} is outside {} ({}, {})", path, value, text(range), meaning, readable_unit(unit)));
}

std::string nearest_name(std::string_view asked, const std::vector<std::string>& known) {
  const auto lower = [](std::string_view text) {
    std::string small(text);
    for (char& c : small) c = char(std::tolower(static_cast<unsigned char>(c)));
    return small;
  };
  const std::string name = lower(asked);
  // Levenshtein distance by rows, whatever the case.
  const auto distance = [&](const std::string& other) {
    std::vector<std::size_t> row(other.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= name.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= other.size(); ++j) {
        const std::size_t substitute = diagonal + (name[i - 1] != other[j - 1]);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
      }
    }
    return row.back();
  };
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const auto& candidate : known) {
    const auto d = distance(lower(candidate));
    const bool alike = 2 * d <= std::max(name.size(), candidate.size());  // half of it stays, or more
    if (alike && d < best_distance) best_distance = d, best = candidate;
  }
  // The characteristic slip of rate-and-state friction, D_c in many papers, is L here.
  if (best.empty() && (name == "dc" || name == "d_c") && std::ranges::find(known, "L") != known.end()) return "L";
  return best;
}

}  // namespace rosin
