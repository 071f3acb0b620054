/// Columns of tables: the name and the unit of each, in the ways that instruments write them, and its numbers in SI.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rosin::app::scene {

/// What a scene wants of a file: a column by its name or its number, and the SI unit that is needed. A sensor's
/// calibration makes (number·factor + offset) of the file's numbers, in `unit`.
struct RecordColumn {
  std::string name;                   ///< empty: by number
  std::string unit;                   ///< empty: as the file says, else SI
  std::string si;                     ///< in which the numbers are handed over
  int number = 0;                     ///< of the column, from 1
  std::optional<double> factor = {};  ///< of a calibration
  double offset = 0;
  bool unit_needed = false;  ///< a number without a unit is refused, not taken as SI
};

/// One column: "speed (mm/s)", "speed [mm/s]", "speed / mm/s", "speed, mm/s", "speed mm/s", "speed_mm_s".
struct HeaderCell {
  std::string text;          ///< all of it
  std::string name;          ///< without the unit
  std::string unit;          ///< empty: none is written; "1" for a dash
  bool may_be_name = false;  ///< the unit may be a part of the name, such as the s of "mu_s"
  bool clock = false;        ///< the cells below are times of day: seconds, for which the unit stands
};
HeaderCell header_cell(std::string_view text);

/// A cell of a line of units: "mm/s", "(mm/s)", "[mm/s]"; "1" for a dash, empty for nothing.
std::string unit_cell(std::string_view text);
/// True for a unit without brackets around it, which must not be a word.
bool looks_like_unit(const std::string& text);

/// The column of that name, with or without its unit; −1 if there is none, −2 if there are several.
int find_column(const std::vector<HeaderCell>&, std::string_view name);

/// SI value = number·scale + shift.
struct Conversion {
  double scale = 1, shift = 0;
};
/// What the numbers under this cell are worth. A letter that is no such unit is a part of the name.
/// \throws InputError that names the column and says the cure, for units that are none, that have another dimension,
/// or that the scene contradicts.
Conversion conversion_to_si(const HeaderCell&, const RecordColumn&);

}  // namespace rosin::app::scene
