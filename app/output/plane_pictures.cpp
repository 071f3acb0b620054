/// Pictures of parameter planes: maps, and where measurements tell laws apart.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "analysis/inference/discrimination.hpp"
#include "analysis/planes/map.hpp"
#include "app/output/caption.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/compare.hpp"

namespace rosin::app::output {

namespace fs = std::filesystem;

namespace {

constexpr const char* palette = R"(# cividis: even steps of lightness, the same for the colour-blind and in grey
set palette defined (0 '#00204D', 1 '#00336F', 2 '#39486B', 3 '#575C6D', 4 '#707173', \
                     5 '#8A8779', 6 '#A69D75', 7 '#C4B56C', 8 '#E4CF5B', 9 '#FFEA46')
set style fill solid 1 noborder
unset key
set cblabel offset 1,0
)";

/// An axis as it is drawn: decades along a logarithmic scale; values outside the scale stand below it, after a gap.
class DrawnAxis {
 public:
  explicit DrawnAxis(const analysis::planes::Axis& axis) : axis_(axis) {
    const auto regular = static_cast<std::size_t>(axis.regular);
    for (std::size_t i = 0; i < regular; ++i) centre_.push_back(coordinate(axis.values[i]));
    cell_ = (centre_.back() - centre_.front()) / double(regular - 1);
    const auto [low, high] = std::minmax(centre_.front(), centre_.back());
    low_ = low, high_ = high;
    for (std::size_t i = regular; i < axis.values.size(); ++i)
      centre_.push_back(low - (2.5 + 1.5 * double(axis.values.size() - 1 - i)) * thickness());
  }
  double coordinate(double value) const { return axis_.logarithmic ? std::log10(value) : value; }
  double centre(std::size_t i) const { return centre_[i]; }
  double half_width(std::size_t i) const { return outside(i) ? thickness() / 2 : std::abs(cell_) / 2; }
  bool has_outside() const { return centre_.size() > static_cast<std::size_t>(axis_.regular); }
  bool outside(std::size_t i) const { return i >= static_cast<std::size_t>(axis_.regular); }
  /// The place of the scale's i-th value from below.
  std::size_t rising(int i) const { return static_cast<std::size_t>(cell_ > 0 ? i : axis_.regular - 1 - i); }
  double lowest() const { return low_; }
  double cell() const { return std::abs(cell_); }
  /// Lowest and highest coordinate of a cell's border.
  std::pair<double, double> ends() const {
    const double margin = std::abs(cell_) / 2;
    double low = low_ - margin;
    for (std::size_t i = 0; i < centre_.size(); ++i) low = std::min(low, centre_[i] - half_width(i));
    return {low, high_ + margin};
  }
  /// Ticks as gnuplot takes them: whole decades, of which at most so many are labelled, and the values outside the
  /// scale by themselves.
  std::string ticks(int most) const {
    std::vector<std::string> list;
    if (axis_.logarithmic) {
      const int first = static_cast<int>(std::ceil(low_ - 1e-9)), last = static_cast<int>(std::floor(high_ + 1e-9));
      const int every = std::max(1, (last - first + most - 1) / most);
      for (int decade = first; decade <= last; ++decade) {
        const bool labelled = (decade - first) % every == 0;
        list.push_back(labelled ? fmt::format("'10^{{{}}}' {}", decade, decade) : fmt::format("'' {} 1", decade));
      }
      if (last - first < 1)  // less than two decades: label the ends themselves
        for (const double end : {low_, high_}) list.push_back(fmt::format("'{:.3g}' {}", std::pow(10, end), end));
    } else {
      constexpr int intervals = 5;
      for (int i = 0; i <= intervals; ++i) {
        const double at = low_ + (high_ - low_) * i / intervals;
        list.push_back(fmt::format("'{:.4g}' {}", at, at));
      }
    }
    for (std::size_t i = 0; i < centre_.size(); ++i)
      if (outside(i)) list.push_back(fmt::format("'{:g}' {}", axis_.values[i], centre_[i]));
    return fmt::format("({})", fmt::join(list, ", "));
  }

 private:
  double thickness() const { return std::max(std::abs(cell_), (high_ - low_) / 40); }
  analysis::planes::Axis axis_;
  std::vector<double> centre_;
  double cell_ = 0, low_ = 0, high_ = 0;
};

/// Planes with more values a side are drawn as images: as boxes their cells would be smaller than a screen can show.
constexpr int finest_boxes = 160;
bool drawn_as_image(const analysis::planes::Map& map) { return std::max(map.x.regular, map.y.regular) > finest_boxes; }

/// Cells as boxes. Of a plane that is drawn as an image those outside its scales only.
void write_cells(const fs::path& path, const analysis::planes::Map& map, const DrawnAxis& x, const DrawnAxis& y) {
  const auto width = map.x.values.size();
  const bool image = drawn_as_image(map);
  std::vector<std::string> names = {"x", "y", "x_low", "x_high", "y_low", "y_high"};
  const auto geometry = names.size();
  for (const auto& metric : map.metrics) names.push_back(metric.name);
  std::vector<std::vector<double>> columns(names.size());
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const auto ix = i % width, iy = i / width;
    if (image && !x.outside(ix) && !y.outside(iy)) continue;
    const double cell[] = {x.centre(ix),
                           y.centre(iy),
                           x.centre(ix) - x.half_width(ix),
                           x.centre(ix) + x.half_width(ix),
                           y.centre(iy) - y.half_width(iy),
                           y.centre(iy) + y.half_width(iy)};
    for (std::size_t c = 0; c < geometry; ++c) columns[c].push_back(cell[c]);
    for (std::size_t m = 0; m < map.metrics.size(); ++m)
      columns[geometry + m].push_back(map.metrics[m].value(map.points[i]));
  }
  std::vector<Column> table;
  for (std::size_t c = 0; c < columns.size(); ++c) table.push_back({names[c], columns[c]});
  write_csv(path, table);
}

/// The metrics on the scales of both axes, one after the other, as doubles in rows from the lower left.
void write_grid(const fs::path& path, const analysis::planes::Map& map, const DrawnAxis& x, const DrawnAxis& y) {
  std::string bytes;
  for (const auto& metric : map.metrics)
    for (int j = 0; j < map.y.regular; ++j)
      for (int i = 0; i < map.x.regular; ++i) {
        const auto& point = map.points[y.rising(j) * map.x.values.size() + x.rising(i)];
        const double value = metric.value(point);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
  write_whole(path, bytes);
}

/// Points that may carry a mark: of those with a cycle, or steady, so few that colours show between them, of the others
/// so many that marks touch.
void write_marks(const fs::path& path, const analysis::planes::Map& map, const DrawnAxis& x, const DrawnAxis& y) {
  constexpr std::size_t most_cycles = 24, most_others = finest_boxes;  // a side
  const auto width = map.x.values.size(), height = map.y.values.size();
  const auto spacing = [](std::size_t n, std::size_t most) { return (n + most - 1) / most; };
  std::vector<std::vector<double>> columns(3);
  std::set<std::tuple<analysis::planes::Regime, std::size_t, std::size_t>> marked;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const auto regime = map.points[i].regime;
    const auto ix = i % width, iy = i / width;
    if (regime == analysis::planes::Regime::cycle || regime == analysis::planes::Regime::stable) {
      if (ix % spacing(width, most_cycles) != 0 || iy % spacing(height, most_cycles) != 0) continue;
    } else if (!marked.emplace(regime, ix / spacing(width, most_others), iy / spacing(height, most_others)).second) {
      continue;
    }
    columns[0].push_back(double(regime));
    columns[1].push_back(x.centre(ix));
    columns[2].push_back(y.centre(iy));
  }
  write_csv(path, {{"regime", columns[0]}, {"x", columns[1]}, {"y", columns[2]}});
}

void write_line(const fs::path& path, const analysis::planes::Polyline& line, const DrawnAxis& x, const DrawnAxis& y) {
  std::string text = "x,y\n";
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (std::isnan(line.x[i]))
      text += '\n';
    else
      text += fmt::format("{},{}\n", x.coordinate(line.x[i]), y.coordinate(line.y[i]));
  }
  write_whole(path, text);
}

/// The colour scale of a metric: from zero for fractions, decades where the values span some.
std::string colour_scale(const analysis::planes::Map& map, const analysis::planes::PlaneMetric& metric) {
  const bool fraction = metric.unit == "1";
  double low = infinity, high = -infinity, least = infinity;
  for (const auto& point : map.points)
    if (const double value = metric.value(point); std::isfinite(value)) {
      low = std::min(low, value), high = std::max(high, value);
      if (value > metric.error(point)) least = std::min(least, value);  // of those that are not nought
    }
  const bool decades = !fraction && low >= 0 && spans_decades(least, high);
  const auto range = !std::isfinite(low)    ? std::string("[0:1]")
                     : fraction && low >= 0 ? std::string("[0:*]")
                     : decades              ? fmt::format("[{}:*]", least)
                                            : std::string("[*:*]");
  return fmt::format("set cblabel {}\n{} logscale cb\nset format cb '{}'\nset cbrange {}\n",
                     label(readable(metric.name), metric.unit), decades ? "set" : "unset", decades ? "10^{%T}" : "%g",
                     range);
}

/// Marks of the points of each regime and the threshold: further curves of each panel, and one key below all panels:
/// marks in a row, lines in a second where the sheet is narrow.
struct Marks {
  std::string curves, key;
};
Marks marks(const analysis::planes::Map& map) {
  struct Mark {
    analysis::planes::Regime regime;
    const char *style, *title;
  };
  using analysis::planes::Regime;
  // black on white, so that marks and lines show on every colour
  const Mark list[] = {{Regime::cycle, "pointtype 1 pointsize 0.65 linewidth 2.6 linecolor '#FFFFFF'", ""},
                       {Regime::cycle, "pointtype 1 pointsize 0.6 linewidth 0.9 linecolor '#000000'", "cycle"},
                       {Regime::stable, "pointtype 1 pointsize 0.65 linewidth 2.6 linecolor '#FFFFFF'", ""},
                       {Regime::stable, "pointtype 1 pointsize 0.6 linewidth 0.9 linecolor '#000000'", "steady"},
                       {Regime::bistable, "pointtype 7 pointsize 0.55 linecolor '#FFFFFF'", ""},
                       {Regime::bistable, "pointtype 6 pointsize 0.55 linewidth 1.2 linecolor '#000000'", "bistable"},
                       {Regime::failed, "pointtype 2 pointsize 0.7 linewidth 1.8 linecolor '#D01C00'", "failed"}};
  const auto all = [&](Regime regime) {
    return std::ranges::all_of(map.points, [&](const auto& point) { return point.regime == regime; });
  };
  // Where no threshold parts cycles from steady sliding, those are marked that are the exception.
  const auto number_of = [&](Regime regime) {
    return std::ranges::count(map.points, regime, &analysis::planes::MapPoint::regime);
  };
  const auto cycles = number_of(Regime::cycle), steady = number_of(Regime::stable);
  const auto is_plain = [&](Regime regime) {
    return (regime == Regime::cycle && (!map.threshold.x.empty() || cycles >= steady)) ||
           (regime == Regime::stable && (!map.threshold.x.empty() || steady > cycles));
  };
  Marks result;
  double at = 60;  // of the key's entries, pixels from the left
  for (const auto& mark : list) {
    if (std::ranges::none_of(map.points, [&](const auto& point) { return point.regime == mark.regime; })) continue;
    if (is_plain(mark.regime)) continue;
    result.curves += fmt::format(", \\\n     'map-marks.csv' using 2:($1=={} ? $3 : NaN) with points {} notitle",
                                 int(mark.regime), mark.style);
    if (std::string_view(mark.title).empty()) continue;
    result.key += fmt::format("set label '{}' at screen {}./wide,rows_top-9/high left offset 1.2,0 point {}\n",
                              mark.title, at, mark.style);
    at += 100;
  }
  result.key += fmt::format("at = narrow ? 12 : {}; row = narrow ? 28 : 9\n", at);
  const auto line = [&](const char* file, const char* dash, const char* title, int length) {
    for (const auto& [width, colour] : {std::pair{5, "#FFFFFF"}, {2, "#000000"}})
      result.curves +=
          fmt::format(", \\\n     '{}' using 1:2 with lines linewidth {} dashtype {} linecolor '{}' notitle", file,
                      width, width == 5 ? "solid" : dash, colour);
    result.key += fmt::format(
        "set arrow from screen at/wide,rows_top-row/high to screen (at+34)/wide,rows_top-row/high nohead linewidth 2 "
        "dashtype {}\nset label '{}' at screen (at+42)/wide,rows_top-row/high left\nat = at + {}\n",
        dash, title, length);
  };
  if (!map.threshold.x.empty()) {
    line("map-threshold.csv", "solid", "threshold of steady sliding", 245);
    if (!map.fold.x.empty()) line("map-fold.csv", "(6,4)", "fold of cycles", 160);
  } else if (all(Regime::stable)) {
    result.key = "set label 'steady sliding is stable everywhere here' at screen 60./wide,rows_top-9/high left\n";
  }
  return result;
}

/// Planes side by side, two across.
Sheet sheet_of_planes(const std::string& name, const char* what, const scene::Scene& scene,
                      const analysis::planes::Axis& x, const analysis::planes::Axis& y, int count, const Layout& own) {
  Layout layout = own;
  layout.panels = count, layout.columns = std::min(count, 2);
  layout.width = 60 + 540 * layout.columns;
  layout.panel = 340, layout.right = 110, layout.between_columns = 205;
  layout.key = Layout::Key::own;
  return {name, what, layout, scene.title, caption(scene, {x.parameter, y.parameter})};
}

/// Their axes and palette.
std::string frame_of_planes(const scene::Scene& scene, const analysis::planes::Axis& x_axis,
                            const analysis::planes::Axis& y_axis) {
  const DrawnAxis x(x_axis), y(y_axis);
  const auto [x_low, x_high] = x.ends();
  const auto [y_low, y_high] = y.ends();
  const auto named = [&](char axis, const std::string& parameter) {
    const auto quantity = scene.describe(parameter);
    return axis_label(axis, parameter, quantity.meaning, quantity.unit);
  };
  return fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\nset xtics {}\nset ytics {}\n", x_low, x_high, y_low,
                     y_high, x.ticks(5), y.ticks(8)) +
         fmt::format("set xlabel {}\nset ylabel {}\n", named('x', x_axis.parameter), named('y', y_axis.parameter)) +
         palette;
}

}  // namespace

std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::planes::Map& map) {
  const DrawnAxis x(map.x), y(map.y);
  const bool image = drawn_as_image(map), boxes = !image || x.has_outside() || y.has_outside();
  std::vector<std::string> files = {"map-marks.csv", "map-threshold.csv", "map-fold.csv", "map.gp"};
  write_marks(folder / "map-marks.csv", map, x, y);
  write_line(folder / "map-threshold.csv", map.threshold, x, y);
  write_line(folder / "map-fold.csv", map.fold, x, y);
  if (boxes) write_cells(folder / files.emplace_back("map-cells.csv"), map, x, y);
  if (image) write_grid(folder / files.emplace_back("map-grid.bin"), map, x, y);
  const int count = static_cast<int>(map.metrics.size());
  const auto sheet = sheet_of_planes("map", "Metrics over a parameter plane", scene, map.x, map.y, count,
                                     {.between_rows = 80, .rows_below = 1, .narrow_rows_below = 2});
  std::string script = frame_of_planes(scene, map.x, map.y);
  const auto [x_low, x_high] = x.ends();
  const auto [y_low, y_high] = y.ends();
  if (boxes)
    script += fmt::format("# cells overlap by a trifle, so that no seams show\nover_x = {:g}\nover_y = {:g}\n",
                          0.002 * (x_high - x_low), 0.002 * (y_high - y_low));
  const auto [curves, key] = marks(map);
  script += key;
  for (int m = 0; m < count; ++m) {
    script += '\n' + colour_scale(map, map.metrics[static_cast<std::size_t>(m)]);
    std::vector<std::string> layers;
    if (image)
      layers.push_back(fmt::format(
          "'map-grid.bin' binary array=({},{}) skip={} format='%double' origin=({},{}) dx={} dy={} with image notitle",
          map.x.regular, map.y.regular, std::size_t(m) * map.x.regular * map.y.regular * sizeof(double), x.lowest(),
          y.lowest(), x.cell(), y.cell()));
    if (boxes)
      layers.push_back(fmt::format(
          "'map-cells.csv' using 1:2:3:($4+over_x):5:($6+over_y):{} with boxxyerror linecolor palette notitle", 7 + m));
    script += fmt::format("plot {}{}\nunset label\nunset arrow\n", fmt::join(layers, ", \\\n     "), curves);
  }
  write_whole(folder / "map.gp", sheet.with(std::move(script)));
  return files;
}

std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::inference::Design& design) {
  const DrawnAxis x(design.x), y(design.y);
  const auto width = design.x.values.size();
  const bool alone = design.by_metric.size() == 1;
  std::vector<const std::vector<double>*> planes{&design.information};
  std::vector<std::string> titles{"all metrics together"};
  for (std::size_t m = 0; !alone && m < design.by_metric.size(); ++m) {
    planes.push_back(&design.by_metric[m]);
    titles.push_back(readable(scene.task<tasks::Compare>().noise[m].metric) + " alone");
  }
  std::vector<std::vector<double>> columns(6 + planes.size());
  std::vector<std::string> names = {"x", "y", "x_low", "x_high", "y_low", "y_high"};
  double most = 0;
  for (std::size_t i = 0; i < design.information.size(); ++i) {
    const auto ix = i % width, iy = i / width;
    const double cell[] = {x.centre(ix),
                           y.centre(iy),
                           x.centre(ix) - x.half_width(ix),
                           x.centre(ix) + x.half_width(ix),
                           y.centre(iy) - y.half_width(iy),
                           y.centre(iy) + y.half_width(iy)};
    for (std::size_t c = 0; c < std::size(cell); ++c) columns[c].push_back(cell[c]);
    for (std::size_t p = 0; p < planes.size(); ++p) {
      columns[6 + p].push_back((*planes[p])[i]);
      if (std::isfinite((*planes[p])[i])) most = std::max(most, (*planes[p])[i]);
    }
  }
  names.insert(names.end(), titles.begin(), titles.end());
  std::vector<Column> table;
  for (std::size_t c = 0; c < columns.size(); ++c) table.push_back({names[c], columns[c]});
  write_csv(folder / "design-cells.csv", table);
  std::vector<std::string> files{"design-cells.csv"};
  for (std::size_t k = 0; k < design.maps.size(); ++k) {
    files.push_back(fmt::format("design-threshold-{}.csv", k + 1));
    write_line(folder / files.back(), design.maps[k].threshold, x, y);
  }

  const int count = static_cast<int>(planes.size());
  const auto sheet = sheet_of_planes("design", "Where measurements tell the members apart", scene, design.x, design.y,
                                     count, {.above = 34, .between_rows = 100});
  std::string script = frame_of_planes(scene, design.x, design.y);
  const auto& parameter = scene.task<tasks::Compare>().parameter;
  const auto symbol = symbol_of(parameter);
  // Five decades below the most; white where less, or nothing, is to be learned.
  script += fmt::format("set logscale cb\nset format cb '10^{{%T}}'\nset cbrange [{0}:{1}]\nset cblabel {2}\n",
                        most > 0 ? most * 1e-5 : 1e-5, most > 0 ? most : 1.0,
                        single_quoted(parameter.empty() ? std::string("log-likelihood ratio of one measurement")
                                      : symbol.empty()  ? "information on ln " + parameter
                                                        : "information on ln " + symbol));
  const double least = most > 0 ? most * 1e-5 : 1e-5;
  for (int p = 0; p < count; ++p) {
    script += fmt::format("\nset title {}\n", single_quoted(titles[std::size_t(p)]));
    script += fmt::format(
        "plot 'design-cells.csv' using 1:2:3:4:5:6:(${0} > {1} ? ${0} : NaN) with boxxyerror linecolor palette notitle",
        7 + p, least);
    for (std::size_t k = 0; k < design.maps.size(); ++k)
      if (!design.maps[k].threshold.x.empty())
        script += fmt::format(
            ", \\\n     '{0}' using 1:2 with lines linewidth 3 linecolor '#FFFFFF' notitle, "
            "'{0}' using 1:2 with lines linewidth 1.6 dashtype {1} linecolor '#000000' notitle",
            files[1 + k],
            k == 0   ? "solid"
            : k == 1 ? "(8,4)"
                     : "(2,3)");
    script += '\n';
  }
  write_whole(folder / "design.gp", sheet.with(std::move(script)));
  files.push_back("design.gp");
  return files;
}

}  // namespace rosin::app::output
