/// The verb map: regimes and metrics over a parameter plane.
#include "analysis/planes/map.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "analysis/planes/structure_map.hpp"
#include "app/output/files.hpp"
#include "app/output/json.hpp"
#include "app/output/pictures.hpp"
#include "app/output/planes.hpp"
#include "app/scene/family.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/structure.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/partial.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

using analysis::planes::Regime;

}  // namespace

analysis::planes::Axis read_axis(scene::Table table, const scene::Scene& scene) {
  table.expect({"parameter", "from", "to", "points", "scale", "extra"});
  const auto& parameter = table.required("parameter", "path, such as drive.normal_load");
  const auto path = scene::text(parameter, table.path("parameter"));
  auto quantity = scene::located(parameter.source(), [&] { return scene.describe(path); });
  quantity.meaning = path + ", " + quantity.meaning;
  table.required("from", quantity.meaning);
  table.required("to", quantity.meaning);
  table.required("points", "number of values");
  double from = 0, to = 0;
  int points = 0;
  table.read("from", from, quantity);
  table.read("to", to, quantity);
  table.read("points", points, 2, scene::most_points, "number of values");
  bool logarithmic = true;
  if (const auto* scale = table.find("scale"))
    logarithmic = scene::choice(*scale, table.path("scale"), {"log", "linear"}) == "log";
  std::vector<double> extra;
  if (const auto* node = table.find("extra")) {
    quantity.name = table.path("extra");
    extra = scene::numbers(*node, quantity);
  }
  table.finish();
  return scene::located(table.source(),
                        [&] { return analysis::planes::make_axis(path, from, to, points, logarithmic, extra); });
}

namespace {

/// A plane of a slider's own parameters under a constant drive has shortcuts; any other is that of a structure.
bool is_of_slider(const scene::SceneReader& reader) {
  return !reader.scene.structure && !reader.scene.string && reader.scene.model.drive.constant();
}

void read_table(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  if (!reader.needs("map") && !is_of_slider(reader)) return;  // its paths and metrics are known to the verb map alone
  auto& map = scene.map;
  table.expect({"x", "y", "metrics", "stick_threshold"});
  const auto &x = table.required("x", "first axis"),
             &y = table.required("y", "second axis; along one parameter alone use [sweep] and 'rosin sweep'");
  map.x = read_axis(scene::Table(x, table.path("x")), scene);
  map.y = read_axis(scene::Table(y, table.path("y")), scene);
  if (map.x.parameter == map.y.parameter)
    scene::fail(y.source(), "map.x and map.y are the same parameter, {}", map.y.parameter);
  if (map.x.values.size() > scene::most_points / map.y.values.size())
    scene::fail(table.source(), "map has {} x {} points, more than {}", map.x.values.size(), map.y.values.size(),
                scene::most_points);
  const auto* structure = scene.structure ? &scene.structure->structure : nullptr;
  map.metrics = {"stick_fraction", "loop_area_normalised"};
  if (structure) map.metrics = {analysis::cycles::cycle_metrics_of(*structure)[1].first};
  const auto check = [&](const std::string& name) {
    if (structure)
      analysis::planes::metrics_of_structure(*structure, {name});
    else
      analysis::cycles::find_metric(name);
  };
  if (const auto* metrics = table.find("metrics")) {
    map.metrics = scene::texts(*metrics, table.path("metrics"));
    for (std::size_t i = 0; i < map.metrics.size(); ++i)
      scene::located(metrics->as_array()->get(i)->source(), [&] { check(map.metrics[i]); });
    for (auto name = map.metrics.begin(); name != map.metrics.end(); ++name)
      if (std::find(map.metrics.begin(), name, *name) != name)
        scene::fail(metrics->source(), "map.metrics names '{}' twice", *name);
    if (map.metrics.empty()) scene::fail(metrics->source(), "map.metrics is empty");
  }
  if (structure) {
    if (const auto* threshold = table.find("stick_threshold"))
      scene::fail(threshold->source(), "map.stick_threshold has no effect on a structure, whose stick is exact rest");
    return table.finish();
  }
  map.stick_threshold = scene.cycle.stick_threshold;
  table.read("stick_threshold", map.stick_threshold, {"", "1", {1e-6, 0.999}, "stick is |v| <= threshold times V"});
  const bool hangs_on_it = std::ranges::find(map.metrics, "slow_fraction") != map.metrics.end();
  if (table.find("stick_threshold") && scene.model.law->set_valued() && !hangs_on_it)
    scene.notes.push_back(
        "map.stick_threshold has no effect on stick_fraction under a set-valued law, whose stick is exact rest; ask "
        "for "
        "slow_fraction");
  table.finish();
}

void read(scene::SceneReader& reader) {
  reader.law();
  reader.oscillator();
  auto& map = reader.need("map", "the two axes and the metrics");
  if (reader.scene.string) return read_string_map(reader, scene::Table(map, "map"));
  if (reader.scene.plane || is_of_slider(reader)) return read_tables_of_models(reader);
  scene::read_structure_model(reader);
  common_period(reader.scene.structure->structure);  // refuses a drive that has none
  reader.scene.family = std::make_shared<scene::Family>(reader);
  read_table(scene::Table(map, "map"), reader);
  if (std::ranges::find(reader.scene.map.metrics, "lyapunov") != reader.scene.map.metrics.end())
    find_verb("lyapunov")
        .tables.front()
        .read(scene::Table(reader.need("lyapunov", "duration (s) for the metric of that name"), "lyapunov"), reader);
}

std::string document_of(const scene::Scene& scene, const output::MapResult& result) {
  const auto& map = result.map;
  auto document = output::begin(scene, "map", map.outcome);
  document["x"] = output::axis(map.x, scene);
  document["y"] = output::axis(map.y, scene);
  document["regime"] = output::rows(map, [](const auto& point) { return name(point.regime); });
  auto values = ordered_json::object(), error = values;
  for (const auto& metric : map.metrics) {
    values[metric.name] = output::rows(map, [&](const auto& point) { return metric.value(point); });
    error[metric.name] = output::rows(map, [&](const auto& point) { return metric.error(point); });
  }
  document["metrics"] = std::move(values);
  document["error"] = std::move(error);
  document["threshold"] = {{"x", map.threshold.x}, {"y", map.threshold.y}};
  document["fold"] = {{"x", map.fold.x}, {"y", map.fold.y}, {"error_decades", map.fold_error}};
  auto& failures = document["failures"] = ordered_json::array();
  for (std::size_t i = 0; i < map.points.size(); ++i)
    if (map.points[i].regime == analysis::planes::Regime::failed)
      failures.push_back(
          {{"ix", i % map.x.values.size()}, {"iy", i / map.x.values.size()}, {"why", map.points[i].why}});
  document["stick_threshold"] = scene.map.stick_threshold;
  document["tolerance"] = scene.map.tolerance;
  document["cost"] = {{"seconds", result.seconds},
                      {"points", map.points.size()},
                      {"integrated", map.integrated},
                      {"interpolated", map.interpolated},
                      {"skipped", map.skipped}};
  auto notes = scene.notes;
  notes.insert(notes.end(), map.notes.begin(), map.notes.end());
  document["notes"] = notes;
  return output::text(document);
}

/// Everything that determines a map: two runs with the same key have the same points.
std::string map_key(const scene::Scene& scene) {
  std::string key = fmt::format("rosin {}\ntolerance {}\n{}\n", ROSIN_VERSION, scene.map.tolerance,
                                scene.map.exact ? "exact" : "adaptive");
  if (!scene.structure)
    for (const auto& quantity : scene.model.parameters())
      key += fmt::format("{} = {}\n", quantity.name, scene.model.get(quantity.name));
  return key + scene.resolved;
}

Status perform(Job& job) {
  if (job.scene().string) return perform_string_map(job);
  const auto& request = job.request();
  auto& scene = job.scene();
  auto& options = scene.map;
  options.tolerance = request.tolerance.value_or(options.tolerance);
  options.threads = request.threads;
  options.exact = request.exact;
  options.lyapunov = scene.lyapunov;
  const auto nx = options.x.values.size(), ny = options.y.values.size(), total = nx * ny;
  const auto* structure = scene.structure ? &scene.structure->structure : nullptr;
  const auto metrics = structure ? analysis::planes::metrics_of_structure(*structure, options.metrics)
                                 : analysis::planes::metrics_of_slider(options.metrics);
  if (!structure) job.explain_model();
  job.explain("{} x {} points of {} and {}, tolerance {} of {}", nx, ny, options.x.parameter, options.y.parameter,
              options.tolerance, fmt::join(options.metrics, ", "));
  if (!structure) job.explain("where steady sliding is stable and no cycle can exist beside it, nothing is integrated");
  job.explain("{}", structure ? "every point is followed from its start until the motion recurs"
                    : analysis::planes::interpolates(options)
                        ? "points are computed where they are needed, and the others interpolated to the tolerance"
                    : options.exact ? "every point is computed, as asked"
                                    : "every point is computed: interpolation would gain nothing here");

  Partial partial(job.folder() / "map.partial", map_key(scene), total, metrics);
  if (!partial.lost().empty()) job.note(partial.lost());
  if (const auto known = partial.known_count()) job.note(fmt::format("going on from {} finished points", known));
  const auto begin = std::chrono::steady_clock::now();
  output::MapResult result;
  {
    Progress progress(request.quiet);
    const analysis::planes::MapHooks hooks = {
        .known = [&](std::size_t i) { return partial.known(i); },
        .finished = [&](std::span<const std::size_t> indices,
                        const std::vector<analysis::planes::MapPoint>& points) { partial.append(indices, points); },
        .progress = progress.of_map()};
    const auto at = [&](double x, double y) {
      return scene.family->with({{options.x.parameter, x}, {options.y.parameter, y}});
    };
    result.map = structure ? analysis::planes::compute_structure_map(at, options, metrics, hooks)
                           : analysis::planes::compute_map(scene.model, options, hooks);
  }
  auto& map = result.map;
  result.seconds = seconds_since(begin);
  if (map.outcome.ending == Ending::interrupted)
    return stopped_early(request,
                         fmt::format("{} of {} points are kept; the same command goes on from there",
                                     std::ranges::count_if(map.points, &analysis::planes::MapPoint::done), total));
  for (const auto& text : map.notes) job.explain("{}", text);
  job.explain("{} points integrated, {} interpolated, {} decided without integration", map.integrated, map.interpolated,
              map.skipped);

  std::array<std::size_t, 4> regimes{};
  for (const auto& point : map.points) ++regimes[static_cast<std::size_t>(point.regime)];
  auto& manifest = job.manifest();
  manifest.tolerance_asked = options.tolerance;
  manifest.cost = {{"seconds", result.seconds},
                   {"points", double(total)},
                   {"integrated", double(map.integrated)},
                   {"interpolated", double(map.interpolated)},
                   {"skipped", double(map.skipped)},
                   {"threads", double(options.threads)}};
  const auto between = map.interpolated > 0 ? fmt::format("{} interpolated, ", map.interpolated) : std::string();
  job.say("{} x {} points in {:.3g} s: {} integrated, {}{} decided without", nx, ny, result.seconds, map.integrated,
          between, map.skipped);
  for (const Regime regime : {Regime::stable, Regime::cycle, Regime::bistable, Regime::failed})
    if (const auto count = regimes[static_cast<std::size_t>(regime)]) job.say("  {:<9} {}", name(regime), count);
  for (const auto& metric : map.metrics) {
    const auto& wanted = metric.name;
    const bool fraction = wanted.find("fraction") != std::string::npos;
    // Of a number of either sign, which is 0 somewhere, errors count beside the largest in the plane.
    const bool of_either_sign = wanted == "growth_rate" || wanted == "lyapunov";
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

  output::write_plane(job.folder() / "map.nc", scene, map);
  auto files = output::write_picture(job.folder(), scene, map);
  files.push_back("map.nc");
  const auto status = job.finish(document_of(scene, result), std::move(files), map.outcome);
  partial.remove();
  return status;
}

}  // namespace

Verb map_verb() {
  return {.name = "map",
          .help = "regimes and metrics over a parameter plane",
          .example = "rosin map examples/bristol-board-plane.toml --set map.x.points=12 --set map.y.points=12",
          .operands = {scene_operand},
          .needs = model_tables({{"map", "the two axes and the metrics"}}),
          .options = scene_options({{"--exact", &Request::exact, "compute every point of a map, interpolate none"}}),
          .tables = {{"map", read_table}},
          .read = read,
          .perform = perform};
}

}  // namespace rosin::app::verbs
