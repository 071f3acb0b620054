/// Tables of a scene as they are read: every value is taken together with its place in the file, so that each refusal
/// can name it.
#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/scene/in_thread.hpp"
#include "app/scene/record.hpp"
#include "app/scene/reference.hpp"
#include "app/scene/written_units.hpp"
#include "core/error.hpp"
#include "core/parameters.hpp"
#include "core/units.hpp"

namespace rosin::app::scene {

inline constexpr int most_points = 10'000'000;  ///< of a record or a plane
inline constexpr int largest_seed = 10'000'000;
inline constexpr std::size_t most_names = 1000;  ///< in a list of texts, tables, or terms
inline constexpr std::string_view override_mark = "--set ";

/// "scene.toml:7:5", or the override that a value came from; empty for a value that the user has written nowhere, such
/// as one that a verb varies.
inline std::string place(const toml::source_region& source) {
  if (!source.path || source.path->starts_with(override_mark)) return source.path ? *source.path : std::string();
  return fmt::format("{}:{}:{}", *source.path, std::max(1u, source.begin.line), std::max(1u, source.begin.column));
}

/// An InputError that already begins with its place.
class PlacedError : public InputError {
 public:
  using InputError::InputError;
};

/// \throws PlacedError, or an InputError where the source is no place of the user's
[[noreturn]] inline void fail_at(const toml::source_region& source, const std::string& text) {
  if (const auto where = place(source); !where.empty()) throw PlacedError(where + ": " + text);
  throw InputError(text);
}
template <class... Args>
[[noreturn]] void fail(const toml::source_region& source, fmt::format_string<Args...> text, Args&&... args) {
  fail_at(source, fmt::format(text, std::forward<Args>(args)...));
}

/// Calls `f`; an InputError from below gets the place in front, unless it names a more exact one already.
template <class F>
auto located(const toml::source_region& source, F f) {
  try {
    return f();
  } catch (const PlacedError&) {
    throw;
  } catch (const InputError& error) {
    fail_at(source, error.what());
  }
}

inline std::string suggestion(std::string_view name, const std::vector<std::string>& known) {
  const auto near = nearest_name(name, known);
  return near.empty() ? fmt::format("; known here: {}", fmt::join(known, ", "))
                      : fmt::format("; did you mean '{}'?", near);
}

inline std::string_view kind(const toml::node& node) {
  if (node.is_string()) return "a text";
  if (node.is_boolean()) return "a truth value";
  if (node.is_array()) return "a list";
  if (node.is_table()) return "a table";
  if (node.is_number()) return "a number";
  return "a date or time";
}

[[noreturn]] inline void wrong_kind(const toml::node& node, std::string_view path, std::string_view wanted) {
  fail(node.source(), "{} is {}, but {} is needed", path, kind(node), wanted);
}

/// A path without the numbers of entries of lists.
std::string without_numbers(const std::string& path);

/// While it lives, the numbers that are asked for in this thread are noted with their paths, there or not: what a scene
/// may hold, for whoever varies one of them.
class NumbersAsked : public InThread<NumbersAsked> {
 public:
  static void note(const Quantity& quantity) {
    if (auto* asked = current()) asked->quantities.push_back(quantity);
  }
  std::vector<Quantity> quantities;
};

/// While it lives, the keys of the scene that are read in this thread are noted by their paths, entries of lists
/// without their numbers: the register of what a verb makes use of. One within another takes the keys that are read
/// only to be checked.
class KeysRead : public InThread<KeysRead> {
 public:
  static void note(const std::string& path) {
    if (auto* keys = current()) keys->paths_.insert(without_numbers(path));
  }
  /// The outermost keys of a table that nobody has read.
  std::vector<std::string> unread(const toml::table& table, const std::string& path = "") const;

 private:
  bool within(const std::string& path) const;  ///< whether a key of this table was read
  std::set<std::string> paths_;
};

/// A number in SI units: plain, or a text with a unit.
inline double number(const toml::node& node, const Quantity& quantity) {
  NumbersAsked::note(quantity);
  double value = 0;
  const auto* text = node.as_string();
  if (text)
    value = located(node.source(), [&] {
      try {
        return Reference::to_si(text->get(), quantity.unit);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", quantity.name, error.what()));
      }
    });
  else if (node.is_number())
    value = *node.value<double>();
  else
    wrong_kind(node, quantity.name, fmt::format("a number ({}, {})", quantity.meaning, readable_unit(quantity.unit)));
  located(node.source(), [&] { require(value, quantity.range, quantity.name, quantity.meaning, quantity.unit); });
  UnitsRead::note(quantity.unit, value, text ? std::optional<std::string_view>(text->get()) : std::nullopt);
  return value;
}

/// A whole number; work and memory grow with it, so that each has a bound of its own.
inline int count(const toml::node& node, std::string_view path, int low, int high, std::string_view meaning) {
  if (!node.is_integer()) wrong_kind(node, path, fmt::format("a whole number ({})", meaning));
  const auto value = *node.value<std::int64_t>();
  if (value < low || value > high)
    fail(node.source(), "{} = {} is outside {} … {} ({})", path, value, low, high, meaning);
  return static_cast<int>(value);
}

inline std::string text(const toml::node& node, std::string_view path) {
  if (const auto* value = node.as_string()) {
    if (value->get().find('\0') != std::string::npos) fail(node.source(), "{} holds a zero byte", path);
    return value->get();
  }
  wrong_kind(node, path, "a text");
}

inline std::string choice(const toml::node& node, std::string_view path, const std::vector<std::string>& known) {
  auto value = text(node, path);
  if (std::ranges::find(known, value) == known.end())
    fail(node.source(), "{} = '{}' is not known{}", path, value, suggestion(value, known));
  return value;
}

inline const toml::array& list(const toml::node& node, std::string_view path, std::string_view of,
                               std::size_t longest = most_points) {
  const auto* array = node.as_array();
  if (!array) wrong_kind(node, path, fmt::format("a list of {}", of));
  if (array->size() > longest)
    fail(node.source(), "{} has {} entries, more than {} ({})", path, array->size(), longest, of);
  return *array;
}

inline std::vector<double> numbers(const toml::node& node, const Quantity& quantity,
                                   std::size_t longest = most_points) {
  std::vector<double> values;
  for (const auto& element : list(node, quantity.name, "numbers", longest)) values.push_back(number(element, quantity));
  return values;
}

inline std::vector<std::string> texts(const toml::node& node, std::string_view path) {
  std::vector<std::string> values;
  for (const auto& element : list(node, path, "texts", most_names)) values.push_back(text(element, path));
  return values;
}

/// One table of a scene. Every key that is asked for becomes known; `finish` refuses the rest.
class Table {
 public:
  Table(const toml::node& node, std::string path) : path_(std::move(path)) {
    if (!node.is_table()) wrong_kind(node, path_, "a table");
    table_ = node.as_table();
  }

  std::string path(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
  }
  const toml::source_region& source() const { return table_->source(); }

  /// Makes keys known ahead, so that a misspelt key is reported before the one that it leaves missing.
  Table& expect(std::initializer_list<std::string_view> keys) {
    known_.insert(known_.begin(), keys.begin(), keys.end());
    expected_ = true;
    return *this;
  }
  const toml::node* find(std::string_view key) {
    if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
    const auto* node = table_->get(key);
    if (node) KeysRead::note(path(key));
    return node;
  }
  const toml::node& required(std::string_view key, std::string_view meaning) {
    if (const auto* node = find(key)) return *node;
    if (expected_) finish();
    if (path_.empty()) fail(source(), "the scene has no [{}] ({})", key, meaning);
    fail(source(), "[{}] has no '{}' ({})", path_, key, meaning);
  }
  /// Reads a number into `target` if the key is there.
  void read(std::string_view key, double& target, Quantity quantity) {
    quantity.name = path(key);
    if (const auto* node = find(key))
      target = number(*node, quantity);
    else
      NumbersAsked::note(quantity);
  }
  void read(std::string_view key, std::optional<double>& target, Quantity quantity) {
    quantity.name = path(key);
    if (const auto* node = find(key))
      target = number(*node, quantity);
    else
      NumbersAsked::note(quantity);
  }
  void read(std::string_view key, int& target, int low, int high, std::string_view meaning) {
    if (const auto* node = find(key)) target = count(*node, path(key), low, high, meaning);
  }
  /// The tables in this one, in the order of the file: their keys are names that the user chose.
  std::vector<std::pair<std::string, Table>> named_tables() const {
    std::vector<std::pair<const toml::key*, const toml::node*>> entries;
    for (const auto& [key, node] : *table_) entries.emplace_back(&key, &node);
    const auto position = [](const auto& entry) {
      const auto& begin = entry.first->source().begin;
      return std::pair{begin.line, begin.column};
    };
    std::ranges::stable_sort(entries, {}, position);
    std::vector<std::pair<std::string, Table>> tables;
    for (const auto& [key, node] : entries) tables.emplace_back(key->str(), Table(*node, path(key->str())));
    return tables;
  }
  std::optional<Table> table(std::string_view key) {
    if (const auto* node = find(key)) return Table(*node, path(key));
    return std::nullopt;
  }
  void finish() const {
    for (const auto& [key, node] : *table_) {
      if (std::ranges::find(known_, key.str()) != known_.end()) continue;
      // an override's key has no place of its own, its value has
      const auto& source = key.source().path ? key.source() : node.source();
      fail(source, "unknown {} '{}'{}{}", node.is_table() ? "table" : "key", key.str(),
           path_.empty() ? std::string() : fmt::format(" in [{}]", path_), suggestion(key.str(), known_));
    }
  }

 private:
  const toml::table* table_ = nullptr;
  std::string path_;
  std::vector<std::string> known_;
  bool expected_ = false;
};

/// Two of what `read` makes of the elements of a list.
template <class Read>
auto both(const toml::node& node, const std::string& path, Read read) {
  const auto& pair = list(node, path, "two, along x and y");
  if (pair.size() != 2) fail(node.source(), "{} has {} entries, but 2 are needed, along x and y", path, pair.size());
  return std::array{read(*pair.get(0)), read(*pair.get(1))};
}
/// Two numbers, which must be there.
inline std::array<double, 2> both(Table& table, std::string_view key, Quantity quantity) {
  quantity.name = table.path(key);
  return both(table.required(key, quantity.meaning + ", along x and y"), quantity.name,
              [&](const toml::node& node) { return number(node, quantity); });
}

/// A column of a file by name or by number, or { column, unit, factor, offset }.
inline RecordColumn read_column(const toml::node& node, const std::string& path, const std::string& si) {
  RecordColumn column{"", "", si};
  const auto choose = [&](const toml::node& chosen, const std::string& where) {
    constexpr int most_columns = 100'000;
    if (chosen.is_integer())
      column.number = count(chosen, where, 1, most_columns, "number of a column");
    else if (chosen.is_string())
      column.name = text(chosen, where);
    else
      wrong_kind(chosen, where, "the name of a column or its number");
  };
  if (!node.is_table()) {
    choose(node, path);
    return column;
  }
  Table table(node, path);
  table.expect({"column", "unit", "factor", "offset"});
  choose(table.required("column", "its name in the file or its number"), table.path("column"));
  if (const auto* unit = table.find("unit")) {
    column.unit = text(*unit, table.path("unit"));
    located(unit->source(), [&] { Reference::to_si("1 " + column.unit, si); });
  }
  const auto plain = [&](std::string_view key) -> std::optional<double> {
    const auto* value = table.find(key);
    if (!value) return std::nullopt;
    if (!value->is_number()) wrong_kind(*value, table.path(key), "a number without unit (that is unit's)");
    const double number = *value->value<double>();
    located(value->source(), [&] { require(number, {-1e300, 1e300}, table.path(key), "of a calibration", "1"); });
    return number;
  };
  column.factor = plain("factor");
  if (column.factor && *column.factor == 0) fail(table.source(), "{} = 0 leaves nothing", table.path("factor"));
  column.offset = plain("offset").value_or(0);
  table.finish();
  return column;
}

/// The keys by which every table of a scene names a file of measured numbers.
inline RecordSource read_file(Table& table, const std::filesystem::path& folder) {
  RecordSource source;
  const std::filesystem::path file =
      text(table.required("file", "a table as text (CSV and others), or NetCDF (*.nc)"), table.path("file"));
  source.file = file.is_absolute() ? file : folder / file;
  constexpr int most_lines = 100'000;
  table.read("names_line", source.keys.names_line, 1, most_lines, "line of the file with the names of the columns");
  if (const auto* decimal = table.find("decimal"))
    source.keys.decimal = choice(*decimal, table.path("decimal"), {".", ","}).front();
  return source;
}

}  // namespace rosin::app::scene
