/// Taking a header apart; a unit is what UDUNITS knows, short enough not to be a word.
#include "app/scene/header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

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
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// The unit with either micro sign as u; a dash, which tables write for none, is 1.
std::string spelt(std::string_view text) {
  std::string unit(trimmed(text));
  for (const char* dash : {"-", "–", "—"})
    if (unit == dash) return "1";
  replace_all(unit, "µ", "u"), replace_all(unit, "μ", "u");
  return unit;
}

/// A unit without brackets around it: of letters in runs of at most three, because longer ones are words ("force" is a
/// unit to UDUNITS).
bool looks_like_unit(const std::string& text) {
  constexpr std::size_t word = 4;
  std::size_t letters = 0, run = 0;
  for (const char c : text) {
    run = std::isalpha(static_cast<unsigned char>(c)) ? run + 1 : 0;
    letters += run > 0;
    if (run >= word) return false;
  }
  return letters > 0 && std::isalpha(static_cast<unsigned char>(text.front())) && unit_known(text);
}

bool one_letter(std::string_view text) { return text.size() == 1; }

/// "mm_s" as "mm/s", "N_s_m" as "N s/m", "mm_per_s" as "mm/s".
std::string from_suffix(std::string suffix) {
  replace_all(suffix, "_per_", "/");
  if (suffix.find('/') == std::string::npos)
    if (const auto last = suffix.rfind('_'); last != std::string::npos) suffix[last] = '/';
  std::ranges::replace(suffix, '_', ' ');
  return suffix;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  bool quoted = false, bracketed = false;  // blanks between brackets separate nothing
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    const char c = i < line.size() ? line[i] : separator;
    if (c == '"') quoted = !quoted;
    if (separator == ' ' && (c == '(' || c == '[')) bracketed = true;
    if (c == ')' || c == ']') bracketed = false;
    if (i < line.size() && (quoted || bracketed || c != separator)) continue;
    const auto cell = trimmed(line.substr(begin, i - begin));
    begin = i + 1;
    const bool bracket = !cell.empty() && (cell.front() == '(' || cell.front() == '[');
    if (separator == ' ' && bracket && !cells.empty())  // belongs to the name before it
      cells.back() =
          std::string_view(cells.back().data(), std::size_t(cell.data() + cell.size() - cells.back().data()));
    else if (separator != ' ' || !cell.empty())
      cells.push_back(cell);
  }
  return cells;
}

char separator_of(std::string_view line) {
  bool quoted = false;
  for (const char separator : {',', ';', '\t'})
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c == separator && !quoted) return separator;
    }
  return ' ';
}

}  // namespace

HeaderCell header_cell(std::string_view text) {
  const auto whole = trimmed(text);
  HeaderCell cell{std::string(whole), std::string(whole), ""};
  const auto take = [&](std::size_t name_ends, std::string unit) {
    cell.name = std::string(trimmed(whole.substr(0, name_ends)));
    if (cell.name.ends_with('/'))
      cell.name = std::string(trimmed(std::string_view(cell.name).substr(0, cell.name.size() - 1)));
    cell.unit = std::move(unit);
    return cell;
  };
  for (const auto& [open, close] : {std::pair{'(', ')'}, std::pair{'[', ']'}})
    if (const auto at = whole.rfind(open); whole.ends_with(close) && at != std::string_view::npos)
      return take(at, spelt(whole.substr(at + 1, whole.size() - at - 2)));
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
      cell.may_be_subscript = one_letter(unit);
      return take(at, std::move(unit));
    }
  if (after("/")) return cell;
  for (auto at = whole.find('_', 1); at != std::string_view::npos; at = whole.find('_', at + 1))
    if (auto unit = from_suffix(spelt(whole.substr(at + 1))); looks_like_unit(unit)) {
      cell.may_be_subscript = one_letter(unit);
      return take(at, std::move(unit));
    }
  return cell;
}

Header read_header(std::string_view line) {
  Header header{separator_of(line), {}};
  for (const auto cell : split(line, header.separator)) header.cells.push_back(header_cell(cell));
  return header;
}

const HeaderCell* find_column(const std::vector<HeaderCell>& cells, std::string_view name) {
  for (const auto part : {&HeaderCell::text, &HeaderCell::name})
    if (const auto found = std::ranges::find(cells, name, part); found != cells.end()) return &*found;
  return nullptr;
}

double to_si_factor(const HeaderCell& cell, std::string_view given, std::string_view si) {
  const std::string unit = given.empty() ? cell.unit : spelt(given);
  if (unit.empty()) return 1;
  try {
    if (const auto parsed = parse_unit(unit); parsed && parsed->offset)
      throw InputError(fmt::format("{} counts from another zero, or is no factor at all", unit));
    return to_si("1 " + unit, si);
  } catch (const InputError& error) {
    if (given.empty() && cell.may_be_subscript) return 1;
    throw InputError(
        fmt::format("column '{}': {}; correct the unit in the header, which may stand as \"{} ({})\"{}", cell.text,
                    error.what(), cell.name, si,
                    given.empty() ? ", or give it in the scene where a column may be { column = …, unit = … }" : ""));
  }
}

bool names_units(std::string_view comment) {
  const auto header = read_header(comment);
  return std::ranges::all_of(header.cells, [](const HeaderCell& cell) {
    return (cell.text.ends_with(')') || cell.text.ends_with(']')) && !cell.unit.empty() && unit_known(cell.unit);
  });
}

bool holds_units(std::string_view line) {
  const auto cells = split(line, separator_of(line));
  const auto is_unit = [](std::string_view cell) {
    if (!cell.empty() && (cell.front() == '(' || cell.front() == '[')) cell = cell.substr(1, cell.size() - 2);
    const auto unit = spelt(cell);
    return unit == "1" || looks_like_unit(unit);
  };
  return !cells.empty() && std::ranges::all_of(cells, is_unit) &&
         std::ranges::any_of(cells, [](std::string_view cell) { return looks_like_unit(spelt(cell)); });
}

}  // namespace rosin::app::scene
