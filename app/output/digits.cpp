/// Digits down to the decade of the error.
#include "app/output/digits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rosin::app::output {

namespace {

/// To the decade of the error.
double rounded(double value, double error) {
  const double decade = std::pow(10, std::floor(std::log10(error)));
  return std::round(value / decade) * decade;
}

}  // namespace

std::string digits_by_error(double value, double error) {
  if (!(error > 0)) return fmt::format("{:.10g}", value);
  constexpr double most = 16, most_plain = 6;
  const double whole = std::floor(std::log10(std::abs(value))) + 1, kept = whole - std::floor(std::log10(error));
  if (!(kept >= 1)) return "0";
  if (kept <= whole && whole <= most_plain) return fmt::format("{:.0f}", rounded(value, error));
  const int shown = int(std::min(kept, most));
  return kept > whole ? fmt::format("{:#.{}g}", value, shown) : fmt::format("{:.{}g}", value, shown);
}

std::string with_error(double value, double error) {
  if (!std::isfinite(value) || !std::isfinite(error) || !(error > 0)) return fmt::format("{:.4g}", value);
  return fmt::format("{} ± {:g}", digits_by_error(value, error), rounded(error, error));
}

}  // namespace rosin::app::output
