/// Headers of tables: the name and the unit of each column, in the ways that instruments write them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace rosin::app::scene {

/// One column: "speed (mm/s)", "speed [mm/s]", "speed / mm/s", "speed, mm/s", "speed mm/s", "speed_mm_s".
struct HeaderCell {
  std::string text;               ///< all of it
  std::string name;               ///< without the unit
  std::string unit;               ///< empty: none is written; "1" for a dash
  bool may_be_subscript = false;  ///< a single letter at the end of the name, such as the s of "mu_s"
};
HeaderCell header_cell(std::string_view text);

/// The cells of a header line, and what separates them: comma, semicolon or tab, else blanks.
struct Header {
  char separator = ' ';
  std::vector<HeaderCell> cells;
};
Header read_header(std::string_view line);

/// The column of that name, with or without its unit; nothing if there is none.
const HeaderCell* find_column(const std::vector<HeaderCell>&, std::string_view name);

/// What a number under this cell is worth in the SI unit: the header's unit counts, or `given` where the scene gives
/// one. A letter that is no such unit is a part of the name. \throws InputError that names the column, for units that
/// are none, or of another dimension, and says the cure.
double to_si_factor(const HeaderCell&, std::string_view given, std::string_view si);

/// True for a comment that stands for a header: each of its cells has a unit in brackets, "time (ms), load (kN)".
bool names_units(std::string_view comment);

/// True for a line that has units in place of numbers, such as "mm/s;-".
bool holds_units(std::string_view line);

}  // namespace rosin::app::scene
