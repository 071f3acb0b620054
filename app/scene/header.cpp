/// Taking a header apart; a unit is what UDUNITS knows, short enough not to be a word.
#include "app/scene/header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "app/scene/reference.hpp"
#include "core/error.hpp"
#include "core/units.hpp"

namespace rosin::app::scene {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  std::string result;
  std::string_view rest = text;
  for (auto at = rest.find(from); at != std::string_view::npos; at = rest.find(from)) {
    result.append(rest.substr(0, at)).append(to);
    rest.remove_prefix(at + from.size());
  }
  text = result.append(rest);
}

/// The unit with either micro sign as u; a dash, which tables write for none, is 1.
std::string spelt(std::string_view text) {
  std::string unit(trimmed(text));
  for (const char* dash : {"-", "–", "—"})
    if (unit == dash) return "1";
  replace_all(unit, "µ", "u"), replace_all(unit, "μ", "u");
  return unit;
}

constexpr std::array<std::pair<char, char>, 4> brackets = {{{'(', ')'}, {'[', ']'}, {'{', '}'}, {'<', '>'}}};

bool one_letter(std::string_view text) { return text.size() == 1; }

/// "mm_s" as "mm/s", "N_s_m" as "N s/m", "mm_per_s" as "mm/s".
std::string from_suffix(std::string suffix) {
  replace_all(suffix, "_per_", "/");
  if (suffix.find('/') == std::string::npos)
    if (const auto last = suffix.rfind('_'); last != std::string::npos) suffix[last] = '/';
  std::ranges::replace(suffix, '_', ' ');
  return suffix;
}

/// The same to rounding: "mm/s" and "mm s-1".
bool same_unit(const TextUnit& a, const TextUnit& b) {
  constexpr double rounding = 1e-9;
  return a.dimension == b.dimension && std::abs(a.factor / b.factor - 1) < rounding;
}

}  // namespace

bool looks_like_unit(const std::string& text) {
  constexpr std::size_t word = 4;  // letters in runs of at most three: longer ones are words, as "force" is to UDUNITS
  if (text == "mu") return false;  // friction, not a thousandth of the atomic mass unit
  for (const char* unit : {"micron", "microns", "microstrain", "ustrain", "newton", "newtons", "volt", "volts",
                           "degree", "degrees", "percent", "counts", "%", "°"})
    if (text == unit) return true;  // these name nothing else
  std::size_t letters = 0, run = 0;
  for (const char c : text) {
    run = std::isalpha(static_cast<unsigned char>(c)) ? run + 1 : 0;
    letters += run > 0;
    if (run >= word) return false;
  }
  const bool begins = !text.empty() && (std::isalpha(static_cast<unsigned char>(text.front())) ||
                                        static_cast<unsigned char>(text.front()) >= 0x80 || text.starts_with("1/"));
  return letters > 0 && begins && unit_known(text);
}

std::string unit_cell(std::string_view text) {
  auto cell = trimmed(text);
  for (const auto& [open, close] : brackets)
    if (cell.size() >= 2 && cell.front() == open && cell.back() == close) cell = cell.substr(1, cell.size() - 2);
  return spelt(cell);
}

namespace {
/// Of the bracket that the last character closes: "response (Pa/(N s))" has one within. npos: there is none.
std::size_t opening_of_last(std::string_view text, char open, char close) {
  int depth = 0;
  for (auto at = text.size(); at-- > 0;) {
    depth += text[at] == close ? 1 : text[at] == open ? -1 : 0;
    if (depth == 0) return text[at] == open ? at : std::string_view::npos;
  }
  return std::string_view::npos;
}
}  // namespace

HeaderCell header_cell(std::string_view text) {
  const auto whole = trimmed(text);
  HeaderCell cell{std::string(whole), std::string(whole), ""};
  const auto take = [&](std::size_t name_ends, std::string unit) {
    cell.name = std::string(trimmed(whole.substr(0, name_ends)));
    for (const std::string_view link : {"/", " in"})
      if (cell.name.ends_with(link))
        cell.name = std::string(trimmed(std::string_view(cell.name).substr(0, cell.name.size() - link.size())));
    cell.unit = std::move(unit);
    return cell;
  };
  for (const auto& [open, close] : brackets)
    if (const auto at = opening_of_last(whole, open, close); whole.ends_with(close) && at != std::string_view::npos)
      return take(at, spelt(whole.substr(at + 1, whole.size() - at - 2)));
  for (const auto& [open, close] : brackets)  // "load [kN] filtered"
    if (const auto at = whole.find(open), end = whole.find(close, at); end != std::string_view::npos)
      if (auto unit = spelt(whole.substr(at + 1, end - at - 1)); looks_like_unit(unit))
        return take(at, std::move(unit));
  const auto after = [&](std::string_view mark) {
    const auto at = whole.find(mark);
    if (at == std::string_view::npos || at == 0) return false;
    auto unit = spelt(whole.substr(at + mark.size()));
    if (!looks_like_unit(unit) && unit != "1") return false;
    take(at, std::move(unit));
    return true;
  };
  if (after(" / ") || after(",")) return cell;
  if (const auto at = whole.rfind(' '); at != std::string_view::npos)
    if (auto unit = spelt(whole.substr(at + 1)); looks_like_unit(unit)) {
      cell.may_be_name = one_letter(unit);
      return take(at, std::move(unit));
    }
  if (after("/")) return cell;
  for (const char mark : {':', '.', '-'})
    if (const auto at = whole.rfind(mark); at != std::string_view::npos && at > 0)
      if (auto unit = spelt(whole.substr(at + 1)); looks_like_unit(unit)) {
        cell.may_be_name = one_letter(unit);
        return take(at, std::move(unit));
      }
  for (auto at = whole.find('_', 1); at != std::string_view::npos; at = whole.find('_', at + 1))
    if (auto unit = from_suffix(spelt(whole.substr(at + 1))); looks_like_unit(unit)) {
      cell.may_be_name = one_letter(unit);
      return take(at, std::move(unit));
    }
  return cell;
}

int find_column(const std::vector<HeaderCell>& cells, std::string_view name) {
  for (const auto part : {&HeaderCell::text, &HeaderCell::name}) {
    const auto count = std::ranges::count(cells, name, part);
    if (count > 1) return -2;
    if (count == 1) return int(std::ranges::find(cells, name, part) - cells.begin());
  }
  return -1;
}

namespace {
/// A length where a speed is needed: what most rigs record.
bool is_displacement(const std::string& unit, const std::string& needed) {
  const auto parsed = parse_unit(unit), length = parse_unit("m");
  return needed == "m/s" && parsed && length && parsed->dimension == length->dimension;
}
}  // namespace

Conversion conversion_to_si(const HeaderCell& cell, const RecordColumn& column) {
  const bool calibrated = column.factor || column.offset != 0;
  const std::string given = spelt(column.unit), &unit = given.empty() ? cell.unit : given;
  const auto refuse = [&](const std::string& why) { throw InputError(fmt::format("column '{}': {}", cell.text, why)); };
  if (!given.empty() && !calibrated && !cell.unit.empty()) {
    const auto ours = parse_unit(given), theirs = parse_unit(cell.unit);
    const bool part_of_name = cell.may_be_name && ours && theirs && !(ours->dimension == theirs->dimension);
    if (ours && theirs && !part_of_name && !same_unit(*ours, *theirs))
      refuse(
          fmt::format("the file says {}, the scene {}; leave out the scene's unit, correct the "
                      "file's, or overrule it by factor = 1 beside the unit",
                      cell.unit, given));
  }
  if (unit.empty() && column.unit_needed)
    refuse(
        fmt::format("no unit is given; write it in the header, as \"{} ({})\", or in the scene: {{ column = …, unit "
                    "= \"{}\" }}",
                    cell.name.empty() ? "name" : cell.name, column.si, column.si));
  double scale = 1;
  if (!unit.empty()) try {
      if (const auto parsed = parse_unit(unit); parsed && parsed->offset)
        throw InputError(fmt::format("{} counts from another zero, or is no factor at all", unit));
      scale = Reference::to_si("1 " + unit, column.si);
    } catch (const InputError& error) {
      if (!given.empty() || !cell.may_be_name)
        refuse(given.empty() && calibrated
                   ? fmt::format("{}; give the unit of number·factor + offset: {{ column = …, unit = \"{}\", … }}",
                                 error.what(), column.si)
               : is_displacement(unit, column.si)
                   ? fmt::format("{}; a displacement goes by a key of its own: displacement in place of slip_rate",
                                 error.what())
                   : fmt::format("{}; correct the unit in the header, which may stand as \"{} ({})\"{}", error.what(),
                                 cell.name, column.si,
                                 given.empty() ? ", or give it in the scene: { column = …, unit = … }, with factor and "
                                                 "offset where a sensor's number is calibrated"
                                               : ""));
    }
  return {column.factor.value_or(1) * scale, column.offset * scale};
}

}  // namespace rosin::app::scene
