/// A figure as a script: settings of each panel where they differ from those of the panel before, and its plots.
#include "app/output/figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "app/output/gnuplot.hpp"
#include "app/output/sheet.hpp"
#include "core/files.hpp"

namespace rosin::app::output {

using namespace results;

namespace {

constexpr double joined_gap = 26, own_gap = 75, line_above = 20;  ///< pixels between panels; of a key or title
constexpr double small_panel = 160;                               ///< where gnuplot's own ticks would stand close

// ---------------------------------------------------------------- axes

/// Values of an axis as they are drawn.
struct Along {
  DrawnRange range;
  bool decades;
  double operator()(double value) const { return (value - range.off) * range.factor; }
  std::string of(const std::string& expression) const {
    auto text = range.off == 0 ? expression : fmt::format("({}-({}))", expression, range.off);
    return range.factor == 1 ? text : fmt::format("{}*{}", text, range.factor);
  }
};

/// \param shifts whether values that hardly change are drawn less what they have in common
Along drawn(const Axis& axis, bool shifts) {
  if (axis.decades || !axis.shown.known())
    return {{0, 1, axis.unit, "", axis.shown.low, axis.shown.high}, axis.decades};
  auto range = drawn_range(axis.unit, axis.shown.low, axis.shown.high);
  if (range.off != 0 && !shifts) {
    const auto [factor, unit] = scaled(axis.unit, axis.shown.largest());
    range = {0, factor, unit, "", axis.shown.low * factor, axis.shown.high * factor};
  }
  return {range, false};
}

/// Name, symbol with its index below the line, and unit; quoted.
std::string label_of(const Axis& axis, const Along& drawn) {
  auto symbol = axis.symbol;
  if (const auto index = symbol.find('_'); index != symbol.npos) symbol.insert(index + 1, "{").push_back('}');
  const auto end = (axis.detail.empty() ? "" : ", " + axis.detail) + drawn.range.common;
  const auto rest = end + (drawn.range.unit.empty() || drawn.range.unit == "1" ? "" : " (" + drawn.range.unit + ")");
  if (symbol.empty()) return single_quoted(axis.name + rest);
  return single_quoted(axis.name.empty() ? "" : axis.name + ' ') + ".'" + symbol + "'." + single_quoted(rest);
}

std::string limit(double value, const Along& drawn) {
  return std::isnan(value) ? "*" : fmt::format("{}", drawn(value));
}
std::string range_of(const Axis& axis, const Along& drawn) {
  return fmt::format("[{}:{}]", limit(axis.from, drawn), limit(axis.to, drawn));
}

std::string listed(const std::vector<Tick>& ticks, const Along& drawn) {
  std::vector<std::string> list;
  for (const auto& tick : ticks) list.push_back(fmt::format("{} {}", single_quoted(tick.label), drawn(tick.at)));
  return fmt::format("({})", fmt::join(list, ", "));
}

enum class Room { wide, narrow, low };  ///< that ticks of an axis have

/// From where to where ticks stand, as values.
std::pair<double, double> span_of(const Axis& axis) {
  const double low = std::isnan(axis.from) ? axis.shown.low : std::min(axis.from, axis.to),
               high = std::isnan(axis.to) ? axis.shown.high : std::max(axis.from, axis.to);
  return {std::isnan(axis.ticks_from) ? low : axis.ticks_from, high};
}

/// 1, 2 and 5 of each decade where few decades lie along the axis, and more where less than one does; else none.
std::vector<Tick> few_ticks(const Axis& axis) {
  constexpr double few = 200;
  const auto [low, high] = span_of(axis);
  std::vector<Tick> ticks;
  if (!axis.decades || !(low > 0) || !(high <= few * low)) return ticks;
  for (double decade = std::pow(10, std::floor(std::log10(low))); decade <= high; decade *= 10)
    for (const double part : high < 10 * low ? std::vector{1., 2., 3., 5., 7.} : std::vector{1., 2., 5.})
      if (const double at = part * decade; at >= 0.99 * low && at <= 1.01 * high)
        ticks.push_back({at, fmt::format("{:g}", at)});
  return ticks;
}

/// Where gnuplot's own ticks would stand close, about four are chosen.
std::string ticks_of(char name, const Axis& axis, const Along& drawn, bool labelled, Room room) {
  auto ticks = axis.ticks.empty() ? few_ticks(axis) : axis.ticks;
  if (!labelled)
    for (auto& tick : ticks) tick.label = "";
  const auto [low, high] = span_of(axis);
  const bool known = std::isfinite(high - low), cut = !std::isnan(axis.ticks_from);
  std::string text = fmt::format("set {}tics ", name);
  if (!ticks.empty()) {
    text += listed(ticks, drawn);
  } else if (axis.decades && known && low > 0 && (cut || room != Room::wide)) {
    const double first = std::ceil(std::log10(low)), most = name == 'x' ? 5 : 8,
                 every = std::max(std::ceil((std::log10(high) - first) / most), 1.0);
    text += fmt::format("{:g},{:g},{:g}", std::pow(10, first), std::pow(10, every), high);
  } else if (!axis.decades && known && (cut || room != Room::wide)) {
    const double step = tick_step(drawn(low), drawn(low) + (room == Room::low ? 1.3 : 1) * (drawn(high) - drawn(low)));
    text += cut ? fmt::format("{:g},{:g},{:g}", std::ceil(drawn(low) / step) * step, step, drawn(high))
                : fmt::format("{:g}", step);
  } else {
    text += "autofreq";
  }
  if (!axis.further.empty()) text += fmt::format("\nset {}tics add {}", name, listed(axis.further, drawn));
  return text;
}

// ---------------------------------------------------------------- looks

int number_of(Point point) {
  switch (point) {
    case Point::dot:
      return 7;
    case Point::circle:
      return 6;
    case Point::cross:
      return 2;
    case Point::plus:
      return 1;
    case Point::square:
      return 5;
    case Point::open_square:
      return 4;
    case Point::up:
      return 9;
    case Point::down:
      return 11;
    case Point::open_up:
      return 8;
    case Point::open_down:
      return 10;
    case Point::open_diamond:
      return 12;
  }
  return 7;
}

std::string dash_of(std::string_view dash) {
  return dash.empty() || dash == "solid" ? "solid" : fmt::format("({})", dash);
}

std::string look_of(const Look& look, bool has_points, bool has_line) {
  std::string text = fmt::format("linestyle {}", look.style + 1);
  if (has_points) text += fmt::format(" pointtype {} pointsize {}", number_of(look.point), look.size);
  if (!look.colour.empty()) text += fmt::format(" linecolor '{}'", look.colour);
  if (!std::isnan(look.width) || !has_line)
    text += fmt::format(" linewidth {}", std::isnan(look.width) ? 1 : look.width);
  if (has_line && !look.dash.empty()) text += " dashtype " + dash_of(look.dash);
  return text;
}

std::string colour_of(const Look& look) { return look.colour.empty() ? line_styles[look.style].colour : look.colour; }

/// What is below a line or a point with a halo.
Look below(Look look, bool has_points) {
  constexpr double rim = 1.7, line_rim = 2.4;
  look.width = (std::isnan(look.width) ? line_styles[look.style].width : look.width) + (has_points ? rim : line_rim);
  look.size *= 1.08;
  look.colour = "#FFFFFF", look.dash = "solid";
  return look;
}

struct Manner {
  bool points, line;
  const char* with;
};
Manner manner(How how) {
  switch (how) {
    case How::points:
      return {true, false, "points"};
    case How::line_and_points:
      return {true, true, "linespoints"};
    case How::steps:
      return {false, true, "steps"};
    case How::bars:
      return {false, true, "boxes"};
    case How::boxplot:
      return {false, true, "boxplot"};
    default:
      return {false, true, "lines"};
  }
}

std::string patch(const std::string& colour) {
  return fmt::format("boxes fillcolor '{}' fillstyle solid 1 border linecolor '#777777'", colour);
}

/// How a line looks in a key.
std::string in_key(const Line& line) {
  if (line.how == How::cells || line.how == How::band || line.how == How::filled) return patch(colour_of(line.look));
  if (line.how == How::bars) return fmt::format("boxes {} fillstyle solid 0.4", look_of(line.look, false, true));
  const auto [points, drawn, with] = manner(line.how);
  return fmt::format("{} {}", with, look_of(line.look, points, drawn));
}

constexpr const char* cividis =
    "# cividis: even steps of lightness, the same for the colour-blind and in grey\n"
    "set palette defined (0 '#00204D', 1 '#00336F', 2 '#39486B', 3 '#575C6D', 4 '#707173', \\\n"
    "                     5 '#8A8779', 6 '#A69D75', 7 '#C4B56C', 8 '#E4CF5B', 9 '#FFEA46')";
const char* palette_of(Palette palette) {
  switch (palette) {
    case Palette::grey:
      return "set palette defined (0 '#FFFFFF', 1 '#111111')";
    case Palette::blue:
      return "set palette defined (0 '#FFFFFF', 0.001 '#EAF1F7', 1 '#00336F')";
    case Palette::signs:
      return "set palette defined (-1 '#B0560F', 0 '#FFFFFF', 1 '#3A8F5C')";
    case Palette::cividis:
      break;
  }
  return cividis;
}

// ---------------------------------------------------------------- plots

std::string expression_of(const Cell& value) {
  if (value.column == 0) return fmt::format("{}", value.plus);
  auto text = fmt::format("${}", value.column);
  if (value.over > 0) text = fmt::format("{}/${}", text, value.over);
  if (value.absolute) text = fmt::format("abs({})", text);
  if (value.factor != 1) text += fmt::format("*{}", value.factor);
  if (value.plus != 0) text = fmt::format("({}+{})", text, value.plus);
  if (!std::isnan(value.least)) text = fmt::format("({0} > {1} ? {0} : {1})", text, value.least);
  return text;
}

std::string condition_of(const std::vector<Where>& where) {
  std::vector<std::string> parts;
  for (const auto& [column, compare, number, text] : where)
    parts.push_back(text.empty()
                        ? fmt::format("${} {} {}", column, compare == '=' ? "==" : std::string(1, compare), number)
                        : fmt::format("strcol({}) eq '{}'", column, text));
  return fmt::format("{}", fmt::join(parts, " && "));
}

/// "2", or "($2*1000)": as gnuplot takes a column.
std::string column_of(const Cell& value, const Along& drawn, const std::vector<Where>& where = {}) {
  const auto plain = expression_of(value), text = drawn.of(plain);
  if (!where.empty()) return fmt::format("({} ? {} : NaN)", condition_of(where), text);
  if (value.column > 0 && text == fmt::format("${}", value.column)) return fmt::format("{}", value.column);
  return '(' + text + ')';
}

/// The script of a figure while it grows.
class Script {
 public:
  explicit Script(const Figure& figure) : figure_(figure) {}
  std::string text();

 private:
  bool is_joined(std::size_t panel) const;
  bool key_is_above(const Panel& panel) const;
  bool is_uniform() const;
  double height(const Panel& panel) const { return panel.height > 0 ? panel.height : figure_.height; }
  Sheet sheet() const;
  void set(const std::string& what, std::string command, const std::string& usual = "");
  void place(std::size_t panel);
  void set_axis(char name, const Axis&, const Along&, bool is_last, Room room);
  void set_key(const Panel&);
  void set_colours(const ColourScale&);
  void set_space(const Panel&, const Along& z);
  void add_rows();
  void add_panel(std::size_t number);
  void add_line(const Panel&, const Line&);
  void add(const std::string& plot, const std::string& title, const std::string& entry, bool hidden = false);
  std::string source(const Line&);

  const Figure& figure_;
  std::string script_;
  std::map<std::string, std::string> settings_;  ///< as they stand
  std::vector<std::string> plots_;               ///< of this panel
  std::set<std::string> titled_;
  Along x_, y_, z_;
  std::vector<double> gaps_;  ///< before each panel
  int blocks_ = 0;
};

/// Titles of a panel's key.
std::set<std::string> titles_of(const Panel& panel) {
  std::set<std::string> titles;
  for (const auto& line : panel.lines) titles.insert(line.title);
  for (const auto& rule : panel.rules) titles.insert(rule.title);
  for (const auto& shade : panel.shades) titles.insert(shade.title);
  for (const auto& mark : panel.marks) titles.insert(mark.title);
  titles.erase("");
  return titles;
}

/// Whether the axis of x of a panel is that of the one below it, which names it.
bool Script::is_joined(std::size_t panel) const {
  if (figure_.columns > 1 || panel + 1 >= figure_.panels.size()) return false;
  const auto &a = figure_.panels[panel].x, &b = figure_.panels[panel + 1].x;
  const auto same = [](double first, double second) {
    return first == second || (std::isnan(first) && std::isnan(second));
  };
  return a.name == b.name && a.unit == b.unit && a.decades == b.decades && same(a.from, b.from) && same(a.to, b.to);
}

bool Script::key_is_above(const Panel& panel) const {
  return figure_.key == Key::own && panel.key.empty() && panel.title.empty() && !titles_of(panel).empty();
}

bool Script::is_uniform() const {
  if (figure_.columns > 1) return true;
  return std::ranges::all_of(figure_.panels, [&](const Panel& panel) { return panel.height == 0; }) &&
         (gaps_.size() < 3 || std::ranges::count(gaps_, gaps_[1]) == std::ptrdiff_t(gaps_.size()) - 1);
}

Sheet Script::sheet() const {
  const auto& panels = figure_.panels;
  Layout layout{
      .width = figure_.width, .panels = int(panels.size()), .columns = figure_.columns, .panel = figure_.height};
  const bool colours = std::ranges::any_of(panels, [](const Panel& panel) { return panel.colours.has_value(); });
  if (colours) layout.right = 120, layout.between_columns = 205;
  for (const auto& panel : panels)  // a surface has its scale of colours and the name of its axis farther away
    if (std::ranges::count(panel.lines, How::surface, &Line::how) > 0) layout.right = 150, layout.below = 66;
  const auto is_titled = [](const Panel& panel) { return !panel.title.empty(); };
  const bool above =
      std::ranges::any_of(panels, [&](const Panel& panel) { return is_titled(panel) || key_is_above(panel); });
  layout.above = above ? 10 + line_above : 10;
  layout.between_rows = gaps_.size() > 1 ? gaps_.back() : 0;
  if (figure_.columns > 1) layout.between_rows = own_gap + (above ? line_above : 0);
  layout.key = figure_.key == Key::own     ? Layout::Key::own
               : figure_.key == Key::below ? Layout::Key::below
                                           : Layout::Key::above;
  for (const auto& panel : panels) {
    if (key_is_above(panel)) layout.own_titles = std::max(layout.own_titles, int(titles_of(panel).size()));
  }
  layout.rows_below = layout.narrow_rows_below = int(figure_.rows.size());
  if (!is_uniform()) {
    layout.panels = 1;
    layout.panel = 0;
    for (const auto& panel : panels) layout.panel += height(panel);
    for (const double gap : gaps_) layout.below += gap;
  }
  return {figure_.name, figure_.what, layout, figure_.title, figure_.caption};
}

void Script::set(const std::string& what, std::string command, const std::string& usual) {
  const auto [entry, is_new] = settings_.try_emplace(what, usual);
  if (entry->second == command) return;
  script_ += command + '\n';
  entry->second = std::move(command);
}

/// Where a panel is that does not stand in rows as high as others.
void Script::place(std::size_t number) {
  double above = 0, gaps = 0, all = 0;
  for (std::size_t i = 0; i < figure_.panels.size(); ++i) {
    const double own = height(figure_.panels[i]);
    all += own;
    if (i < number) above += own;
    if (i <= number) gaps += gaps_[i];
  }
  if (number == 0)
    script_ += fmt::format("part = frame/{}\nset lmargin at screen left/wide\nset rmargin at screen 1-25/wide\n", all);
  const double own = height(figure_.panels[number]);
  script_ += fmt::format(
      "frame = part*{0}\nset tmargin at screen (high-above-{1}-part*{2})/high\n"
      "set bmargin at screen (high-above-{1}-part*{3})/high\n",
      own, gaps, above, above + own);
}

void Script::set_axis(char name, const Axis& axis, const Along& drawn, bool is_last, Room room) {
  const std::string n(1, name);
  set(n + "scale", fmt::format("{}set logscale {}", axis.decades ? "" : "un", name), "unset logscale " + n);
  const bool few = !few_ticks(axis).empty();
  set(n + "format",
      fmt::format("set format {} '{}'", name,
                  !is_last               ? ""
                  : axis.decades && !few ? "10^{%T}"
                                         : "%g"),
      "set format " + n + " '%g'");
  // Gnuplot would go on to whole decades, beyond the ticks.
  const auto range = few && std::isnan(axis.from) && std::isnan(axis.to)
                         ? fmt::format("[{:g}:{:g}]", 0.9 * axis.shown.low, 1.1 * axis.shown.high)
                         : range_of(axis, drawn);
  set(n + "range", fmt::format("set {}range {}", name, range), "set " + n + "range [*:*]");
  set(n + "tics", ticks_of(name, axis, drawn, is_last, room), "set " + n + "tics autofreq");
  set(n + "label",
      is_last ? fmt::format("named = {0}; set {1}label named font fitted_{1}(named)", label_of(axis, drawn), name)
              : fmt::format("unset {}label", name),
      fmt::format("unset {}label", name));
  const char other = name == 'x' ? 'y' : 'x';
  set(n + "zero",
      axis.zero ? fmt::format("set {}zeroaxis linecolor '#555555'", other) : fmt::format("unset {}zeroaxis", other),
      fmt::format("unset {}zeroaxis", other));
}

void Script::set_key(const Panel& panel) {
  if (figure_.key != Key::own) return;
  set("key", panel.key.empty() && panel.title.empty() ? "set key at graph 1,1.02 right bottom horizontal"
             : panel.key.empty()                      ? "set key inside top right horizontal opaque"
                                                      : fmt::format("set key inside {} vertical opaque", panel.key));
}

void Script::set_colours(const ColourScale& colours) {
  const auto& axis = colours.axis;
  set("palette", palette_of(colours.palette));
  set("cbscale", fmt::format("{}set logscale cb", axis.decades ? "" : "un"), "unset logscale cb");
  set("cbformat", fmt::format("set format cb '{}'", axis.decades ? "10^{%T}" : "%g"), "set format cb '%g'");
  set("cbrange", "set cbrange " + range_of(axis, z_));
  set("cblabel", fmt::format("named = {}; set cblabel named offset 1,0 font fitted_y(named)", label_of(axis, z_)));
}

/// The last panel, in space.
void Script::set_space(const Panel& panel, const Along& z) {
  constexpr double few = 3;  // labels along a side that is seen from its end
  const auto step = [&](const Axis& axis, const Along& drawn) {
    return axis.decades ? std::pow(10, std::ceil(std::log10(axis.shown.high / axis.shown.low) / few))
                        : 2 * tick_step(drawn.range.low, drawn.range.high);
  };
  script_ +=
      fmt::format("set xlabel {} offset 0,-1\nset ylabel {} offset 2,-1\nset zlabel {} rotate by 90 offset -3,0\n",
                  label_of(panel.x, x_), label_of(panel.y, y_), label_of(*panel.z, z));
  script_ += fmt::format("set xtics {:g} offset -1,-0.5\nset ytics {:g}\n", step(panel.x, x_), step(panel.y, y_));
  script_ +=
      "set origin narrow ? 0.16 : 0.15,below_rows/high\nset size narrow ? 0.74 : 0.7,(frame+100)/high\n"
      "unset lmargin\nunset rmargin\nunset tmargin\nunset bmargin\nset view 62,35,1.15,1\nset xyplane 0\nunset key\n";
}

/// Names and texts below the panels.
void Script::add_rows() {
  constexpr double line = 19;  // pixels
  std::size_t longest = 0;
  for (const auto& [name, text] : figure_.rows) longest = std::max(longest, name.size());
  if (longest > 0) script_ += fmt::format("beside = 35 + {} * (narrow ? 5.7 : 7.5)\n", longest);
  double below = 0;
  for (const auto& [name, text] : figure_.rows) {
    below += line;
    const auto at = fmt::format("wide,(below_rows-{})/high font narrow ? small : font", below - line / 2);
    script_ += fmt::format("set label {} at screen 20/{}\nset label {} at screen beside/{}\n", single_quoted(name), at,
                           single_quoted(text), at);
  }
}

/// \param entry how the title stands in the key, where the plot cannot show it
void Script::add(const std::string& plot, const std::string& title, const std::string& entry, bool hidden) {
  const bool shown = !title.empty() && titled_.insert(title).second;
  plots_.push_back(plot + (shown && !hidden ? " title " + single_quoted(title) : " notitle"));
  if (shown && hidden) plots_.push_back(fmt::format("NaN with {} title {}", entry, single_quoted(title)));
}

std::string Script::source(const Line& line) {
  if (line.rows.empty()) return fmt::format("'{}'", line.table);
  script_ += fmt::format("$rows{} << EOD\n", ++blocks_);
  for (const auto& row : line.rows) script_ += fmt::format("{}\n", fmt::join(row, ","));
  script_ += "EOD\n";
  return fmt::format("$rows{}", blocks_);
}

void Script::add_line(const Panel& panel, const Line& line) {
  const auto data = source(line);
  const auto x = column_of(line.x, x_), y = column_of(line.y, y_, line.where);
  const auto entry = in_key(line);
  switch (line.how) {
    case How::band:
      return add(fmt::format("{} using {}:{}:{} with filledcurves linecolor '{}'", data, x, column_of(line.low, y_),
                             column_of(line.high, y_), colour_of(line.look)),
                 line.title, entry);
    case How::filled:
      return add(fmt::format("{} using {}:{} with filledcurves y1=0 linecolor '{}'", data, x, y, colour_of(line.look)),
                 line.title, entry);
    case How::upright:
      return add(
          fmt::format("{} using {}:({} ? {} : NaN):(0):({}) with vectors nohead {}", data, x, condition_of(line.where),
                      y_.range.low, y_.range.high - y_.range.low, look_of(line.look, false, true)),
          line.title, fmt::format("lines {}", look_of(line.look, false, true)));
    case How::cells: {
      const bool palette = line.z.column > 0;
      const auto corner = [&](int i, const Along& axis, const Axis& of) {
        auto text = axis.of(fmt::format("${}", line.corners + i));
        // Cells on a scale of colours overlap by a trifle, so that no seams show.
        if (palette && i % 2 == 1 && std::isfinite(of.to))
          text += of.decades ? fmt::format("*{:.6g}", std::pow(of.to / of.from, 0.002))
                             : fmt::format("+{:.6g}", 0.002 * (axis(of.to) - axis(of.from)));
        return '(' + text + ')';
      };
      const auto corners = fmt::format("{}:{}:{}:{}", corner(0, x_, panel.x), corner(1, x_, panel.x),
                                       corner(2, y_, panel.y), corner(3, y_, panel.y));
      if (palette)
        return add(fmt::format("{} using {}:{}:{}:{} with boxxyerror linecolor palette fillstyle solid 1 noborder",
                               data, x, column_of(line.y, y_), corners, column_of(line.z, z_, line.where)),
                   "", "");
      const auto colour = colour_of(line.look);  // borders of their colour, so that no seams show
      return add(fmt::format("{} using {}:{}:{} with boxxyerror fillcolor '{}' fillstyle solid 1 border linecolor '{}'",
                             data, x, y, corners, colour, colour),
                 line.title, entry, true);
    }
    case How::image: {
      if (!line.grid)
        return add(fmt::format("{} using {}:{}:{} skip 1 with image", data, x, y, column_of(line.z, z_)), "", "");
      const auto& g = *line.grid;
      // Images know no logarithmic axes: a second pair of axes is regular for them.
      const auto along = [](const Axis& axis, const Along& drawn, double value) {
        return axis.decades ? std::log10(value) : drawn(value);
      };
      for (const auto& [name, axis, drawn] : {std::tuple{'x', &panel.x, &x_}, {'y', &panel.y, &y_}})
        set(fmt::format("{}2range", name), fmt::format("set {}2range [{}:{}]", name, along(*axis, *drawn, axis->from),
                                                       along(*axis, *drawn, axis->to)));
      const double left = along(panel.x, x_, g.x_first), low = along(panel.y, y_, g.y_first);
      return add(fmt::format("{} binary array=({},{}) skip={} format='%double' origin=({},{}) dx={} dy={} axes x2y2 "
                             "with image",
                             data, g.columns, g.rows, g.first * sizeof(double), left, low,
                             (along(panel.x, x_, g.x_last) - left) / std::max(g.columns - 1, 1),
                             (along(panel.y, y_, g.y_last) - low) / std::max(g.rows - 1, 1)),
                 "", "");
    }
    case How::surface:
      return add(fmt::format("{} using {}:{}:{} skip 1", data, x, y, column_of(line.z, z_)), "", "");
    case How::boxplot:
      return add(fmt::format("{} using {}:{} skip 1 with boxplot {}", data, x, y, look_of(line.look, false, true)), "",
                 "");
    default:
      break;
  }
  const auto [points, drawn, with] = manner(line.how);
  auto columns = fmt::format("{} using {}:{}", data, x, y);
  if (panel.z) columns += ':' + column_of(line.z, z_);
  columns += line.how == How::bars ? " skip 1" : line.sorted ? " smooth unique" : "";
  if (line.look.halo)
    add(fmt::format("{} with {} {}", columns, with, look_of(below(line.look, points), points, drawn)), "", "");
  add(fmt::format("{} with {} {}{}", columns, with, look_of(line.look, points, drawn),
                  line.how == How::bars ? " fillstyle solid 0.4" : ""),
      line.title, entry);
}

void Script::add_panel(std::size_t number) {
  const auto& panel = figure_.panels[number];
  const bool is_last = number + 1 == figure_.panels.size();
  script_ += '\n';
  if (!is_uniform()) place(number);
  x_ = drawn(panel.x, false), y_ = drawn(panel.y, true);
  z_ = panel.colours ? drawn(panel.colours->axis, false) : panel.z ? drawn(*panel.z, false) : Along{};
  set("grid", panel.grid ? "set grid" : "unset grid");
  set_axis('x', panel.x, x_, !is_joined(number), figure_.columns > 1 ? Room::narrow : Room::wide);
  set_axis('y', panel.y, y_, true, height(panel) < small_panel ? Room::low : panel.colours ? Room::narrow : Room::wide);
  // Texts stand in a band above the curves.
  const auto room = [](const Axis& axis, double end, double given, double usual) {
    return axis.decades || !std::isnan(end) ? 0 : std::isnan(given) ? usual : given;
  };
  const double above = room(panel.y, panel.y.to, panel.y.after, 0.05) + 0.1 * double(panel.notes.size());
  const std::array rooms = {room(panel.x, panel.x.from, panel.x.before, 0), room(panel.x, panel.x.to, panel.x.after, 0),
                            above, room(panel.y, panel.y.from, panel.y.before, 0.05)};
  const bool none = std::ranges::all_of(rooms, [](double part) { return part == 0; });
  set("offsets",
      none ? "unset offsets"
           : fmt::format("set offsets graph {:g}, graph {:g}, graph {:g}, graph {:g}", rooms[0], rooms[1], rooms[2],
                         rooms[3]),
      "unset offsets");
  const bool narrow_boxes = std::ranges::any_of(
      panel.lines, [](const Line& line) { return line.how == How::bars || line.how == How::boxplot; });
  set("boxes", narrow_boxes ? "set boxwidth 0.5" : "set boxwidth", "set boxwidth");
  set("size", panel.equal_scales ? "set size ratio -1" : "set size noratio", "set size noratio");
  set("title",
      panel.title.empty()
          ? "unset title"
          : fmt::format("named = {}; set title named offset 0,-0.4 font fitted_x(named)", single_quoted(panel.title)),
      "unset title");
  set_key(panel);
  if (panel.colours) set_colours(*panel.colours);
  if (panel.z) set_space(panel, z_);

  std::string across;  // the panel, behind and before its lines
  for (const auto& shade : panel.shades) {
    const auto& axis = shade.axis == 'x' ? x_ : y_;
    const auto corner = [&](double value, int end) {
      return shade.axis == 'x' ? fmt::format("first {},graph {}", axis(value), end)
                               : fmt::format("graph {},first {}", end, axis(value));
    };
    const auto ends = corner(shade.from, 0) + " to " + corner(shade.to, 1);
    across += fmt::format("\nset object rectangle from {} behind fillcolor '{}' fillstyle solid noborder", ends,
                          shade.colour);
  }
  for (const auto& rule : panel.rules)
    for (const auto& look : rule.look.halo ? std::vector{below(rule.look, false), rule.look} : std::vector{rule.look})
      if (rule.axis == 'x')
        across += fmt::format("\nset arrow from first {0},graph 0 to first {0},graph 1 nohead {1}{2}", x_(rule.at),
                              look_of(look, false, true), look.halo ? " front" : "");
  for (const auto& [from_x, from_y, to_x, to_y, name] : panel.measures) {
    across += fmt::format(
        "\nset arrow from {:.8g},{:.8g} to {:.8g},{:.8g} heads filled size graph 0.015,20 front linecolor '#B0560F' "
        "linewidth 1.4",
        x_(from_x), y_(from_y), x_(to_x), y_(to_y));
    across += fmt::format("\nset label {} at {:.8g},{:.8g} {} front textcolor '#B0560F'", single_quoted(name),
                          x_((from_x + to_x) / 2), y_((from_y + to_y) / 2),
                          from_x == to_x ? "right offset -0.7,0" : "center offset 0,-0.9");
  }
  for (std::size_t i = 0; i < panel.notes.size(); ++i)
    across += fmt::format("\nset label {} at graph 0.97, graph {:.3f} right", single_quoted(panel.notes[i]),
                          0.94 - 0.075 * double(i));
  for (const auto& mark : panel.marks) {
    if (mark.text.empty()) continue;
    const char* side = mark.side == Side::left    ? "right offset -0.8,0"
                       : mark.side == Side::right ? "left offset 0.8,0"
                       : mark.side == Side::below ? "center offset 0,-1.2"
                                                  : "center offset 0,1.1";
    across +=
        fmt::format("\nset label {} at {:.8g},{:.8g} {} front", single_quoted(mark.text), x_(mark.x), y_(mark.y), side);
  }
  set("across", "unset arrow; unset object; unset label" + across, "unset arrow; unset object; unset label");
  if (is_last) add_rows();

  plots_.clear();
  if (figure_.key == Key::own) titled_.clear();
  for (const auto& line : panel.lines) add_line(panel, line);
  for (const auto& mark : panel.marks) {
    if (!mark.point) continue;
    Line line{.table = "", .how = How::points, .look = mark.look, .title = mark.title, .rows = {{mark.x, mark.y}}};
    add_line(panel, line);
  }
  const auto entry = [](const Look& look) { return "lines " + look_of(look, false, true); };
  for (const auto& rule : panel.rules) {
    if (rule.axis == 'y' && rule.look.halo)
      add(fmt::format("{} with {}", y_(rule.at), entry(below(rule.look, false))), "", "");
    if (rule.axis == 'y') add(fmt::format("{} with {}", y_(rule.at), entry(rule.look)), rule.title, "");
    if (rule.axis == 'x' && !rule.title.empty() && titled_.insert(rule.title).second)
      plots_.push_back(fmt::format("NaN with {} title {}", entry(rule.look), single_quoted(rule.title)));
  }
  for (const auto& shade : panel.shades)
    if (!shade.title.empty() && titled_.insert(shade.title).second)
      plots_.push_back(fmt::format("NaN with {} title {}", patch(shade.colour), single_quoted(shade.title)));
  if (number == 0 && figure_.key != Key::own)  // the key is of all panels
    for (const auto& other : figure_.panels)
      for (const auto& line : other.lines)
        if (!line.title.empty() && titled_.insert(line.title).second)
          plots_.push_back(fmt::format("NaN with {} title {}", in_key(line), single_quoted(line.title)));
  const bool surface = std::ranges::any_of(panel.lines, [](const Line& line) { return line.how == How::surface; });
  if (surface) set("surface", "set pm3d map corners2color c1");
  script_ += fmt::format("{} {}\n", panel.z || surface ? "splot" : "plot", fmt::join(plots_, ", \\\n     "));
}

std::string Script::text() {
  for (std::size_t i = 0; i < figure_.panels.size(); ++i) {
    const auto& panel = figure_.panels[i];
    const double above = !panel.title.empty() || key_is_above(panel) ? line_above : 0;
    gaps_.push_back(i == 0 ? 0 : (is_joined(i - 1) ? joined_gap : own_gap) + above);
  }
  for (std::size_t i = 0; i < figure_.panels.size(); ++i) add_panel(i);
  return sheet().with(std::move(script_));
}

void write_table(const std::filesystem::path& path, const FigureTable& table) {
  fmt::memory_buffer text;
  const auto write_row = [&](auto cell) {
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      fmt::format_to(std::back_inserter(text), "{}{}", c == 0 ? "" : ",", cell(table.columns[c]));
    text.push_back('\n');
  };
  using Column = FigureTable::Column;
  write_row([](const Column& column) { return column.header; });
  const auto& first = table.columns.front();
  for (std::size_t row = 0; row < std::max(first.values.size(), first.texts.size()); ++row) {
    const auto is_empty = [&](const Column& column) { return column.texts.empty() && std::isnan(column.values[row]); };
    if (std::ranges::all_of(table.columns, is_empty))
      text.push_back('\n');
    else
      write_row([&](const Column& column) {
        return column.texts.empty() ? fmt::format("{}", column.values[row]) : column.texts[row];
      });
  }
  write_whole(path, std::string_view(text.data(), text.size()));
}

}  // namespace

namespace {

/// An axis along which all values are one has room on both sides: no program draws from a value to itself.
void widen(Axis& axis) {
  if (!(axis.from == axis.to)) return;
  const double room = axis.from == 0 ? 1 : 0.1 * std::abs(axis.from);
  axis.from -= room, axis.to += room;
}

}  // namespace

std::vector<std::string> write(const std::filesystem::path& folder, Figure figure) {
  for (auto& panel : figure.panels) widen(panel.x), widen(panel.y);
  std::vector<std::string> files;
  for (const auto& table : figure.tables) write_table(folder / files.emplace_back(table.file), table);
  write_whole(folder / files.emplace_back(figure.name + ".gp"), Script(figure).text());
  write_whole(folder / files.emplace_back(figure.name + ".figure.json"), to_json(figure));
  return files;
}

}  // namespace rosin::app::output
