/// The sheet that a picture is drawn on, on a screen or in a column of a journal: its size, its texts, and where panels
/// are.
#pragma once
#include <string>

namespace rosin::app::output {

/// Widths of pictures in print, in millimetres: text is 7 points high below 130 mm, and 8 points above.
constexpr double least_width = 80, most_width = 250;

/// Lengths in pixels of a picture whose text is 13 pixels high.
struct Layout {
  int width = 820;              ///< of the picture on a screen
  int panels = 1, columns = 1;  ///< columns side by side; fewer where frames would be narrower than 195
  double panel = 400;           ///< height of a panel's frame; three quarters of it where text is 7 points high
  /// From the outer frames to the edges of the sheet, or to its title and caption.
  double left = 85, right = 25, above = 10, below = 54;
  double between_columns = 110, between_rows = 26;
  /// Where the key of all panels stands, in as many rows as its titles need: between title and frames, or between
  /// frames and caption. Or each panel has its own, which the script sets.
  enum class Key { above, below, own } key = Key::above;
  int own_titles = 0;                         ///< most titles of a key that a panel has above its frame
  int rows_below = 0, narrow_rows_below = 0;  ///< of marks that a script explains itself, above the caption
};

/// A script for gnuplot that draws panels on a sheet of any width: its variable `width` is in millimetres, 0 for a
/// screen. Variables for the panels: `wide` and `high`, the size of the sheet in the pixels of a layout; `narrow`,
/// where text is 7 points high; `columns`; `above` and `below`, from the frames to the edges; `frame`, the height of a
/// panel; `rows_top`, the height at which rows between frames and caption begin, as part of the whole.
struct Sheet {
  std::string name, what;  ///< of the script; what it draws
  Layout layout;
  std::string title, caption = "";

  /// \param panels the settings and plots of the panels
  std::string with(std::string panels) const;
};

}  // namespace rosin::app::output
