/// Pictures of sweeps: points of the section or extrema over the parameter, or a panel for each metric.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "analysis/planes/map.hpp"
#include "analysis/planes/sweep.hpp"
#include "app/output/caption.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/sweep.hpp"

namespace rosin::app::output {

namespace {

using analysis::planes::Sweep;
using analysis::planes::SweepPoint;

constexpr double upwards = 1, downwards = -1;  ///< as the column of directions says

/// All that was found: value, direction and a row for each moment, or each value of the metrics.
std::vector<std::vector<double>> rows_of(const Sweep& sweep, const analysis::planes::Axis& axis) {
  const std::size_t count = sweep.metrics.empty() ? sweep.column_names.size() : 2 * sweep.metrics.size();
  std::vector<std::vector<double>> columns(2 + count);
  const auto add = [&](const std::vector<SweepPoint>& points, double direction) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& point = points[i];
      if (!point.done) continue;
      std::size_t moments = 1;
      if (sweep.metrics.empty()) moments = point.columns.front().size();
      columns[0].insert(columns[0].end(), moments, axis.values[i]);
      columns[1].insert(columns[1].end(), moments, direction);
      for (std::size_t c = 0; sweep.metrics.empty() && c < count; ++c)
        columns[2 + c].insert(columns[2 + c].end(), point.columns[c].begin(), point.columns[c].end());
      for (std::size_t m = 0; m < sweep.metrics.size(); ++m) {
        columns[2 + 2 * m].push_back(sweep.metrics[m].value(point.metrics));
        columns[3 + 2 * m].push_back(sweep.metrics[m].error(point.metrics));
      }
    }
  };
  add(sweep.up, upwards);
  add(sweep.down, downwards);
  return columns;
}

}  // namespace

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const Sweep& sweep) {
  auto& asked = scene.task<tasks::Sweep>();
  const auto& options = asked.options;
  const auto& axis = options.axis;
  const auto quantity = scene.describe(axis.parameter);
  const bool of_metrics = !sweep.metrics.empty();
  const auto columns = rows_of(sweep, axis);
  std::vector<Column> table = {{column_header(axis.parameter, quantity.unit), columns[0]}, {"direction", columns[1]}};
  struct Panel {
    std::string name, unit;
    std::size_t column;
  };
  std::vector<Panel> panels;
  if (of_metrics) {
    for (std::size_t m = 0; m < sweep.metrics.size(); ++m) {
      const auto& metric = sweep.metrics[m];
      panels.push_back({metric.name, metric.unit, table.size()});
      table.push_back({column_header(metric.name, metric.unit), columns[table.size()]});
      table.push_back({column_header(metric.name + "_error", metric.unit), columns[table.size()]});
    }
  } else {
    for (std::size_t c = 0; c < sweep.column_names.size(); ++c) {
      if (sweep.column_names[c] == asked.column) panels.push_back({asked.column, sweep.column_units[c], table.size()});
      table.push_back({column_header(sweep.column_names[c], sweep.column_units[c]), columns[table.size()]});
    }
  }
  write_csv(folder / "sweep.csv", table);

  const Sheet sheet{"sweep",
                    "What changes along a parameter",
                    {.panels = int(panels.size()), .panel = panels.size() == 1 ? 400.0 : 190.0},
                    scene.title,
                    caption(scene, {axis.parameter})};
  std::string script = "set grid\n";
  script += axis_scale('x', axis.logarithmic) + '\n';
  script += fmt::format("set xrange [{}:{}]\n", axis.values.front(), axis.values.back());
  for (const auto& threshold : sweep.thresholds)
    script += fmt::format(
        "set arrow from {0}, graph 0 to {0}, graph 1 nohead linecolor '#333333' linewidth 1.3 dashtype {1}\n",
        threshold.value, threshold.onset ? "(6,4)" : "(2,3)");
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const auto& panel = panels[p];
    double largest = 0;
    for (const double value : columns[panel.column])
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    const auto [factor, unit] = scaled(panel.unit, largest);
    const auto points = [&](double direction, const char* look, const char* title) {
      return fmt::format("'sweep.csv' using 1:($2=={}?${}*{}:NaN) with {} title '{}'", direction, panel.column + 1,
                         factor, look, title);
    };
    std::vector<std::string> curves;
    // Under each other: open circles stay visible around dots.
    if (!sweep.down.empty())
      curves.push_back(points(downwards,
                              of_metrics ? "linespoints linestyle 2 pointtype 6 pointsize 0.8"
                                         : "points pointtype 6 pointsize 0.55 linecolor '#B0560F'",
                              "downwards"));
    if (!sweep.up.empty())
      curves.push_back(points(upwards,
                              of_metrics ? "linespoints linestyle 1 pointtype 7 pointsize 0.4"
                                         : "points pointtype 7 pointsize 0.3 linecolor '#00336F'",
                              "upwards"));
    const auto add_line = [&](bool onset, const char* dash, const char* title) {
      if (std::ranges::any_of(sweep.thresholds, [&](const auto& threshold) { return threshold.onset == onset; }))
        curves.push_back(
            fmt::format("NaN with lines linecolor '#333333' linewidth 1.3 dashtype {} title '{}'", dash, title));
    };
    add_line(true, "(6,4)", "sliding unstable above");
    add_line(false, "(2,3)", "sliding unstable below");
    const bool last = p + 1 == panels.size();
    script += last ? fmt::format("set xlabel {}\nset format x '{}'\n",
                                 axis_label('x', axis.parameter, quantity.meaning, quantity.unit),
                                 axis.logarithmic ? "10^{%T}" : "%g")
                   : std::string("unset xlabel\nset format x ''\n");
    script +=
        fmt::format("set ylabel {}\nplot {}\n", label(readable(panel.name), unit), fmt::join(curves, ", \\\n     "));
    if (p == 0) script += "unset key\n";
  }
  write_whole(folder / "sweep.gp", sheet.with(std::move(script)));
  return {"sweep.csv", "sweep.gp"};
}

}  // namespace rosin::app::output
