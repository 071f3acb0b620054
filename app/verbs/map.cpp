/// The verb map: regimes and metrics over a parameter plane.
#include "analysis/planes/map.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>

#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/lyapunov.hpp"
#include "analysis/planes/parts.hpp"
#include "analysis/planes/structure_map.hpp"
#include "app/scene/family.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/string.hpp"
#include "app/scene/structure.hpp"
#include "app/scene/uncertain.hpp"
#include "app/tasks/bowing.hpp"
#include "app/tasks/sweep.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/partial.hpp"
#include "app/verbs/plane_job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/ranks.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/sweep_job.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

namespace {

using analysis::planes::Share;

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

bool is_metric_of_slider(const std::string& name) {
  return std::ranges::any_of(analysis::cycles::metric_names(), [&](const auto& metric) { return metric.name == name; });
}

bool is_metric_of(const oscillators::Structure& structure, const std::string& name) {
  try {
    return !analysis::planes::metrics_of_structure(structure, {name}).empty();
  } catch (const InputError&) {
    return false;
  }
}

/// A plane of a slider's own parameters under a constant drive has shortcuts, for the metrics that its search for a
/// cycle returns; any other is that of a structure, and so is a plane of one axis.
bool is_of_slider(const scene::SceneReader& reader, scene::Table map) {
  const auto& scene = reader.scene;
  if (scene.structure || scene.plane || scene.string || !scene.model.drive.constant() || !map.find("y")) return false;
  std::vector<std::string> names;
  if (const auto* metrics = map.find("metrics")) names = scene::texts(*metrics, map.path("metrics"));
  if (const auto* noise = reader.request.design ? reader.document.at_path("compare.noise").as_table() : nullptr)
    for (const auto& [metric, of_metric] : *noise) names.emplace_back(metric.str());
  return std::ranges::none_of(names, [&](const auto& name) {
    return !is_metric_of_slider(name) && is_metric_of(oscillators::one_slider(scene.model), name);
  });
}

void refuse_extra(scene::Table x) {
  if (const auto* extra = x.find("extra"))
    scene::fail(extra->source(),
                "map.x.extra goes with a plane; without map.y its values belong into from, to, points");
}

/// A plane of one axis is the sweep of that parameter, of strings as well.
void read_one_axis_of_strings(scene::SceneReader& reader, scene::Table table) {
  auto& scene = reader.scene;
  scene::read_string_cycle(reader);
  scene.family = std::make_shared<scene::Family>(reader, "map", true);
  table.expect({"x", "y"});
  const scene::Table x(table.required("x", "the axis"), table.path("x"));
  scene.task<analysis::planes::MapOptions>().x = read_axis(x, scene);
  refuse_extra(x);
  table.finish();
}

void read_map_table(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  if (!reader.needs("map") && !is_of_slider(reader, table))
    return;  // its paths and metrics are known to the verb map alone
  auto& map = scene.task<analysis::planes::MapOptions>();
  table.expect({"x", "y", "metrics", "stick_threshold", "uncertain", "samples", "seed"});
  const auto& x = table.required("x", "first axis");
  map.x = read_axis(scene::Table(x, table.path("x")), scene);
  const auto* y = table.find("y");
  if (y) {
    map.y = read_axis(scene::Table(*y, table.path("y")), scene);
    if (map.x.parameter == map.y.parameter)
      scene::fail(y->source(), "map.x and map.y are the same parameter, {}", map.y.parameter);
  } else {
    refuse_extra(scene::Table(x, table.path("x")));
  }
  if (y && map.x.values.size() > scene::most_points / map.y.values.size())
    scene::fail(table.source(), "map has {} x {} points, more than {}", map.x.values.size(), map.y.values.size(),
                scene::most_points);
  const auto* structure = scene.structure ? &scene.structure->structure : nullptr;
  const auto* stepped = scene::stepped_of(scene);
  map.metrics = {"stick_fraction", "loop_area_normalised"};
  if (stepped)
    map.metrics = {stepped->channels.front().name + "_max"};
  else if (structure && !(structure->size() == 1 && structure->constant()))
    map.metrics = {structure->names.front() + "_max"};
  const auto check = [&](const std::string& name) {
    if (structure || stepped)
      metrics_of(scene, {name});
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
  map.uncertain = scene::read_uncertain(
      table, [&](const std::string& path) { scene.describe(path); }, map.samples, map.seed);
  const bool draws = std::ranges::find(map.metrics, "probability_unstable") != map.metrics.end();
  if (const auto* uncertain = draws ? nullptr : table.find("uncertain"))
    scene::fail(uncertain->source(), "map.uncertain has no effect without the metric probability_unstable");
  if (draws && map.uncertain.empty())
    scene::fail(table.source(),
                "the metric probability_unstable needs map.uncertain, relative standard deviations by path, such as "
                "{{ \"law.mu_d\" = 0.1 }}");
  map.stick_threshold = scene.task<analysis::cycles::CycleOptions>().stick_threshold;
  table.read("stick_threshold", map.stick_threshold, {"", "1", {1e-6, 0.999}, "stick is |v| <= threshold times V"});
  const bool hangs_on_it = std::ranges::find(map.metrics, "slow_fraction") != map.metrics.end();
  if (table.find("stick_threshold") && stepped)
    scene.notes.push_back("map.stick_threshold has no effect: stick is what the motion's steps show");
  if (table.find("stick_threshold") && !structure && !stepped && scene.model.law->set_valued() && !hangs_on_it)
    scene.notes.push_back(
        "map.stick_threshold has no effect on stick_fraction under a set-valued law, whose stick is exact rest; ask "
        "for "
        "slow_fraction");
  table.finish();
}

void read_map(scene::SceneReader& reader) {
  reader.law();
  reader.oscillator();
  auto& map = reader.need("map", "the two axes and the metrics");
  if (reader.scene.string) {
    scene::Table table(map, "map");
    return table.find("y") ? read_string_map(reader, table) : read_one_axis_of_strings(reader, table);
  }
  if (is_of_slider(reader, scene::Table(map, "map"))) return read_tables_of_models(reader);
  if (!scene::read_stepped(reader)) {
    scene::read_structure_model(reader);
    common_period(reader.scene.structure->structure);  // refuses a drive that has none
  }
  reader.scene.family = std::make_shared<scene::Family>(reader, "map");
  read_map_table(scene::Table(map, "map"), reader);
  if (std::ranges::find(reader.scene.task<analysis::planes::MapOptions>().metrics, "lyapunov") !=
      reader.scene.task<analysis::planes::MapOptions>().metrics.end())
    find_verb("lyapunov")
        .tables.front()
        .read(scene::Table(reader.need("lyapunov", "duration (s) for the metric of that name"), "lyapunov"), reader);
}

/// What --shard says, or else the array of jobs that a cluster's SLURM has started this one in. \throws InputError
Share wanted_share(const Request& request, const Job& job) {
  if (!request.shard.empty()) {
    const auto share = share_of(request.shard, "/", std::numeric_limits<int>::max());
    if (!share)
      throw InputError(fmt::format(
          "--shard {}: must be K/N with 1 <= K <= N, such as 2/8 for the second share of eight", request.shard));
    return *share;
  }
  const char *id = std::getenv("SLURM_ARRAY_TASK_ID"), *first = std::getenv("SLURM_ARRAY_TASK_MIN"),
             *count = std::getenv("SLURM_ARRAY_TASK_COUNT"), *step = std::getenv("SLURM_ARRAY_TASK_STEP");
  if (!id || !first || !count) return {};
  const int every = step ? std::max(std::atoi(step), 1) : 1, distance = std::atoi(id) - std::atoi(first);
  const Share share{distance / every, std::atoi(count)};
  if (share.count < 2) return {};
  if (distance < 0 || distance % every != 0 || share.index >= share.count)
    throw InputError(
        fmt::format("SLURM_ARRAY_TASK_ID={} is no place in an array of {} jobs from {} in steps of {}: say by --shard "
                    "K/N which share "
                    "of the plane is wanted, or by --shard 1/1 that all of it is",
                    id, count, first, every));
  job.note(fmt::format("job {} of the array computes --shard {}/{} of the plane; --shard 1/1 computes all of it", id,
                       share.index + 1, share.count));
  return share;
}

/// A plane of one axis is the sweep of that parameter, each value from the scene's start, with the plane's metrics.
Status perform_one_axis(Job& job) {
  const auto& request = job.request();
  if (request.ranks || !request.shard.empty())
    throw InputError(fmt::format(
        "[map] has one axis, {}, whose values the threads of one process compute: leave --shard and mpirun away, or "
        "give map.y",
        job.scene().task<analysis::planes::MapOptions>().x.parameter));
  job.claim_folder();
  const auto& map = job.scene().task<analysis::planes::MapOptions>();
  auto& sweep = job.scene().task<tasks::Sweep>().options;
  sweep.axis = map.x;
  std::ranges::sort(sweep.axis.values);
  sweep.record = analysis::planes::SweepOptions::Record::metrics;
  sweep.anew = true;
  sweep.metrics = map.metrics, sweep.stick_threshold = map.stick_threshold;
  sweep.tolerance = map.tolerance;
  sweep.lyapunov = job.scene().task<analysis::cycles::LyapunovOptions>();
  job.results_of("sweep");
  return perform_sweep(job);
}

Status perform_map(Job& job) {
  const auto& request = job.request();
  auto* ranks = request.ranks;
  if (job.scene().string && !job.scene().string->y.values.empty()) {
    if (ranks || !request.shard.empty())
      throw InputError(
          "a plane of strings is computed by the threads of one process: leave --shard and mpirun away, or cut the "
          "plane along an axis into scenes of their own");
    job.claim_folder();
    return perform_string_map(job);
  }
  if (job.scene().task<analysis::planes::MapOptions>().y.values.empty()) return perform_one_axis(job);
  PlaneJob plane(job);
  auto& options = plane.options;
  const auto share = options.share = wanted_share(request, job);
  const auto nx = options.x.values.size(), ny = options.y.values.size(), total = plane.points;
  if (plane.of_slider) job.explain_model();
  job.explain("{} x {} points of {} and {}, tolerance {} of {}", nx, ny, options.x.parameter, options.y.parameter,
              options.tolerance, fmt::join(options.metrics, ", "));
  if (plane.of_slider)
    job.explain("where steady sliding is stable and no cycle can exist beside it, nothing is integrated");
  job.explain("{}", !plane.of_slider ? "every point is followed from its start until the motion recurs"
                    : analysis::planes::interpolates(options)
                        ? "points are computed where they are needed, and the others interpolated to the tolerance"
                    : options.exact ? "every point is computed, as asked"
                                    : "every point is computed: interpolation would gain nothing here");
  if (ranks) {
    ranks->begin(plane.key, RecordForm(plane.metrics, total));
    if (!ranks->leads()) {
      analysis::planes::MapHooks hooks;
      hooks.crew = ranks;
      plane.compute(hooks);
      return done;
    }
    job.explain("{} processes compute it, each with {} threads", ranks->processes(), options.threads);
  }

  if (share.count == 1) job.claim_folder();  // of a share, only its journal is written

  // Which points are of this share is asked before there is a journal: a plane may have fewer parts.
  const auto partition = analysis::planes::partition_of(options, !plane.of_slider);
  std::size_t of_share = 0;
  const auto shares = partition.shares(share.count);
  for (std::size_t part = 0; part < shares.size(); ++part)
    if (const auto [columns, rows] = partition.size(part); shares[part] == share.index)
      of_share += std::size_t(columns) * std::size_t(rows);

  Partial partial(job.results() / journal_name(share), plane.key, total, plane.metrics);
  if (!partial.lost().empty()) job.note(partial.lost());
  if (const auto known = partial.known_count()) job.note(fmt::format("going on from {} finished points", known));
  const auto begin = std::chrono::steady_clock::now();
  MapResult result;
  std::map<std::size_t, double> costs;
  {
    Progress progress(request.quiet);
    result.map = plane.compute(
        {.known = [&](std::size_t i) { return partial.known(i); },
         .finished = [&](std::span<const std::size_t> indices,
                         const std::vector<analysis::planes::MapPoint>& points) { partial.append(indices, points); },
         .progress = progress.of_map(),
         .costs =
             [&](const std::vector<analysis::planes::PartCost>& of_parts) {
               partial.append(of_parts);
               for (const auto& cost : of_parts) costs[cost.part] = cost.seconds;
             },
         .crew = ranks});
  }
  result.seconds = seconds_since(begin);
  if (ranks) ranks->part();
  const auto kept = std::ranges::count_if(result.map.points, &analysis::planes::MapPoint::done);
  if (result.map.outcome.ending == Ending::interrupted)
    return stopped_early(request,
                         fmt::format("{} of {} points are kept; the same command goes on from there", kept, of_share));
  if (share.count > 1) {
    job.say("share {} of {} is done: {} of {} points in {:.3g} s, in {}", share.index + 1, share.count, kept, total,
            result.seconds, (job.results() / journal_name(share)).string());
    if (request.json) write_output(results::to_json(request.verb, result.map.outcome));
    job.say("once all shares are done, they are put together by\n  {}", command_of(request, "merge"));
    return done;
  }
  const auto status = plane.write(result, costs);
  partial.remove();
  return status;
}

}  // namespace

Verb map_verb() {
  return {
      .name = "map",
      .help = "regimes and metrics over a parameter plane, or along one parameter",
      .example = "rosin map examples/bristol-board-plane.toml --set map.x.points=12 --set map.y.points=12",
      .operands = {scene_operand},
      .needs = model_tables({{"map", "the two axes and the metrics"}}),
      .options = scene_options(
          {{"--exact", &Request::exact, "compute every point of a map, interpolate none"},
           {"--shard", &Request::shard,
            "K/N: compute the K-th of N shares of the plane, for 'rosin merge'; default that of a SLURM array job"}}),
      .tables = {{"map", read_map_table}},
      .read = read_map,
      .perform = perform_map,
      .spreads = true};
}

}  // namespace rosin::app::verbs
