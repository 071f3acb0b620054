/// How a text table is laid out: which lines hold names, units and numbers, and what separates cells.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/scene/header.hpp"

namespace rosin::app::scene {

/// What a scene may say of a file that does not speak for itself.
struct TableKeys {
  int names_line = 0;  ///< of the file, from 1; 0: it is found
  char decimal = 0;    ///< '.' or ','; 0: it is found
};

/// What was understood of a file.
struct TableHead {
  char separator = ' ', decimal = '.';
  long skipped = 0;                                     ///< lines before the numbers that are neither names nor units
  long names_line = 0, units_line = 0, first_line = 0;  ///< from 1; 0: there is none
  std::vector<HeaderCell> columns;  ///< one for each cell of a row; without texts where there are no names

  /// "separated by ';', decimal comma; names in line 3, units in line 4, numbers from line 5 on; 2 lines skipped"
  std::string text() const;
  /// "column 'speed'", "column 2"
  std::string label(std::size_t column) const;
  /// That a cell of a column is no number, and what to do.
  std::string no_number(std::size_t column, std::string_view cell) const;
};

/// A line that is not blank.
struct TableLine {
  long number;            ///< in the file, from 1
  std::string_view text;  ///< without what ends it
  bool comment;
};

struct TableLayout {
  TableHead head;
  std::size_t first = 0;  ///< index of the first row of numbers
};

/// Judges by the first lines of a file. \throws InputError with the line where they cannot be understood, and the cure.
/// \param path for messages
TableLayout find_layout(const std::string& path, const std::vector<TableLine>&, const TableKeys&);

}  // namespace rosin::app::scene
