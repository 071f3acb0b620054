/// Asking for a plane, and writing what a map writes.
#include "app/verbs/plane_job.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "analysis/cycles/lyapunov.hpp"
#include "analysis/planes/map.hpp"
#include "analysis/planes/structure_map.hpp"
#include "app/output/pictures.hpp"
#include "app/results/axis.hpp"
#include "app/scene/family.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/verbs/journal.hpp"
#include "core/process.hpp"

namespace rosin::app::verbs {

using analysis::planes::Regime;
using nlohmann::ordered_json;

double mean_return_of(const scene::Scene& scene) {
  const double period = scene::drive_period_of(scene);
  return period > 0 ? period : infinity;
}

namespace {

/// What the motions of the plane are, point by point; empty where nothing that was asked tells.
std::vector<std::string> motions_of(const scene::Scene& scene, const analysis::planes::Map& map) {
  const double mean_return = mean_return_of(scene);
  std::vector<std::string> motions;
  for (const auto& point : map.points) motions.push_back(analysis::planes::motion_of(point, map.metrics, mean_return));
  const bool known = std::ranges::any_of(motions, [](const auto& text) { return !text.empty() && text != "steady"; });
  return known ? motions : std::vector<std::string>();
}

results::Result result_of(const Job& job, const MapResult& of) {
  const auto& scene = job.scene();
  const auto& map = of.map;
  auto result = job.result(map.outcome);
  result["x"] = results::axis(map.x, scene);
  result["y"] = results::axis(map.y, scene);
  result["regime"] = results::grid_of_points(map, [](const auto& point) { return name(point.regime); });
  if (const auto motions = motions_of(scene, map); !motions.empty())
    result["motion"] = results::grid(map, [&](std::size_t i) { return motions[i]; });
  result["metrics"] = result["error"] = ordered_json::object();
  for (const auto& metric : map.metrics) {
    result["metrics"][metric.name] =
        results::grid_of_points(map, [&](const auto& point) { return metric.value(point); });
    result["error"][metric.name] = results::grid_of_points(map, [&](const auto& point) { return metric.error(point); });
  }
  result["threshold"] = {{"x", map.threshold.x}, {"y", map.threshold.y}};
  result["fold"] = {{"x", map.fold.x}, {"y", map.fold.y}, {"error_decades", map.fold_error}};
  auto& failures = result["failures"] = ordered_json::array();
  for (std::size_t i = 0; i < map.points.size(); ++i)
    if (map.points[i].regime == analysis::planes::Regime::failed)
      failures.push_back(
          {{"ix", i % map.x.values.size()}, {"iy", i / map.x.values.size()}, {"why", map.points[i].why}});
  result["stick_threshold"] = scene.task<analysis::planes::MapOptions>().stick_threshold;
  result["tolerance"] = scene.task<analysis::planes::MapOptions>().tolerance;
  result.cost = {{"seconds", of.seconds},
                 {"points", map.points.size()},
                 {"integrated", map.integrated},
                 {"interpolated", map.interpolated},
                 {"skipped", map.skipped}};
  result.notes = map.notes;
  result.tables = {table_of(scene, map)};
  return result;
}

}  // namespace

results::Table table_of(const scene::Scene& scene, const analysis::planes::Map& map) {
  const auto& options = scene.task<analysis::planes::MapOptions>();
  std::vector<std::string> taken{"regime", "motion", "origin", "vertex", "fold_vertex"};
  for (const auto& metric : map.metrics) taken.push_back(metric.name), taken.push_back(metric.name + "_error");
  const auto names = results::axis_names({map.x.parameter, map.y.parameter}, taken);
  enum : std::size_t { y, x };
  results::Table table{
      .name = "map",
      .dimensions = {{names[1], map.y.values.size()}, {names[0], map.x.values.size()}},
      .columns = {results::coordinate(names[0], x, map.x, scene), results::coordinate(names[1], y, map.y, scene)},
      .more = {{"tolerance", options.tolerance},
               {"stick_threshold", options.stick_threshold},
               {"fold_error_decades", map.fold_error}}};
  const auto flags = [&](const char* name, const char* meaning, auto member, std::vector<signed char> numbers,
                         const char* words) {
    results::Flags of{{}, std::move(numbers), words};
    for (const auto& point : map.points) of.values.push_back(static_cast<signed char>(point.*member));
    table.columns.push_back({{name, "", meaning}, std::move(of), {}, {y, x}});
  };
  flags("regime", "what the slider settles on", &analysis::planes::MapPoint::regime, {0, 1, 2, 3},
        "stable cycle bistable failed");
  if (auto motions = motions_of(scene, map); !motions.empty())
    table.columns.push_back({{"motion", "", "what the motion is"}, std::move(motions), {}, {y, x}});
  for (const auto& metric : map.metrics) {
    std::vector<double> values, errors;
    for (const auto& point : map.points) values.push_back(metric.value(point)), errors.push_back(metric.error(point));
    table.columns.push_back({{metric.name, metric.unit, metric.meaning}, std::move(values), std::move(errors), {y, x}});
  }
  for (const auto& [name, dimension, line, meaning] :
       {std::tuple{"threshold", "vertex", &map.threshold, "threshold of steady sliding"},
        std::tuple{"fold", "fold_vertex", &map.fold, "fold of cycles below a subcritical threshold"}}) {
    const std::vector<double> none = {std::nan("")};
    const bool any = !line->x.empty();  // a dimension of length zero would mean an unlimited one
    table.dimensions.push_back({dimension, any ? line->x.size() : 1});
    for (const auto& [suffix, axis, places] :
         {std::tuple{"_x", &map.x, any ? &line->x : &none}, std::tuple{"_y", &map.y, any ? &line->y : &none}})
      table.columns.push_back({{std::string(name) + suffix, scene.describe(axis->parameter).unit,
                                fmt::format("{}; NaN between separate lines", meaning)},
                               *places,
                               {},
                               {table.dimensions.size() - 1},
                               {{"path", axis->parameter}}});
  }
  flags("origin", "where the numbers come from", &analysis::planes::MapPoint::origin, {0, 1, 2},
        "decided computed interpolated");
  return table;
}

std::string command_of(const Request& request, const std::string& verb, analysis::planes::Share share) {
  auto line = fmt::format("rosin {} {}", verb, shell_word(request.target));
  for (const auto& given : request.overrides) line += " --set " + shell_word(given);
  if (request.tolerance) line += fmt::format(" --tolerance {}", *request.tolerance);
  if (request.exact) line += " --exact";
  if (!request.out.empty()) line += " --out " + shell_word(request.out);
  if (share.count > 1) line += fmt::format(" --shard {}/{}", share.index + 1, share.count);
  return line;
}

std::vector<analysis::planes::PlaneMetric> metrics_of(const scene::Scene& scene,
                                                      const std::vector<std::string>& names) {
  const auto* stepped = scene::stepped_of(scene);
  return stepped ? analysis::planes::metrics_of_stepped(*stepped, names)
                 : analysis::planes::metrics_of_structure(scene.structure->structure, names);
}

PlaneJob::PlaneJob(Job& job_) : job(job_), options(job_.scene().task<analysis::planes::MapOptions>()) {
  auto& scene = job.scene();
  const auto& request = job.request();
  options.tolerance = request.tolerance.value_or(options.tolerance);
  options.threads = request.threads;
  options.exact = request.exact;
  options.lyapunov = scene.task<analysis::cycles::LyapunovOptions>();
  of_slider = !scene.structure && !scene.plane;
  metrics = varied(scene).metrics(options.metrics);
  key = journal_key(scene, options.tolerance, options.exact ? "exact" : "adaptive");
  points = options.x.values.size() * options.y.values.size();
}

analysis::planes::Varied varied(const scene::Scene& scene) {
  using namespace analysis::planes;
  const auto family = scene.family;
  const auto value = [=](const std::string& path) { return family->value(path); };
  if (scene::stepped_of(scene))
    return Varied(SteppedOscillators{[=](const auto& numbers) { return family->stepped_with(numbers); }, value});
  if (scene.structure) return Varied(Structures{[=](const auto& numbers) { return family->with(numbers); }, value});
  return scene.model;
}

Status PlaneJob::write(const MapResult& result, const std::map<std::size_t, double>& costs) const {
  const auto& map = result.map;
  const auto& scene = job.scene();
  const auto nx = options.x.values.size(), ny = options.y.values.size(), total = points;
  for (const auto& text : map.notes) job.explain("{}", text);
  job.explain("{} points integrated, {} interpolated, {} decided without integration", map.integrated, map.interpolated,
              map.skipped);

  std::array<std::size_t, 4> regimes{};
  for (const auto& point : map.points) ++regimes[static_cast<std::size_t>(point.regime)];
  auto& manifest = job.manifest();
  manifest.tolerance_asked = options.tolerance;
  double all_parts = 0, longest_part = 0;  // processor time of those that were computed
  for (const auto& [part, seconds] : costs) all_parts += seconds, longest_part = std::max(longest_part, seconds);
  manifest.cost = {{"seconds", result.seconds},
                   {"points", double(total)},
                   {"integrated", double(map.integrated)},
                   {"interpolated", double(map.interpolated)},
                   {"skipped", double(map.skipped)},
                   {"threads", double(options.threads)},
                   {"parts", double(costs.size())},
                   {"part_seconds", all_parts},
                   {"longest_part_seconds", longest_part}};
  const auto between = map.interpolated > 0 ? fmt::format("{} interpolated, ", map.interpolated) : std::string();
  job.say("{} x {} points in {:.3g} s: {} integrated, {}{} decided without", nx, ny, result.seconds, map.integrated,
          between, map.skipped);
  for (const Regime regime : {Regime::stable, Regime::cycle, Regime::bistable, Regime::failed})
    if (const auto count = regimes[static_cast<std::size_t>(regime)]) job.say("  {:<9} {}", name(regime), count);
  std::map<std::string, int> motions;
  for (const auto& motion : motions_of(scene, map)) ++motions[motion.empty() ? "not known" : motion];
  if (!motions.empty()) {
    std::vector<std::string> counted;
    for (const auto& [motion, count] : motions) counted.push_back(fmt::format("{} {}", count, motion));
    job.say("  motions   {}", fmt::join(counted, ", "));
  }
  for (const auto& metric : map.metrics) {
    const auto& wanted = metric.name;
    const bool fraction = wanted.find("fraction") != std::string::npos;
    // Of a number of either sign, which is 0 somewhere, errors count beside the largest in the plane.
    const bool of_either_sign =
        wanted == "growth_rate" || wanted == "criticality" || wanted == "lyapunov" || wanted == "probability_unstable";
    double largest = fraction ? 1 : 0;
    for (const auto& point : map.points)
      if (const double value = metric.value(point); of_either_sign && std::isfinite(value))
        largest = std::max(largest, std::abs(value));
    std::vector<double> errors;
    for (const auto& point : map.points) {
      const double value = largest > 0 ? largest : std::abs(metric.value(point)), error = metric.error(point);
      if (std::isfinite(error) && value > 0) errors.push_back(error / value);
    }
    if (errors.empty()) continue;
    std::ranges::sort(errors);
    manifest.tolerance_reached = std::max(manifest.tolerance_reached, errors.back());
    job.say("  {:<22} {} at most {:.1e}, at nine points in ten at most {:.1e}", wanted,
            fraction         ? "error"
            : of_either_sign ? "error over the largest"
                             : "relative error",
            errors.back(), errors[errors.size() * 9 / 10]);
  }

  return job.finish(result_of(job, result), output::write_picture(job.folder(), scene, map));
}

}  // namespace rosin::app::verbs
