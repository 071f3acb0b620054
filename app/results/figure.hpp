/// What a picture shows: panels with axes, and what stands over columns of tables. No renderer is named here: values
/// are in SI units, and whoever draws a figure chooses prefixes, ticks, fonts and room for texts.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

namespace rosin::app::results {

constexpr double unset = std::numeric_limits<double>::quiet_NaN();

/// The least and the largest of values that are finite.
struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void include(double value) {
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  }
  static Extent of(const std::ranges::input_range auto& values) {
    Extent extent;
    for (const double value : values) extent.include(value);
    return extent;
  }
  bool known() const { return low <= high; }
  double largest() const { return known() ? std::max(std::abs(low), std::abs(high)) : 0; }
  /// Only a logarithmic axis shows all values.
  bool spans_decades() const { return low > 0 && high / low > 50; }
};

struct Tick {
  double at;
  std::string label;
};

struct Axis {
  std::string name = "", unit = "1";     ///< in words, as the glossary has it
  std::string symbol = "", detail = "";  ///< "μ_d"; which of its numbers: "amplitude of harmonic 1"
  bool decades = false;                  ///< logarithmic
  Extent shown = {};                     ///< values along it, which choose the prefix of the unit
  double from = unset, to = unset;       ///< ends; unset: as values need
  double before = unset, after = unset;  ///< parts of the panel left free beside values; unset: as is usual
  std::vector<Tick> ticks = {};          ///< in place of the usual ones
  std::vector<Tick> further = {};        ///< beside the usual ones
  double ticks_from = unset;             ///< the usual ones begin there
  bool zero = false;                     ///< a line stands at 0
};

enum class Point { dot, circle, cross, plus, square, open_square, up, down, open_up, open_down, open_diamond };

/// Styles of lines differ in dash as well as in colour: readable in grey and by the colour-blind. Those of one picture
/// that are alike follow each other in this order; the last is of what others are compared with.
struct LineStyle {
  const char *colour, *dash;  ///< lengths of dashes and gaps in half points; empty: solid
  double width;
};
constexpr LineStyle line_styles[] = {{"#00336F", "", 1.8},    {"#B0560F", "8,4", 1.6}, {"#3A8F5C", "12,3,2,3", 1.6},
                                     {"#8A4FA3", "4,2", 1.6}, {"#C4A000", "", 1.6},    {"#D1495B", "2,3", 1.6},
                                     {"#555555", "2,3", 1.2}};
constexpr int reference_style = 6;
/// The style of the k-th of several lines.
constexpr int style_of(std::size_t k) { return int(k % reference_style); }

struct Look {
  int style = 0;                       ///< of `line_styles`, where nothing else is said
  std::string colour = "", dash = "";  ///< "#RRGGBB"; "solid" or lengths
  double width = unset;                ///< of lines, in points
  Point point = Point::dot;
  double size = 0.5;  ///< of points
  bool halo = false;  ///< a white rim, so that it is seen on every colour
};

/// A number of a row of a table.
struct Cell {
  int column = 0;  ///< from 1; 0: none, and the number is `plus`
  int over = 0;    ///< a column that it is divided by
  bool absolute = false;
  double factor = 1, plus = 0;
  double least = unset;  ///< what is less is drawn there
};

/// Rows that are drawn: those with such a number or text in a column.
struct Where {
  int column;
  char compare;  ///< '=', '<' or '>'
  double number = 0;
  std::string text = "";
};

enum class How {
  line,
  points,
  line_and_points,
  steps,
  bars,
  filled,   ///< down to 0
  band,     ///< between two values
  cells,    ///< rectangles
  upright,  ///< over the height of the panel
  image,    ///< a colour for each place of a regular grid
  surface,  ///< rows of places, parted by empty ones
  boxplot
};

/// A file of doubles, row by row from the lower left, on a grid that is regular along the scales of the axes.
struct Grid {
  std::size_t first = 0;  ///< doubles before it in the file
  int columns = 0, rows = 0;
  double x_first = 0, x_last = 0, y_first = 0, y_last = 0;  ///< middles of cells
};

/// What stands over the rows of a table.
struct Line {
  std::string table;  ///< a file; empty: `rows` themselves
  Cell x = {1}, y = {2};
  How how = How::line;
  Look look = {};
  std::string title = "";  ///< in the key; alike ones stand there once
  std::vector<Where> where = {};
  Cell z = {};               ///< in space, or on the colour scale
  Cell low = {}, high = {};  ///< edges of a band
  int corners = 0;           ///< of cells: the first of the columns x_low, x_high, y_low, y_high
  std::optional<Grid> grid = {};
  bool sorted = false;  ///< along x first
  std::vector<std::vector<double>> rows = {};
};

/// A line across the panel.
struct Rule {
  char axis;  ///< on which it has its place: 'x' stands upright
  double at;
  Look look = {};
  std::string title = "";
};

/// Ground that is coloured from one value of an axis to another.
struct Shade {
  char axis;
  double from, to;
  std::string colour;
  std::string title = "";
};

enum class Side { none, left, right, above, below };

/// A place, with a point or a text beside it or both.
struct Mark {
  double x, y;
  std::string text = "";
  Side side = Side::none;  ///< of the text
  Look look = {};
  bool point = true;
  std::string title = "";
};

/// A distance with its name.
struct Measure {
  double from_x, from_y, to_x, to_y;
  std::string name;
};

enum class Palette { cividis, grey, blue, signs };

struct ColourScale {
  Axis axis;
  Palette palette = Palette::cividis;
};

struct Panel {
  Axis x = {}, y = {};
  std::vector<Line> lines = {};
  std::vector<Rule> rules = {};
  std::vector<Shade> shades = {};
  std::vector<Mark> marks = {};
  std::vector<Measure> measures = {};
  std::vector<std::string> notes = {};  ///< below the upper right corner
  std::string title = "";
  std::optional<Axis> z = {};  ///< a panel in space
  std::optional<ColourScale> colours = {};
  std::string key = "";  ///< where its key stands: "top left"; empty: above it
  bool equal_scales = false, grid = true;
  double height = 0;  ///< 0: that of the figure
};

/// A table that only a figure needs.
struct FigureTable {
  struct Column {
    std::string header;
    std::vector<double> values;
    std::vector<std::string> texts = {};  ///< in place of values
  };
  std::string file;
  std::vector<Column> columns;  ///< a row without any number parts lines
};

/// Where the titles of lines stand: for all panels above or below them, or for each by itself.
enum class Key { above, below, own };

struct Figure {
  std::string name, what;  ///< of its files; what it shows, in a sentence without its dot
  std::string title, caption = "";
  std::vector<Panel> panels = {};
  int width = 820, columns = 1;  ///< in pixels on a screen; panels beside each other
  double height = 400;           ///< of a panel, in pixels
  Key key = Key::above;
  std::vector<FigureTable> tables = {};
  std::vector<std::pair<std::string, std::string>> rows = {};  ///< names and texts below the panels
};

}  // namespace rosin::app::results
