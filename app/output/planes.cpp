/// Writing maps, sweeps and basins as NetCDF.
#include "app/output/planes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "analysis/basins/basins.hpp"
#include "analysis/planes/map.hpp"
#include "analysis/planes/sweep.hpp"
#include "app/output/files.hpp"
#include "app/output/netcdf_file.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/basin.hpp"
#include "app/tasks/sweep.hpp"

namespace rosin::app::output {

namespace {

int write_axis(const NetcdfFile& plane, const std::string& name, const analysis::planes::Axis& axis,
               const scene::Scene& scene) {
  const int dimension = plane.dimension(name, axis.values.size());
  const int variable = plane.variable(name, NC_DOUBLE, {dimension});
  const auto quantity = scene.describe(axis.parameter);
  plane.attribute(variable, "path", axis.parameter);
  plane.attribute(variable, "units", quantity.unit);
  plane.attribute(variable, "long_name", quantity.meaning);
  plane.attribute(variable, "scale", axis.logarithmic ? "log" : "linear");
  plane.attribute(variable, "regular_values", axis.regular);  // the ones behind them stand outside the scale
  plane.values(variable, axis.values);
  return dimension;
}

/// The last part of a path that is a word, and the numbers behind it: "stiffness_2" of "oscillator.stiffness.2".
std::string last_word(const std::string& path) {
  auto begin = path.rfind('.') + 1;
  while (begin > 1 && begin < path.size() && std::isdigit(static_cast<unsigned char>(path[begin])))
    begin = path.rfind('.', begin - 2) + 1;
  return path.substr(begin);
}

}  // namespace

std::vector<std::string> axis_names(const std::vector<std::string>& paths, const std::vector<std::string>& taken) {
  std::vector<std::string> names;
  for (const auto& path : paths) names.push_back(last_word(path));
  auto all = taken;
  all.insert(all.end(), names.begin(), names.end());
  if (std::ranges::any_of(names, [&](const auto& name) { return std::ranges::count(all, name) > 1; })) names = paths;
  for (auto& name : names) std::ranges::replace(name, '.', '_');
  return names;
}

void write_plane(const std::filesystem::path& path, const scene::Scene& scene, const analysis::planes::Map& map) {
  NetcdfFile plane;
  plane.begin(scene);
  plane.attribute(NC_GLOBAL, "tolerance", scene.task<analysis::planes::MapOptions>().tolerance);
  plane.attribute(NC_GLOBAL, "stick_threshold", scene.task<analysis::planes::MapOptions>().stick_threshold);

  std::vector<std::string> taken{"regime", "origin", "vertex", "fold_vertex"};
  for (const auto& metric : map.metrics) taken.push_back(metric.name), taken.push_back(metric.name + "_error");
  const auto names = axis_names({map.x.parameter, map.y.parameter}, taken);
  const int x = write_axis(plane, names[0], map.x, scene), y = write_axis(plane, names[1], map.y, scene);

  std::vector<signed char> regimes;
  for (const auto& point : map.points) regimes.push_back(static_cast<signed char>(point.regime));
  const int regime = plane.variable("regime", NC_BYTE, {y, x});
  plane.attribute(regime, "long_name", "what the slider settles on");
  plane.attribute(regime, "flag_values", std::vector<signed char>{0, 1, 2, 3});
  plane.attribute(regime, "flag_meanings", "stable cycle bistable failed");
  plane.values(regime, regimes);

  std::vector<double> column(map.points.size());
  const auto write_metric = [&](const std::string& name, const std::string& unit, const std::string& meaning) {
    const int variable = plane.variable(name, NC_DOUBLE, {y, x});
    plane.attribute(variable, "units", unit);
    plane.attribute(variable, "long_name", meaning);
    plane.values(variable, column);
  };
  for (const auto& metric : map.metrics) {
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = metric.value(map.points[i]);
    write_metric(metric.name, metric.unit, metric.meaning);
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = metric.error(map.points[i]);
    write_metric(metric.name + "_error", metric.unit, "absolute error of " + metric.name);
  }

  const auto write_line = [&](const std::string& name, const std::string& dimension,
                              const analysis::planes::Polyline& line, const std::string& meaning) {
    const bool any = !line.x.empty();  // a dimension of length zero would mean an unlimited one
    const std::vector<double> none = {std::nan("")};
    const int vertices = plane.dimension(dimension, any ? line.x.size() : 1);
    for (const auto& [suffix, axis, coordinates] :
         {std::tuple{"_x", &map.x, any ? &line.x : &none}, std::tuple{"_y", &map.y, any ? &line.y : &none}}) {
      const int variable = plane.variable(name + suffix, NC_DOUBLE, {vertices});
      plane.attribute(variable, "path", axis->parameter);
      plane.attribute(variable, "units", scene.describe(axis->parameter).unit);
      plane.attribute(variable, "long_name", meaning + "; NaN between separate lines");
      plane.values(variable, *coordinates);
    }
  };
  write_line("threshold", "vertex", map.threshold, "threshold of steady sliding");
  write_line("fold", "fold_vertex", map.fold, "fold of cycles below a subcritical threshold");
  plane.attribute(NC_GLOBAL, "fold_error_decades", map.fold_error);

  std::vector<signed char> origins;
  for (const auto& point : map.points) origins.push_back(static_cast<signed char>(point.origin));
  const int origin = plane.variable("origin", NC_BYTE, {y, x});
  plane.attribute(origin, "long_name", "where the numbers come from");
  plane.attribute(origin, "flag_values", std::vector<signed char>{0, 1, 2});
  plane.attribute(origin, "flag_meanings", "decided computed interpolated");
  plane.values(origin, origins);
  write_whole(path, plane.close());
}

void write_sweep(const std::filesystem::path& path, const scene::Scene& scene, const analysis::planes::Sweep& sweep) {
  auto& asked = scene.task<tasks::Sweep>();
  NetcdfFile plane;
  plane.begin(scene);
  plane.attribute(NC_GLOBAL, "tolerance", asked.options.tolerance);
  const int value =
      write_axis(plane, axis_names({asked.options.axis.parameter}, {"moment"}).front(), asked.options.axis, scene);
  std::size_t longest = 1;
  for (const auto* points : {&sweep.up, &sweep.down})
    for (const auto& point : *points)
      if (!point.columns.empty()) longest = std::max(longest, point.columns.front().size());
  const bool of_metrics = !sweep.metrics.empty();
  const int moment = of_metrics ? 0 : plane.dimension("moment", longest);
  for (const auto& [direction, points] : {std::pair{"up", &sweep.up}, std::pair{"down", &sweep.down}}) {
    if (points->empty()) continue;
    const auto write = [&](const std::string& name, const std::string& unit, const std::string& meaning,
                           const std::vector<int>& dimensions, const std::vector<double>& values) {
      const int variable = plane.variable(fmt::format("{}_{}", name, direction), NC_DOUBLE, dimensions);
      plane.attribute(variable, "units", unit);
      plane.attribute(variable, "long_name", fmt::format("{}, {}wards", meaning, direction));
      plane.values(variable, values);
    };
    for (const auto& metric : sweep.metrics) {
      std::vector<double> values, errors;
      for (const auto& point : *points) {
        values.push_back(point.done ? metric.value(point.metrics) : NAN);
        errors.push_back(point.done ? metric.error(point.metrics) : NAN);
      }
      write(metric.name, metric.unit, metric.meaning, {value}, values);
      write(metric.name + "_error", metric.unit, "absolute error of " + metric.name, {value}, errors);
    }
    for (std::size_t c = 0; !of_metrics && c < sweep.column_names.size(); ++c) {
      std::vector<double> values(points->size() * longest, NAN);
      for (std::size_t i = 0; i < points->size(); ++i)
        if (const auto& columns = (*points)[i].columns; !columns.empty())
          std::ranges::copy(columns[c], values.begin() + long(i * longest));
      write(sweep.column_names[c], sweep.column_units[c], sweep.column_names[c], {value, moment}, values);
    }
  }
  write_whole(path, plane.close());
}

void write_basins(const std::filesystem::path& path, const scene::Scene& scene, const analysis::basins::Basins& found) {
  const auto& [x, y, random, places, direction, task] = scene.task<tasks::Basin>();
  NetcdfFile plane;
  plane.begin(scene);
  plane.attribute(NC_GLOBAL, "tolerance", task.tolerance);
  const auto write = [&](const tasks::StartAxis& axis, int dimension, const std::vector<double>& values) {
    const int variable = plane.variable(axis.name, NC_DOUBLE, {dimension});
    plane.attribute(variable, "units", axis.unit);
    plane.attribute(variable, "long_name", axis.name + " at the start");
    plane.values(variable, values);
  };
  std::vector<int> dimensions;
  if (random) {
    dimensions = {plane.dimension("start", places.size())};
    std::vector<double> x_values, y_values;
    for (const auto& [at_x, at_y] : places) x_values.push_back(at_x), y_values.push_back(at_y);
    write(x, dimensions.front(), x_values);
    write(y, dimensions.front(), y_values);
  } else {
    for (const auto* axis : {&y, &x}) {
      dimensions.push_back(plane.dimension(axis->name, axis->values.size()));
      write(*axis, dimensions.back(), axis->values);
    }
  }
  std::vector<signed char> labels, numbers;
  for (const int label : found.labels) labels.push_back(static_cast<signed char>(label));
  std::string meanings;
  for (std::size_t k = 0; k < found.basins.size(); ++k) {
    numbers.push_back(static_cast<signed char>(k));
    meanings += fmt::format("{}{}_{}", k > 0 ? " " : "", name(found.basins[k].attractor.kind), k);
  }
  const int label = plane.variable("attractor", NC_BYTE, dimensions);
  plane.attribute(label, "long_name", "what the motion comes to; -1: not done");
  plane.attribute(label, "flag_values", numbers);
  plane.attribute(label, "flag_meanings", meanings);
  plane.values(label, labels);
  if (!found.followed.empty()) {
    const int followed = plane.variable("followed", NC_BYTE, dimensions);
    plane.attribute(followed, "long_name", "1: the start was followed; 0: it has the label of its neighbours");
    plane.values(followed, std::vector<signed char>(found.followed.begin(), found.followed.end()));
  }
  write_whole(path, plane.close());
}

}  // namespace rosin::app::output
