/// Pictures of sweeps: points of the section or extrema over the parameter, or a panel for each metric.
#include <algorithm>

#include "analysis/planes/map.hpp"
#include "analysis/planes/sweep.hpp"
#include "app/output/figure.hpp"
#include "app/output/pictures.hpp"
#include "app/output/scene_figure.hpp"
#include "app/tasks/sweep.hpp"

namespace rosin::app::output {

using namespace results;

namespace {

using analysis::planes::Sweep;
using analysis::planes::SweepPoint;

constexpr double upwards = 1, downwards = -1;  ///< as the column of directions says

/// All that was found: value, direction and a row for each moment, or each value of the metrics with its error.
FigureTable table_of(const Sweep& sweep, const std::string& parameter, const std::string& unit,
                     const std::vector<double>& values) {
  FigureTable table{"sweep.csv", {column_of(parameter, unit, {}), {"direction", {}}}};
  auto& columns = table.columns;
  for (std::size_t c = 0; sweep.metrics.empty() && c < sweep.column_names.size(); ++c)
    columns.push_back(column_of(sweep.column_names[c], sweep.column_units[c], {}));
  for (const auto& metric : sweep.metrics)
    for (const auto& name : {metric.name, metric.name + "_error"}) columns.push_back(column_of(name, metric.unit, {}));
  const auto add = [&](const std::vector<SweepPoint>& points, double direction) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& point = points[i];
      if (!point.done) continue;
      const std::size_t moments = sweep.metrics.empty() ? point.columns.front().size() : 1;
      columns[0].values.insert(columns[0].values.end(), moments, values[i]);
      columns[1].values.insert(columns[1].values.end(), moments, direction);
      for (std::size_t c = 0; sweep.metrics.empty() && c < sweep.column_names.size(); ++c)
        columns[2 + c].values.insert(columns[2 + c].values.end(), point.columns[c].begin(), point.columns[c].end());
      for (std::size_t m = 0; m < sweep.metrics.size(); ++m) {
        columns[2 + 2 * m].values.push_back(sweep.metrics[m].value(point.metrics));
        columns[3 + 2 * m].values.push_back(sweep.metrics[m].error(point.metrics));
      }
    }
  };
  add(sweep.up, upwards);
  add(sweep.down, downwards);
  return table;
}

}  // namespace

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const Sweep& sweep) {
  auto& asked = scene.task<tasks::Sweep>();
  const auto& axis = asked.options.axis;
  const auto quantity = scene.describe(axis.parameter);
  const bool of_metrics = !sweep.metrics.empty();
  auto figure = figure_of(scene, "sweep", "What changes along a parameter", {axis.parameter});
  figure.tables = {table_of(sweep, axis.parameter, quantity.unit, axis.values)};
  Panel empty{.x = axis_of(axis.parameter, quantity, axis.logarithmic)};
  empty.x.from = axis.values.front(), empty.x.to = axis.values.back();
  for (const auto& threshold : sweep.thresholds)
    empty.rules.push_back({'x',
                           threshold.value,
                           {.colour = "#333333", .dash = threshold.onset ? "6,4" : "2,3", .width = 1.3},
                           threshold.onset ? "sliding unstable above" : "sliding unstable below"});
  const auto add = [&](const std::string& name, const std::string& unit, std::size_t column) {
    auto panel = empty;
    panel.y = axis_of(name, unit, Extent::of(figure.tables.front().columns[column].values));
    const auto points = [&](double direction, Look look, const char* title) {
      panel.lines.push_back({.table = "sweep.csv",
                             .y = {int(column) + 1},
                             .how = of_metrics ? How::line_and_points : How::points,
                             .look = look,
                             .title = title,
                             .where = {{2, '=', direction}}});
    };
    // Under each other: open circles stay visible around dots.
    if (!sweep.down.empty())
      points(downwards, {.style = 1, .point = Point::circle, .size = of_metrics ? 0.8 : 0.55}, "downwards");
    if (!sweep.up.empty()) points(upwards, {.size = of_metrics ? 0.4 : 0.3}, "upwards");
    figure.panels.push_back(std::move(panel));
  };
  for (std::size_t m = 0; m < sweep.metrics.size(); ++m) add(sweep.metrics[m].name, sweep.metrics[m].unit, 2 + 2 * m);
  for (std::size_t c = 0; !of_metrics && c < sweep.column_names.size(); ++c)
    if (sweep.column_names[c] == asked.column) add(asked.column, sweep.column_units[c], 2 + c);
  if (figure.panels.size() > 1) figure.height = 190;
  return write(folder, figure);
}

}  // namespace rosin::app::output
