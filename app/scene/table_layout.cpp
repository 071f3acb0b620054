/// Finding out the layout of a table: the dialect by which most cells are numbers, and names and units above them.
#include "app/scene/table_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/scene/table_cells.hpp"
#include "core/error.hpp"
#include "core/units.hpp"

namespace rosin::app::scene {

namespace {

struct Dialect {
  char separator, decimal;
};
/// Those before come first where rows speak for both.
constexpr std::array<Dialect, 8> dialects = {
    {{'\t', '.'}, {'\t', ','}, {';', '.'}, {';', ','}, {',', '.'}, {' ', '.'}, {' ', ','}, {',', ','}}};

/// The kinds of a line's cells, one letter each: "NN-T".
std::string kinds_of(std::string_view text, const Dialect& dialect) {
  std::string kinds;
  double value = 0;
  auto rest = without_comment(text);
  for (std::string_view cell; next_cell(rest, dialect.separator, cell);)
    kinds += char(read_cell(cell, dialect.decimal, value));
  return kinds;
}

/// A cell that is no number but holds what would separate cells otherwise: these are rather another dialect's.
bool holds_separator(std::string_view cell, const Dialect& dialect) {
  for (const char c : {',', ';', '\t'})
    if (c != dialect.separator && cell.find(c) != std::string_view::npos) return true;
  double value = 0;
  auto rest = cell;
  int pieces = 0, numbers = 0;
  for (std::string_view piece; next_cell(rest, ' ', piece); ++pieces)
    numbers += read_cell(piece, dialect.decimal, value) == Kind::number;
  return pieces > 1 && numbers > 0;
}

/// A run of lines with numbers in the same columns.
struct Run {
  std::size_t begin = 0, rows = 0;
  std::string kinds;  ///< of its columns: N where there is a number in any row
  double score = -1e300;
};

bool fits(std::string_view kinds, std::string_view run) {
  if (kinds.size() != run.size()) return false;
  for (std::size_t c = 0; c < run.size(); ++c)
    if ((run[c] == 'N' && kinds[c] == 'T') || (run[c] == 'T' && kinds[c] == 'N')) return false;
  return true;
}

/// The run for which most speaks: a number counts 1, a text takes a quarter off, and more where it holds a separator.
Run best_run(const std::vector<TableLine>& lines, const Dialect& dialect, std::size_t first) {
  Run best, run;
  for (std::size_t i = first; i < lines.size(); ++i) {
    if (lines[i].comment) continue;
    const auto kinds = kinds_of(lines[i].text, dialect);
    const bool has_number = kinds.find('N') != std::string::npos;
    const bool all_missing = kinds.size() > 1 && kinds.find_first_of("NT") == std::string::npos;
    const bool goes_on = run.rows > 0 && (has_number || all_missing) && fits(kinds, run.kinds);
    if (!goes_on) {
      run = {};
      if (!has_number) continue;
      run = {i, 0, kinds, 0};
    }
    ++run.rows;
    auto rest = without_comment(lines[i].text);
    std::string_view cell;
    for (std::size_t c = 0; next_cell(rest, dialect.separator, cell); ++c) {
      if (kinds[c] != '-') run.kinds[c] = kinds[c];
      constexpr double text = 0.25, hidden_cells = 2;
      if (kinds[c] == 'N') run.score += 1;
      if (kinds[c] == 'T') run.score -= holds_separator(cell, dialect) ? hidden_cells : text;
    }
    if (run.score > best.score) best = run;
  }
  return best;
}

/// The cells of a line of names or units. Blanks between brackets separate nothing, and a bracket belongs to the name
/// before it.
std::vector<std::string> split(std::string_view line, char separator) {
  std::vector<std::string> cells;
  bool quoted = false, bracketed = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    const char c = i < line.size() ? line[i] : separator;
    if (c == '"') quoted = !quoted;
    if (c == '(' || c == '[') bracketed = separator == ' ';
    if (c == ')' || c == ']') bracketed = false;
    if (i < line.size() && (quoted || bracketed || (separator == ' ' ? c != ' ' && c != '\t' : c != separator)))
      continue;
    const auto cell = trimmed(line.substr(begin, i - begin));
    begin = i + 1;
    const bool bracket = !cell.empty() && (cell.front() == '(' || cell.front() == '[');
    if (separator == ' ' && bracket && !cells.empty())
      cells.back() += " " + in_utf8(cell);
    else if (separator != ' ' || !cell.empty())
      cells.push_back(in_utf8(cell));
  }
  return cells;
}

/// Cells of fixed width behind a margin for the record numbers, as xlook writes its head.
std::vector<std::string> split_xlook(std::string_view line) {
  constexpr std::size_t margin = 5, width = 12;
  std::vector<std::string> cells;
  for (auto at = margin; at < line.size(); at += width) cells.push_back(in_utf8(trimmed(line.substr(at, width))));
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
  return cells;
}

/// Two blanks or more between cells that may hold single ones.
std::vector<std::string> split_wide(std::string_view line) {
  std::string text(trimmed(line));
  for (auto at = text.find("  "); at != std::string::npos; at = text.find("  ", at)) {
    const auto end = std::min(text.find_first_not_of(' ', at), text.size());
    text.replace(at, end - at, "\t");
  }
  return split(text, '\t');
}

bool is_dash(const std::string& cell) { return unit_cell(cell) == "1"; }

/// What a line says of units: how many of its cells are units, how many are words.
struct UnitCount {
  int units = 0, none = 0, words = 0;
  bool long_units = false;  ///< of two letters or more, which names seldom are
};
UnitCount count_units(const std::vector<std::string>& cells) {
  UnitCount count;
  for (const auto& cell : cells) {
    const auto unit = unit_cell(cell);
    if (unit.empty() || unit == "1" || unit == ".")
      ++count.none;
    else if (looks_like_unit(unit))
      ++count.units, count.long_units |= unit.size() > 1;
    else
      ++count.words;
  }
  return count;
}

/// "Unit", before the units of the other columns.
bool announces_units(const std::string& cell) {
  auto word = lower(unit_cell(cell));
  while (!word.empty() && (word.back() == ':' || word.back() == ' ')) word.pop_back();
  for (const char* one : {"unit", "units", "einheit", "einheiten", "unit\u00e9", "unit\u00e9s", "unidad", "unidades"})
    if (word == one) return true;
  return false;
}

/// "5400 recs", or a line ruled with dashes.
bool says_nothing(const std::vector<std::string>& cells) {
  return std::ranges::all_of(cells, [](const std::string& cell) {
    const bool ruled = cell.size() > 2 && cell.find_first_not_of("-=+|_") == std::string::npos;
    const auto digits = std::min(cell.find_first_not_of("0123456789"), cell.size());
    return cell.empty() || ruled || (digits > 0 && trimmed(std::string_view(cell).substr(digits)) == "recs");
  });
}

/// Cells of a line of texts, brought to one for each column of the rows where that can be done; else as they are.
struct HeadLines {
  const std::vector<TableLine>& lines;
  Dialect dialect;
  std::size_t columns;
  bool xlook;
  bool first_counts;   ///< the first column numbers the records
  bool last_is_empty;  ///< each row ends with a separator

  std::vector<std::string> cells(std::size_t index) const {
    auto text = lines[index].text;
    if (lines[index].comment) {
      text = trimmed(text);
      text.remove_prefix(std::min(text.find_first_not_of("#%"), text.size()));
      text = trimmed(text);
    }
    if (xlook) return completed(split_xlook(text));
    auto cells = completed(split(text, dialect.separator));
    if (cells.size() == columns || dialect.separator != ' ') return cells;
    for (const char other : {'\t', ';', ','})
      if (auto found = completed(split(text, other)); found.size() == columns) return found;
    if (auto found = completed(split_wide(text)); found.size() == columns) return found;
    return cells;
  }

 private:
  std::vector<std::string> completed(std::vector<std::string> cells) const {
    if (cells.size() == columns + 1 && (cells.back().empty() || lower(cells.back()) == "comment")) cells.pop_back();
    if (cells.size() > columns) {  // "speed, mm/s, load, N"
      std::vector<std::string> joined;
      bool has_unit = true;  // the last of them
      for (const auto& cell : cells) {
        const bool unit = !has_unit && (looks_like_unit(unit_cell(cell)) || is_dash(cell));
        if (unit)
          joined.back() += ", " + cell;
        else
          joined.push_back(cell);
        has_unit = unit;
      }
      if (joined.size() == columns) return joined;
    }
    if (cells.size() + 1 == columns && last_is_empty) cells.emplace_back();
    // not between commas, where rows of one cell more may hold a decimal comma
    if (cells.size() + 1 == columns && cells.size() > 1 && first_counts && dialect.separator != ',')
      cells.insert(cells.begin(), "");
    return cells;
  }
};

/// The first column of a run grows by 1 from row to row.
bool counts(const std::vector<TableLine>& lines, const Run& run, const Dialect& dialect) {
  double before = 0;
  std::size_t rows = 0;
  for (std::size_t i = run.begin; i < lines.size() && rows < run.rows; ++i) {
    if (lines[i].comment) continue;
    auto rest = lines[i].text;
    std::string_view cell;
    double value = 0;
    if (!next_cell(rest, dialect.separator, cell) || read_number(cell, dialect.decimal, value) != Kind::number)
      return false;
    if (rows > 0 && value != before + 1) return false;
    before = value;
    ++rows;
  }
  return true;
}

/// Whatever may separate them.
bool holds_numbers(std::string_view text) {
  std::string pieces(text);
  std::ranges::replace_if(
      pieces, [](char c) { return c == ',' || c == ';' || c == '"'; }, ' ');
  std::string_view rest = pieces;
  double value = 0;
  for (std::string_view piece; next_cell(rest, ' ', piece);)
    if (read_number(piece, '.', value) == Kind::number) return true;
  return false;
}

std::string named(char separator) {
  return separator == ' ' ? "blanks" : separator == '\t' ? "tabs" : fmt::format("'{}'", separator);
}

std::string lines_text(long count) { return fmt::format("{} line{}", count, count == 1 ? "" : "s"); }

/// One to three digits before three others: "1,234" may be 1.234 or 1234.
bool may_be_thousands(std::string_view cell) {
  if (!cell.empty() && (cell.front() == '-' || cell.front() == '+')) cell.remove_prefix(1);
  const auto comma = cell.find(',');
  const auto digits = [](std::string_view part) {
    return std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; });
  };
  return comma >= 1 && comma <= 3 && cell.size() == comma + 4 && cell.front() != '0' && digits(cell.substr(0, comma)) &&
         digits(cell.substr(comma + 1));
}

class Finder {
 public:
  Finder(const std::string& path, const std::vector<TableLine>& lines, const TableKeys& keys)
      : path_(path), lines_(lines), keys_(keys) {}

  TableLayout layout() {
    choose_dialect();
    if (dialect_.decimal == ',' && !keys_.decimal) refuse_doubtful_commas();
    if (keys_.names_line > 0)
      take_given_names();
    else
      find_names();
    while (body_ < run_.begin && lines_[body_].comment) ++body_;
    refuse_lost_rows();
    name_columns();
    find_clocks();
    refuse_odd_rows();
    const auto first = std::min(body_, run_.begin);
    head_.first_line = lines_[first].number;
    head_.skipped = head_.first_line - 1 - (names_ != none ? 1 : 0) - (units_ != none ? 1 : 0);
    return {head_, first};
  }

 private:
  static constexpr auto none = std::size_t(-1);

  [[noreturn]] void refuse(long line, const std::string& why) const {
    throw InputError(fmt::format("{}:{}: {}", path_, line, why));
  }
  std::string kinds(std::size_t i) const { return kinds_of(lines_[i].text, dialect_); }
  bool is_text(std::size_t i) const {
    const auto found = kinds(i);
    return found.find('N') == std::string::npos && found.find('T') != std::string::npos;
  }
  std::vector<std::string> cells(std::size_t i) const {
    return HeadLines{lines_, dialect_, columns(), xlook_, first_counts_, last_is_empty_}.cells(i);
  }
  std::size_t columns() const { return run_.kinds.size(); }

  /// By the run for which most speaks.
  void choose_dialect() {
    const auto first = std::ranges::find_if(lines_, [&](const auto& line) { return line.number > keys_.names_line; });
    for (const auto& candidate : dialects) {
      if (keys_.decimal && candidate.decimal != keys_.decimal) continue;
      auto found = best_run(lines_, candidate, std::size_t(first - lines_.begin()));
      if (found.score > run_.score) run_ = std::move(found), dialect_ = candidate;
    }
    if (run_.rows == 0)
      throw InputError(
          fmt::format("{}: has 0 samples: no line of it holds numbers{}", path_,
                      keys_.names_line > 0 ? fmt::format(" below names_line = {}", keys_.names_line) : ""));
    xlook_ = lower(lines_.front().text).starts_with("number of records");
    first_counts_ = counts(lines_, run_, dialect_);
    last_is_empty_ = columns() > 1 && run_.kinds.back() == '-';
    head_.separator = dialect_.separator, head_.decimal = dialect_.decimal;
  }

  void refuse_doubtful_commas() const {
    std::string_view doubtful;
    long line = 0;
    for (std::size_t i = run_.begin; i < lines_.size(); ++i) {
      auto rest = without_comment(lines_[i].text);
      for (std::string_view cell; next_cell(rest, dialect_.separator, cell);) {
        if (cell.find(',') == std::string_view::npos) continue;
        if (!may_be_thousands(cell)) return;
        if (doubtful.empty()) doubtful = cell, line = lines_[i].number;
      }
    }
    refuse(line, fmt::format("'{}' may be a number with three decimals or one of thousands; say decimal = \",\" beside "
                             "the file's name, or write the numbers without commas for thousands",
                             doubtful));
  }

  /// The cells of a line without a first one that announces units.
  std::vector<std::string> cells_of_units(std::size_t i) const {
    auto found = cells(i);
    if (!found.empty() && announces_units(found.front())) found.front().clear();
    return found;
  }
  /// A unit for each column, or words among more units.
  bool holds_units(std::size_t i) const {
    const auto found = cells_of_units(i);
    const auto count = count_units(found);
    if (found.size() != columns()) return false;
    if (count.words == 0) return count.units > 0 || (!lines_[i].comment && std::ranges::any_of(found, is_dash));
    return !lines_[i].comment && count.units > count.words && count.long_units;
  }
  bool could_be_names(std::size_t i) const {
    const auto found = cells(i);
    const auto count = count_units(found);
    double value = 0;
    return found.size() == columns() && count.words + count.units > 0 && !says_nothing(found) &&
           std::ranges::none_of(found, [&](const std::string& cell) {
             return read_cell(cell, dialect_.decimal, value) == Kind::number;
           });
  }
  bool names_above(std::size_t i) const {
    while (i-- > 0)
      if (lines_[i].comment ? could_be_names(i) : is_text(i) && cells(i).size() > 1) return could_be_names(i);
    return false;
  }

  void take_given_names() {
    names_ = std::size_t(std::ranges::find(lines_, long(keys_.names_line), &TableLine::number) - lines_.begin());
    if (names_ == lines_.size())
      throw InputError(fmt::format("{}: names_line = {}: there is no such line near the beginning, or it is empty",
                                   path_, keys_.names_line));
    body_ = names_ + 1;
    for (std::size_t i = names_ + 1; i < run_.begin; ++i) {
      const bool of_head =
          lines_[i].comment ? holds_units(i) : is_text(i) || fits(kinds(i), std::string(columns(), '-'));
      if (!of_head) continue;
      if (units_ == none && holds_units(i)) units_ = i;
      if (!lines_[i].comment) body_ = i + 1;
    }
    if (cells(names_).size() != columns()) refuse_names(names_);
  }

  /// Upwards from the numbers.
  void find_names() {
    std::size_t last_text = none, other = none;
    for (std::size_t i = run_.begin; i-- > 0 && names_ == none;) {
      if (lines_[i].comment) {
        if (units_ == none && holds_units(i) && names_above(i)) units_ = i;
        continue;
      }
      const auto found = cells(i);
      const bool dashes = found.size() == columns() && columns() > 1 && std::ranges::all_of(found, is_dash);
      const bool counts = xlook_ && says_nothing(found);
      const auto units = count_units(found);  // of which 1, of what has none, is a number
      const bool of_units = found.size() == columns() && units.units > 0 && units.words == 0 && names_above(i);
      if (!is_text(i) && !counts && !of_units && !(dashes && last_text == none)) continue;
      if (last_text == none) last_text = i;
      if (says_nothing(found)) continue;
      if (units_ == none && holds_units(i) && names_above(i)) {
        units_ = i;
      } else if (!dashes && found.size() == columns()) {
        names_ = i;
      } else if (!dashes) {
        if (other == none) other = i;
        if (found.size() > 1) break;
      }
    }
    body_ = last_text == none ? 0 : last_text + 1;
    // a comment stands for names where it has one for each column, and nothing else does
    for (std::size_t i = run_.begin; i-- > 0 && names_ == none;)
      if (lines_[i].comment && (other == none || i > other) && i != units_ && could_be_names(i)) names_ = i;
    if (names_ == none && other != none) refuse_names(other);
  }
  [[noreturn]] void refuse_names(std::size_t i) const {
    refuse(lines_[i].number,
           fmt::format("has {} cells, the rows below have {}, separated by {}: these are no names of columns; delete "
                       "the line, begin it with #, or say names_line = … beside the file's name{}",
                       cells(i).size(), columns(), named(dialect_.separator),
                       dialect_.separator == ',' ? "; where a comma is the decimal sign, columns must be separated by "
                                                   "semicolons, tabs or blanks"
                                                 : ""));
  }

  /// What is passed over must not be rows.
  void refuse_lost_rows() const {
    for (std::size_t i = keys_.names_line > 0 ? names_ + 1 : 0; i < body_; ++i) {
      const auto row = lines_[i].comment || columns() < 2 ? std::string() : kinds(i);
      if (row.find('N') == std::string::npos || !fits(row, run_.kinds)) continue;
      const auto text = names_ != none && names_ > i ? lines_[names_].number : lines_[body_ - 1].number;
      refuse(text, fmt::format("texts stand below numbers (line {}); if these are the names of the columns, say "
                               "names_line = {} beside the file's name, else delete the line or begin it with #",
                               lines_[i].number, text));
    }
    for (std::size_t i = names_ == none ? body_ : names_; i < body_; ++i)
      if (std::ranges::count(lines_[i].text, '"') % 2 != 0)
        refuse(lines_[i].number, "has a quotation mark without its other; correct it");
    for (std::size_t i = names_ == none ? body_ : names_ + 1; i < body_; ++i)
      if (!lines_[i].comment && i != units_ && !says_nothing(cells(i)) && holds_numbers(lines_[i].text))
        refuse(lines_[i].number,
               "stands between the names and the numbers, and is neither; delete it, or begin it with #");
  }

  /// What stands between the names, or the beginning, and the numbers must be rows as those below.
  void refuse_odd_rows() const {
    for (std::size_t i = body_; i < run_.begin; ++i) {
      const auto found = lines_[i].comment ? std::string() : kinds(i);
      auto rest = without_comment(lines_[i].text);
      std::string_view cell;
      for (std::size_t c = 0; found.size() == columns() && next_cell(rest, dialect_.separator, cell); ++c)
        if (run_.kinds[c] == 'N' && found[c] == 'T') refuse(lines_[i].number, head_.no_number(c, cell));
    }
  }

  /// True where the first cell of a column that holds anything is a time of day.
  bool is_clock(std::size_t column) const {
    for (std::size_t i = run_.begin; i < lines_.size(); ++i) {
      if (lines_[i].comment) continue;
      auto rest = without_comment(lines_[i].text);
      std::string_view cell;
      double value = 0;
      for (std::size_t c = 0; c <= column && next_cell(rest, dialect_.separator, cell);) ++c;
      if (read_number(cell, dialect_.decimal, value) == Kind::missing) continue;
      return read_number(cell, dialect_.decimal, value) == Kind::text && read_clock(cell, value) == Kind::number;
    }
    return false;
  }
  /// The unit of a time of day is the second; "(hh:mm:ss)" in a header says as much.
  void find_clocks() {
    for (std::size_t c = 0; c < columns(); ++c) {
      auto& column = head_.columns[c];
      column.clock = is_clock(c);
      if (!column.clock) continue;
      if (!column.unit.empty() && unit_known(column.unit) && column.unit != "s" && !column.may_be_name)
        refuse(head_.units_line > 0 ? head_.units_line : head_.names_line,
               fmt::format("{} is in {}, but its cells are times of day, such as 12:30:01, which count seconds",
                           head_.label(c), column.unit));
      column.unit = "s", column.may_be_name = false;
    }
  }

  void name_columns() {
    auto& list = head_.columns;
    list.resize(columns());
    if (names_ == none) return take_units_below();
    head_.names_line = lines_[names_].number;
    const auto texts = cells(names_);
    for (std::size_t c = 0; c < list.size(); ++c) {
      list[c] = header_cell(texts[c]);
      if (lines_[names_].comment && !list[c].unit.empty() && !unit_known(list[c].unit))
        list[c] = {texts[c], texts[c], ""};
      const auto unit = unit_cell(texts[c]);  // a name that reads as a unit, such as "ms", is both
      if (list[c].unit.empty() && unit.size() > 1 && looks_like_unit(unit))
        list[c].unit = unit, list[c].may_be_name = true;
    }
    take_units_below();
    if (units_ == none) take_units_above();
  }
  void take_units_below() {
    if (units_ == none) return;
    head_.units_line = lines_[units_].number;
    const auto texts = cells_of_units(units_);
    for (std::size_t c = 0; c < head_.columns.size(); ++c) take_unit(c, unit_cell(texts[c]));
  }
  /// A line of units above the names: of units alone, or behind a first cell that announces them; a comment right above
  /// that has a unit for each column.
  void take_units_above() {
    for (auto i = names_; i-- > 0 && units_ == none;) {
      auto units = cells_of_units(i);
      if (units.size() != columns()) continue;
      const bool announced = announces_units(cells(i).front()), near = i + 1 == names_;
      for (auto& unit : units)
        unit = lines_[i].comment && !holds_units(i) && near ? header_cell(unit).unit : unit_cell(unit);
      const auto is_unit = [](const auto& unit) { return !unit.empty() && unit_known(unit); };
      const bool all = announced || std::ranges::all_of(units, is_unit);
      const auto count = count_units(units);
      if (!all || count.units == 0 || (!announced && !near && !count.long_units)) continue;
      units_ = i;
      head_.units_line = lines_[i].number;
      for (std::size_t c = 0; c < units.size(); ++c) take_unit(c, units[c]);
    }
  }
  void take_unit(std::size_t c, const std::string& unit) {
    auto& column = head_.columns[c];
    if (unit.empty() || unit == ".") return;
    if (!column.unit.empty() && !column.may_be_name && column.unit != unit)
      refuse(head_.units_line, fmt::format("says {} of column '{}'; make them agree", unit, column.text));
    column.unit = unit, column.may_be_name = false;
  }

  const std::string& path_;
  const std::vector<TableLine>& lines_;
  const TableKeys& keys_;
  Dialect dialect_{};
  Run run_;
  bool xlook_ = false, first_counts_ = false, last_is_empty_ = false;
  std::size_t names_ = none, units_ = none;
  std::size_t body_ = 0;  ///< the line after the last one of texts above the numbers
  TableHead head_;
};

}  // namespace

TableLayout find_layout(const std::string& path, const std::vector<TableLine>& lines, const TableKeys& keys) {
  return Finder(path, lines, keys).layout();
}

std::string TableHead::text() const {
  std::string text = fmt::format("separated by {}, decimal {}", named(separator), decimal == ',' ? "comma" : "point");
  text += names_line > 0 ? fmt::format("; names in line {}", names_line) : std::string("; no names of columns");
  if (units_line > 0) text += fmt::format(", units in line {}", units_line);
  text += fmt::format(", numbers from line {} on", first_line);
  if (skipped > 0) text += fmt::format("; {} before them skipped", lines_text(skipped));
  return text;
}

std::string TableHead::label(std::size_t column) const {
  const auto& text = columns[column].text;
  return text.empty() ? fmt::format("column {}", column + 1) : fmt::format("column '{}'", text);
}

std::string TableHead::no_number(std::size_t column, std::string_view cell) const {
  constexpr std::size_t longest = 40;
  const char other = decimal == '.' ? ',' : '.';
  const auto cure =
      std::ranges::count(cell, other) == 1
          ? fmt::format(
                "; the decimal sign of the file's other numbers is '{}': write it here too, and no signs between "
                "thousands",
                decimal)
          : std::string(
                "; correct it, or leave it empty where the number is missing (or write NaN), or begin the line "
                "with #");
  const auto* names = names_line > 0
                          ? ""
                          : "; if the names of the columns stand in some line, say names_line = … beside the "
                            "file's name";
  return fmt::format("{} is not a finite number here: '{}'{}{}", label(column), in_utf8(cell.substr(0, longest)), cure,
                     names);
}

}  // namespace rosin::app::scene
