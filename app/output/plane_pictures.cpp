/// Pictures of parameter planes: maps, and where measurements tell laws apart.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "analysis/inference/discrimination.hpp"
#include "analysis/planes/map.hpp"
#include "app/output/figure.hpp"
#include "app/output/pictures.hpp"
#include "app/output/scene_figure.hpp"
#include "app/output/symbols.hpp"
#include "app/tasks/compare.hpp"
#include "core/files.hpp"

namespace rosin::app::output {

using namespace results;

namespace {

using analysis::planes::Regime;

/// Cells along an axis; values outside its scale, such as 0 of a logarithmic one, stand below it after a gap.
class CellAxis {
 public:
  explicit CellAxis(const analysis::planes::Axis& axis) : axis_(axis) {
    const auto regular = static_cast<std::size_t>(axis.regular);
    for (std::size_t i = 0; i < regular; ++i)
      place_.push_back(axis.logarithmic ? std::log10(axis.values[i]) : axis.values[i]);
    cell_ = (place_.back() - place_.front()) / double(regular - 1);
    const auto [low, high] = std::minmax(place_.front(), place_.back());
    thickness_ = std::max(std::abs(cell_), (high - low) / 40);
    for (std::size_t i = regular; i < axis.values.size(); ++i)
      place_.push_back(low - (2.5 + 1.5 * double(axis.values.size() - 1 - i)) * thickness_);
  }
  double centre(std::size_t i) const { return value(place_[i]); }
  double low(std::size_t i) const { return value(place_[i] - half(i)); }
  double high(std::size_t i) const { return value(place_[i] + half(i)); }
  std::size_t size() const { return place_.size(); }
  int regular() const { return axis_.regular; }
  bool outside(std::size_t i) const { return i >= static_cast<std::size_t>(axis_.regular); }
  bool has_outside() const { return outside(size() - 1); }
  /// The place of the scale's i-th value from below.
  std::size_t rising(int i) const { return static_cast<std::size_t>(cell_ > 0 ? i : axis_.regular - 1 - i); }

  Axis named(const scene::Scene& scene) const {
    auto axis = axis_of(axis_.parameter, scene.describe(axis_.parameter), axis_.logarithmic);
    axis.from = infinity, axis.to = -infinity;
    for (std::size_t i = 0; i < size(); ++i)
      axis.from = std::min(axis.from, low(i)), axis.to = std::max(axis.to, high(i));
    if (has_outside()) axis.ticks_from = low(rising(0));
    for (std::size_t i = 0; i < size(); ++i)
      if (outside(i)) axis.further.push_back({centre(i), fmt::format("{:g}", axis_.values[i])});
    return axis;
  }

 private:
  double value(double place) const { return axis_.logarithmic ? std::pow(10, place) : place; }
  double half(std::size_t i) const { return (outside(i) ? thickness_ : std::abs(cell_)) / 2; }
  analysis::planes::Axis axis_;
  std::vector<double> place_;  ///< along the scale
  double cell_ = 0, thickness_ = 0;
};

/// Planes with more values a side are drawn as images: as boxes their cells would be smaller than a screen can show.
constexpr int finest_boxes = 160;

/// Middle and borders of cells, and what stands in them.
class Cells {
 public:
  explicit Cells(std::string file, const std::vector<std::string>& names) : table_{std::move(file), {}} {
    for (const char* name : {"x", "y", "x_low", "x_high", "y_low", "y_high"}) table_.columns.push_back({name, {}});
    for (const auto& name : names) table_.columns.push_back({name, {}});
  }
  void add(const CellAxis& x, const CellAxis& y, std::size_t i, auto value) {
    const auto ix = i % x.size(), iy = i / x.size();
    const double place[] = {x.centre(ix), y.centre(iy), x.low(ix), x.high(ix), y.low(iy), y.high(iy)};
    for (std::size_t c = 0; c < table_.columns.size(); ++c)
      table_.columns[c].values.push_back(c < std::size(place) ? place[c] : value(c - std::size(place)));
  }
  Line line(std::size_t of) const {
    return {.table = table_.file, .how = How::cells, .z = {int(of) + 7}, .corners = 3};
  }
  const FigureTable& table() const { return table_; }

 private:
  FigureTable table_;
};

/// The metrics on the scales of both axes, one after the other, as doubles in rows from the lower left.
void write_grid(const std::filesystem::path& path, const analysis::planes::Map& map, const CellAxis& x,
                const CellAxis& y) {
  std::string bytes;
  for (const auto& metric : map.metrics)
    for (int j = 0; j < y.regular(); ++j)
      for (int i = 0; i < x.regular(); ++i) {
        const double value = metric.value(map.points[y.rising(j) * x.size() + x.rising(i)]);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
  write_whole(path, bytes);
}

/// Points that may carry a mark: of those with a cycle, or steady, so few that colours show between them, of the others
/// so many that marks touch.
FigureTable marks_of(const analysis::planes::Map& map, const CellAxis& x, const CellAxis& y) {
  constexpr std::size_t most_cycles = 24, most_others = finest_boxes;  // a side
  const auto spacing = [](std::size_t n, std::size_t most) { return (n + most - 1) / most; };
  FigureTable table{"map-marks.csv", {{"regime", {}}, {"x", {}}, {"y", {}}}};
  std::set<std::tuple<Regime, std::size_t, std::size_t>> marked;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const auto regime = map.points[i].regime;
    const auto ix = i % x.size(), iy = i / x.size();
    const bool is_plain = regime == Regime::cycle || regime == Regime::stable;
    if (is_plain && (ix % spacing(x.size(), most_cycles) != 0 || iy % spacing(y.size(), most_cycles) != 0)) continue;
    if (!is_plain &&
        !marked.emplace(regime, ix / spacing(x.size(), most_others), iy / spacing(y.size(), most_others)).second)
      continue;
    table.columns[0].values.push_back(double(regime));
    table.columns[1].values.push_back(x.centre(ix));
    table.columns[2].values.push_back(y.centre(iy));
  }
  return table;
}

FigureTable table_of(std::string file, const analysis::planes::Polyline& line) {
  return {std::move(file), {{"x", line.x}, {"y", line.y}}};
}

/// Black on white, so that it shows on every colour.
Line on_cells(const std::string& file, const char* dash, std::string title) {
  return {.table = file,
          .look = {.colour = "#000000", .dash = dash, .width = 1.8, .halo = true},
          .title = std::move(title)};
}

/// The colour scale of a metric: from zero for fractions, decades where the values span some.
ColourScale colours_of(const analysis::planes::Map& map, const analysis::planes::PlaneMetric& metric) {
  const bool fraction = metric.unit == "1";
  Extent all, above_zero;
  for (const auto& point : map.points) {
    const double value = metric.value(point);
    all.include(value);
    if (value > metric.error(point)) above_zero.include(value);
  }
  auto axis = axis_of(metric.name, metric.unit);
  axis.decades = !fraction && all.low >= 0 && above_zero.spans_decades();
  if (!all.known())
    axis.from = 0, axis.to = 1;
  else if (fraction && all.low >= 0)
    axis.from = 0;
  else if (axis.decades)
    axis.from = above_zero.low;
  return {axis};
}

/// Marks of the points of each regime. Where no threshold parts cycles from steady sliding, those are marked that are
/// the exception.
std::vector<Line> marks_of(const analysis::planes::Map& map) {
  struct Kind {
    Regime regime;
    Look look;
    const char* title;
  };
  const Look plain{.colour = "#000000", .width = 0.9, .point = Point::plus, .size = 0.6, .halo = true};
  const Kind kinds[] = {
      {Regime::cycle, plain, "cycle"},
      {Regime::stable, plain, "steady"},
      {Regime::bistable,
       {.colour = "#000000", .width = 1.2, .point = Point::circle, .size = 0.55, .halo = true},
       "bistable"},
      {Regime::failed, {.colour = "#D01C00", .width = 1.8, .point = Point::cross, .size = 0.7}, "failed"}};
  const auto number_of = [&](Regime regime) {
    return std::ranges::count(map.points, regime, &analysis::planes::MapPoint::regime);
  };
  const bool parted = !map.threshold.x.empty();
  const auto cycles = number_of(Regime::cycle), steady = number_of(Regime::stable);
  std::vector<Line> lines;
  for (const auto& [regime, look, title] : kinds) {
    const bool is_plain = (regime == Regime::cycle && (parted || cycles >= steady)) ||
                          (regime == Regime::stable && (parted || steady > cycles));
    if (number_of(regime) > 0 && !is_plain)
      lines.push_back({.table = "map-marks.csv",
                       .x = {2},
                       .y = {3},
                       .how = How::points,
                       .look = look,
                       .title = title,
                       .where = {{1, '=', double(regime)}}});
  }
  return lines;
}

/// Planes side by side, two across.
Figure figure_of_planes(const char* name, const char* what, const scene::Scene& scene, const analysis::planes::Axis& x,
                        const analysis::planes::Axis& y, std::size_t count) {
  auto figure = figure_of(scene, name, what, {x.parameter, y.parameter});
  figure.columns = count > 1 ? 2 : 1;
  figure.width = 60 + 540 * figure.columns, figure.height = 340, figure.key = Key::below;
  return figure;
}

}  // namespace

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::planes::Map& map) {
  const CellAxis x(map.x), y(map.y);
  const bool image = std::max(map.x.regular, map.y.regular) > finest_boxes,
             boxes = !image || x.has_outside() || y.has_outside();
  auto figure = figure_of_planes("map", "Metrics over a parameter plane", scene, map.x, map.y, map.metrics.size());
  std::vector<std::string> names;
  for (const auto& metric : map.metrics) names.push_back(metric.name);
  Cells cells("map-cells.csv", names);
  for (std::size_t i = 0; boxes && i < map.points.size(); ++i)
    if (!image || x.outside(i % x.size()) || y.outside(i / x.size()))
      cells.add(x, y, i, [&](std::size_t m) { return map.metrics[m].value(map.points[i]); });
  figure.tables = {marks_of(map, x, y), table_of("map-threshold.csv", map.threshold),
                   table_of("map-fold.csv", map.fold)};
  if (boxes) figure.tables.push_back(cells.table());
  const std::size_t values = std::size_t(x.regular()) * std::size_t(y.regular());
  for (std::size_t m = 0; m < map.metrics.size(); ++m) {
    Panel panel{.x = x.named(scene), .y = y.named(scene), .colours = colours_of(map, map.metrics[m]), .grid = false};
    if (image)
      panel.lines.push_back({.table = "map-grid.bin",
                             .how = How::image,
                             .grid = Grid{m * values, x.regular(), y.regular(), x.centre(x.rising(0)),
                                          x.centre(x.rising(x.regular() - 1)), y.centre(y.rising(0)),
                                          y.centre(y.rising(y.regular() - 1))}});
    if (boxes) panel.lines.push_back(cells.line(m));
    for (auto& marks : marks_of(map)) panel.lines.push_back(std::move(marks));
    if (!map.threshold.x.empty())
      panel.lines.push_back(on_cells("map-threshold.csv", "solid", "threshold of steady sliding"));
    if (!map.threshold.x.empty() && !map.fold.x.empty())
      panel.lines.push_back(on_cells("map-fold.csv", "6,4", "fold of cycles"));
    figure.panels.push_back(std::move(panel));
  }
  if (std::ranges::all_of(map.points, [](const auto& point) { return point.regime == Regime::stable; }) &&
      map.threshold.x.empty())
    figure.rows = {{"steady sliding is stable everywhere here", ""}};
  auto files = write(folder, figure);
  if (image) write_grid(folder / files.emplace_back("map-grid.bin"), map, x, y);
  return files;
}

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::inference::Design& design) {
  const CellAxis x(design.x), y(design.y);
  const auto& task = scene.task<tasks::Compare>();
  std::vector<const std::vector<double>*> planes{&design.information};
  std::vector<std::string> titles{"all metrics together"};
  for (std::size_t m = 0; design.by_metric.size() > 1 && m < design.by_metric.size(); ++m) {
    planes.push_back(&design.by_metric[m]);
    titles.push_back(readable(task.noise[m].metric) + " alone");
  }
  Extent information;
  for (const auto* plane : planes)
    for (const double value : *plane) information.include(value);
  const double most = information.high > 0 ? information.high : 1, least = 1e-5 * most;
  Cells cells("design-cells.csv", titles);
  for (std::size_t i = 0; i < design.information.size(); ++i)
    cells.add(x, y, i, [&](std::size_t p) { return (*planes[p])[i]; });
  auto figure =
      figure_of_planes("design", "Where measurements tell the members apart", scene, design.x, design.y, planes.size());
  figure.tables = {cells.table()};
  std::vector<Line> thresholds;
  for (std::size_t k = 0; k < design.maps.size(); ++k) {
    figure.tables.push_back(table_of(fmt::format("design-threshold-{}.csv", k + 1), design.maps[k].threshold));
    if (!design.maps[k].threshold.x.empty())
      thresholds.push_back(on_cells(figure.tables.back().file, k == 0 ? "solid" : k == 1 ? "8,4" : "2,3", ""));
  }
  // Five decades below the most; white where less, or nothing, is to be learned.
  const auto& parameter = task.parameter;
  const auto symbol = symbol_of(parameter);
  const Axis scale{.name = parameter.empty() ? "log-likelihood ratio of one measurement"
                           : symbol.empty()  ? "information on ln " + parameter
                                             : "information on ln " + symbol,
                   .decades = true,
                   .from = least,
                   .to = most};
  for (std::size_t p = 0; p < planes.size(); ++p) {
    auto line = cells.line(p);
    line.where = {{int(p) + 7, '>', least}};
    Panel panel{.x = x.named(scene),
                .y = y.named(scene),
                .lines = {std::move(line)},
                .title = titles[p],
                .colours = ColourScale{scale},
                .grid = false};
    panel.lines.insert(panel.lines.end(), thresholds.begin(), thresholds.end());
    figure.panels.push_back(std::move(panel));
  }
  return write(folder, figure);
}

}  // namespace rosin::app::output
