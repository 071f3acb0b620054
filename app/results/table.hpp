/// Numbers of a result with what they are: said once by a verb, and written from there in each format.
#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rosin::app::results {

/// What a number is. Its symbol follows from its name (output/symbols.hpp).
struct Channel {
  std::string name, unit = "1", meaning = "";  ///< no meaning: that of the name (report/quantities.hpp)
};

/// One of several words for each value, by its number: 0 "stable", 1 "cycle", 2 "bistable".
struct Flags {
  std::vector<signed char> values;
  std::vector<signed char> numbers;  ///< that have a word
  std::string words;                 ///< apart by blanks
};

using Attributes = std::vector<std::pair<std::string, std::variant<std::string, double, int>>>;

/// Numbers, words or flags along dimensions of a table, row by row.
struct Column {
  Channel of;
  std::variant<std::vector<double>, std::vector<std::string>, Flags> values;
  std::vector<double> error = {};       ///< absolute; empty: none known, one for all values, or one for each
  std::vector<std::size_t> over = {0};  ///< numbers of the table's dimensions; none: a single number
  Attributes more = {};                 ///< what else is worth knowing: the path of a parameter, "log" of its scale

  const std::vector<double>& numbers() const { return std::get<std::vector<double>>(values); }
};

struct Dimension {
  std::string name;
  std::size_t length = 0;
};

/// Columns over common dimensions.
struct Table {
  std::string name;  ///< of its files
  std::vector<Dimension> dimensions;
  std::vector<Column> columns;
  Attributes more = {};
  bool is_field = false;  ///< values over parameters or starts, for NetCDF alone; else rows, if of one dimension
};

/// A table of rows. They are counted by the first column where that rises, or is time, which stands still in a jump;
/// else by "row".
Table rows(std::string name, std::vector<Column> columns);

/// A name as NetCDF, xarray and MATLAB take it: '/' and blanks become '_'.
std::string variable_name(std::string name);

/// Names of coordinates whose values are those of parameters: "normal_load" of "drive.normal_load". Where that is
/// another's name, or one of those that are taken, each is its whole path, "drive_normal_load".
std::vector<std::string> axis_names(const std::vector<std::string>& paths, const std::vector<std::string>& taken);

}  // namespace rosin::app::results
