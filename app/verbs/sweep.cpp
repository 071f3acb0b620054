/// The verb sweep: what changes along one parameter, upwards and downwards.
#include "analysis/planes/sweep.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/motion/structure_record.hpp"
#include "analysis/planes/structure_map.hpp"
#include "app/output/pictures.hpp"
#include "app/results/axis.hpp"
#include "app/results/writers.hpp"
#include "app/scene/family.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/string.hpp"
#include "app/scene/structure.hpp"
#include "app/tasks/bowing.hpp"
#include "app/tasks/sweep.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/plane_job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/sweep_job.hpp"
#include "app/verbs/sweep_journal.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using analysis::planes::Sweep;
using analysis::planes::SweepPoint;
using nlohmann::ordered_json;
using Recorded = analysis::planes::SweepOptions::Record;

namespace {

void read_axis(scene::Table& table, scene::Scene& scene) {
  const auto& parameter = table.required("parameter", "path of a number, such as drive.speed");
  const auto path = scene::text(parameter, table.path("parameter"));
  auto quantity = scene::located(parameter.source(), [&] { return scene.describe(path); });
  quantity.meaning = path + ", " + quantity.meaning;
  double from = 0, to = 0;
  int points = 100;
  table.required("from", quantity.meaning), table.required("to", quantity.meaning);
  table.read("from", from, quantity);
  table.read("to", to, quantity);
  table.read("points", points, 2, 100'000, "number of values");
  bool logarithmic = false;
  if (const auto* scale = table.find("scale"))
    logarithmic = scene::choice(*scale, table.path("scale"), {"log", "linear"}) == "log";
  scene.task<tasks::Sweep>().options.axis = scene::located(table.source(), [&] {
    return analysis::planes::make_axis(path, std::min(from, to), std::max(from, to), points, logarithmic, {});
  });
}

/// What is recorded of the motion at a moment: coordinates first.
std::vector<std::string> columns_of(const scene::Scene& scene) {
  std::vector<std::string> names;
  if (const auto* stepped = scene::stepped_of(scene)) {
    for (const auto& channel : stepped->channels) names.push_back(channel.name);
    return names;
  }
  const oscillators::StructureSystem system(scene.structure->structure);
  return analysis::motion::StructureRecord(system).names;
}

void read_metrics(scene::Table& table, scene::Scene& scene) {
  auto& metrics = scene.task<tasks::Sweep>().options.metrics;
  metrics = {"period", columns_of(scene).front() + "_amplitude"};
  const auto* given = table.find("metrics");
  if (!given) return;
  if (scene.task<tasks::Sweep>().options.record != Recorded::metrics)
    scene::fail(given->source(), "sweep.metrics has no effect without sweep.record = \"metrics\"");
  metrics = scene::texts(*given, table.path("metrics"));
  if (metrics.empty()) scene::fail(given->source(), "sweep.metrics is empty");
  for (std::size_t i = 0; i < metrics.size(); ++i)
    scene::located(given->as_array()->get(i)->source(), [&] { metrics_of(scene, {metrics[i]}); });
}

/// The column that is shown, and the coordinate whose maxima are the section: that of the column, if it is of one.
void read_column(scene::Table& table, scene::Scene& scene) {
  auto& sweep = scene.task<tasks::Sweep>();
  const auto* column = table.find("column");
  if (sweep.options.record == Recorded::metrics) {
    if (column) scene::fail(column->source(), "sweep.column has no effect on metrics");
    return;
  }
  const auto known = columns_of(scene);
  sweep.column = known.front();
  if (column) sweep.column = scene::choice(*column, table.path("column"), known);
  const auto* stepped = scene::stepped_of(scene);
  const int coordinates = stepped ? stepped->coordinates : scene.structure->structure.size();
  for (int i = 0; i < coordinates; ++i)  // their velocities follow them
    if (sweep.column == known[std::size_t(i)] || sweep.column == known[std::size_t(coordinates + i)])
      sweep.options.watch = i;
  // One that sticks to a surface at rest has no single moment of its maximum.
  const auto stands_still = [&](int i) { return !stepped && scene.structure->structure.stands_still(i); };
  for (int i = 0; i < coordinates && stands_still(sweep.options.watch); ++i)
    if (!stands_still(i)) sweep.options.watch = i;
}

void read_direction(scene::Table& table, analysis::planes::SweepOptions& sweep) {
  if (const auto* direction = table.find("direction")) {
    const auto chosen = scene::choice(*direction, table.path("direction"), {"up", "down", "both"});
    sweep.up = chosen != "down", sweep.down = chosen != "up";
  }
}

void read_sweep_table(scene::Table table, scene::Scene& scene) {
  auto& sweep = scene.task<tasks::Sweep>().options;
  table.expect({"parameter", "from", "to", "points", "scale", "direction", "start", "record", "column", "metrics",
                "stick_threshold", "transient", "keep"});
  read_axis(table, scene);
  read_direction(table, sweep);
  if (const auto* start = table.find("start"))
    sweep.anew = scene::choice(*start, table.path("start"), {"before", "scene"}) == "scene";
  if (const auto* record = table.find("record")) {
    const auto chosen = scene::choice(*record, table.path("record"), {"section", "extrema", "metrics"});
    sweep.record = chosen == "section"   ? Recorded::section
                   : chosen == "extrema" ? Recorded::extrema
                                         : Recorded::metrics;
  }
  read_metrics(table, scene);
  table.read("stick_threshold", sweep.stick_threshold,
             {"", "1", {1e-6, 0.999}, "metrics: stick is |v| <= threshold times V"});
  read_column(table, scene);
  for (const auto& [key, target, least, meaning] :
       {std::tuple{"transient", &sweep.transient, 0, "returns that are not recorded"},
        std::tuple{"keep", &sweep.keep, 1, "returns that are recorded"}}) {
    if (const auto* node = table.find(key); node && sweep.record == Recorded::metrics)
      scene::fail(node->source(), "sweep.{} has no effect on metrics, which are those of the period", key);
    table.read(key, *target, least, 1'000'000, meaning);
  }
  table.finish();
}

/// Strings have the metrics of their periods. They begin anew at each value, from the start of [cycle], or go on from
/// the motion at the value before along what a bow changes while it plays.
void read_sweep_of_strings(scene::SceneReader& reader, scene::Table table) {
  auto& scene = reader.scene;
  scene::read_string_cycle(reader);
  scene.family = std::make_shared<scene::Family>(reader, "sweep", true);
  table.expect({"parameter", "from", "to", "points", "scale", "direction", "start"});
  read_axis(table, scene);
  auto& options = scene.task<tasks::Sweep>().options;
  options.record = Recorded::metrics;
  const auto* start = table.find("start");
  options.anew = !start || scene::choice(*start, table.path("start"), {"scene", "before"}) == "scene";
  if (options.anew) {
    if (const auto* direction = table.find("direction"))
      scene::fail(direction->source(), "{} has no effect where each value begins anew; give {} = \"before\"",
                  table.path("direction"), table.path("start"));
  } else if (const auto& name = options.axis.parameter; name != "drive.speed" && name != "drive.normal_load") {
    scene::fail(start->source(),
                "{} = \"before\" goes along drive.speed or drive.normal_load, which a bow changes while it plays, not "
                "along {}",
                table.path("start"), name);
  }
  read_direction(table, options);
  table.finish();
}

void read_sweep(scene::SceneReader& reader) {
  auto& scene = reader.scene;
  reader.law();
  reader.oscillator();
  const auto& sweep = reader.need("sweep", "the parameter, its values, and what is recorded");
  if (scene.string) return read_sweep_of_strings(reader, scene::Table(sweep, "sweep"));
  if (!scene::read_stepped(reader)) {
    scene::read_structure_model(reader);
    common_period(scene.structure->structure);  // refuses a drive that has none
  }
  scene.family = std::make_shared<scene::Family>(reader, "sweep");
  read_sweep_table(scene::Table(sweep, "sweep"), scene);
}

template <class F>
ordered_json each(const std::vector<SweepPoint>& points, F f) {
  auto list = ordered_json::array();
  for (const auto& point : points) list.push_back(point.done ? ordered_json(f(point)) : ordered_json());
  return list;
}

/// Metrics over the values, or the moments of each value; those of values that have fewer are filled with NaN.
results::Table table_of(const scene::Scene& scene, const Sweep& sweep) {
  const auto& options = scene.task<tasks::Sweep>().options;
  const auto name = results::axis_names({options.axis.parameter}, {"moment"}).front();
  const bool of_metrics = !sweep.metrics.empty();
  results::Table table{.name = "sweep",
                       .dimensions = {{name, options.axis.values.size()}},
                       .columns = {results::coordinate(name, 0, options.axis, scene)},
                       .more = {{"tolerance", options.tolerance}},
                       .is_field = true};
  std::size_t longest = 1;
  for (const auto* points : {&sweep.up, &sweep.down})
    for (const auto& point : *points)
      if (!point.columns.empty()) longest = std::max(longest, point.columns.front().size());
  if (!of_metrics) table.dimensions.push_back({"moment", longest});
  for (const auto& [direction, points] : {std::pair{"up", &sweep.up}, std::pair{"down", &sweep.down}}) {
    if (points->empty()) continue;
    const auto channel = [&, direction = direction](const auto& name, const auto& unit, const auto& meaning) {
      return results::Channel{fmt::format("{}_{}", name, direction), unit,
                              fmt::format("{}, {}wards", meaning, direction)};
    };
    for (const auto& metric : sweep.metrics) {
      std::vector<double> values, errors;
      for (const auto& point : *points) {
        values.push_back(point.done ? metric.value(point.metrics) : NAN);
        errors.push_back(point.done ? metric.error(point.metrics) : NAN);
      }
      table.columns.push_back({channel(metric.name, metric.unit, metric.meaning), std::move(values)});
      table.columns.push_back(
          {channel(metric.name + "_error", metric.unit, results::error_of({metric.name})), std::move(errors)});
    }
    for (std::size_t c = 0; !of_metrics && c < sweep.column_names.size(); ++c) {
      std::vector<double> values(points->size() * longest, NAN);
      for (std::size_t i = 0; i < points->size(); ++i)
        if (const auto& columns = (*points)[i].columns; !columns.empty())
          std::ranges::copy(columns[c], values.begin() + long(i * longest));
      table.columns.push_back({channel(sweep.column_names[c], sweep.column_units[c], sweep.column_names[c]),
                               std::move(values),
                               {},
                               {0, 1}});
    }
  }
  return table;
}

results::Result result_of(const Job& job, const Sweep& sweep) {
  const auto& scene = job.scene();
  const auto& asked = scene.task<tasks::Sweep>();
  const auto& axis = asked.options.axis;
  auto result = job.result(sweep.outcome);
  result["parameter"] = axis.parameter;
  result["unit"] = scene.describe(axis.parameter).unit;
  result["values"] = axis.values;
  const auto both = [&](auto of) { return ordered_json{{"up", of(sweep.up)}, {"down", of(sweep.down)}}; };
  if (sweep.metrics.empty()) {
    result["column"] = asked.column;
    const auto c = std::size_t(std::ranges::find(sweep.column_names, asked.column) - sweep.column_names.begin());
    const auto moments = [&](const auto& points) {
      return each(points, [&](const SweepPoint& point) { return ordered_json(point.columns[c]); });
    };
    result["up"] = moments(sweep.up), result["down"] = moments(sweep.down);
    result["recurrence"] =
        both([](const auto& points) { return each(points, [](const auto& point) { return point.recurrence; }); });
  } else {
    const auto values = [&](const auto& points, bool error) {
      auto table = ordered_json::object();
      for (const auto& metric : sweep.metrics)
        table[metric.name] = each(points, [&](const auto& point) {
          return error ? metric.error(point.metrics) : metric.value(point.metrics);
        });
      return table;
    };
    result["up"] = values(sweep.up, false), result["down"] = values(sweep.down, false);
    result["error"] = both([&](const auto& points) { return values(points, true); });
    result["regime"] = both([](const auto& points) {
      return each(points, [](const auto& point) { return ordered_json(name(point.metrics.regime)); });
    });
    const auto motion = [&, mean_return = mean_return_of(scene)](const SweepPoint& point) {
      return analysis::planes::motion_of(point.metrics, sweep.metrics, mean_return);
    };
    const auto tells = [&](const SweepPoint& point) { return !motion(point).empty() && motion(point) != "steady"; };
    if (std::ranges::any_of(sweep.up, tells) || std::ranges::any_of(sweep.down, tells))
      result["motion"] = both([&](const auto& points) {
        return each(points, [&](const auto& point) { return ordered_json(motion(point)); });
      });
  }
  auto& thresholds = result["thresholds"] = ordered_json::array();
  for (const auto& threshold : sweep.thresholds)
    thresholds.push_back({{"value", threshold.value},
                          {"kind", threshold.onset ? "onset" : "end"},
                          {"angular_frequency", threshold.angular_frequency},
                          {"error", threshold.error}});
  auto& failures = result["failures"] = ordered_json::array();
  for (const auto& [direction, points] : {std::pair{"up", &sweep.up}, std::pair{"down", &sweep.down}})
    for (std::size_t i = 0; i < points->size(); ++i)
      if (const auto& why = (*points)[i].why; !why.empty())
        failures.push_back({{"direction", direction}, {"value", axis.values[i]}, {"why", why}});
  result["tolerance"] = asked.options.tolerance;
  if (!sweep.thresholds_left_out.empty()) result.notes.push_back(sweep.thresholds_left_out);
  result.tables = {table_of(scene, sweep)};
  return result;
}

/// The journal beside the results, with what an interrupted run of the same sweep has left there.
void open_journal(std::optional<SweepJournal>& journal, const Job& job, const scene::Scene& scene) {
  const auto& options = scene.task<tasks::Sweep>().options;
  std::vector<analysis::planes::PlaneMetric> metrics;
  std::size_t columns = 0;
  if (options.record != Recorded::metrics)
    columns = columns_of(scene).size();
  else
    metrics = metrics_of(scene, options.metrics);
  journal.emplace(job.results() / "sweep.partial", journal_key(scene, options.tolerance, "sweep"),
                  options.axis.values.size(), columns, std::move(metrics));
}

}  // namespace

Status perform_sweep(Job& job) {
  auto& scene = job.scene();
  auto& options = scene.task<tasks::Sweep>().options;
  options.tolerance = job.request().tolerance.value_or(options.tolerance);
  options.threads = job.request().threads;
  const auto& axis = options.axis;
  const auto parameter = scene.describe(axis.parameter);
  const bool of_metrics = options.record == Recorded::metrics;
  job.explain("{} values of {}, {}", axis.values.size(), axis.parameter,
              options.anew ? "each from the scene's start" : "each from the motion at the value before");
  const auto* stepped = scene::stepped_of(scene);
  const double drive_period = scene::drive_period_of(scene);
  if (!of_metrics)
    job.explain("{} returns of transient, then {} are recorded: {}", options.transient, options.keep,
                options.record == Recorded::extrema ? "maxima and minima of the displacement"
                : drive_period > 0                  ? "the moment t = 0 of the drive"
                                                    : "maxima of the displacement");
  std::optional<SweepJournal> journal;
  if (!scene.string) {
    open_journal(journal, job, scene);
    if (!journal->lost().empty()) job.note(journal->lost());
    if (const auto known = journal->known_count()) job.note(fmt::format("going on from {} finished values", known));
  }
  const auto begin = std::chrono::steady_clock::now();
  Sweep sweep;
  if (scene.string) {
    sweep = sweep_of_strings(job);
  } else {
    Progress progress(job.request().quiet);
    const analysis::planes::SweepHooks hooks{
        .progress = [&](std::size_t done, std::size_t total) { progress.show(done, total); },
        .known = [&](bool up, std::size_t value) { return journal->known(up, value); },
        .finished = [&](bool up, std::size_t value, const SweepPoint& point) { journal->append(up, value, point); }};
    if (stepped)
      sweep = analysis::planes::sweep(
          [&](double value) {
            return scene.family->stepped_with({{axis.parameter, value}});
          },
          options, hooks);
    else
      sweep = analysis::planes::sweep(
          [&](double value) {
            return scene.family->with({{axis.parameter, value}});
          },
          options, hooks);
  }
  const bool stopped = sweep.outcome.ending == Ending::interrupted;
  if (stopped) sweep.outcome.detail += "; the same command goes on from there";
  sweep.outcome = why_stopped(sweep.outcome);
  const double seconds = seconds_since(begin);
  auto& manifest = job.manifest();
  manifest.tolerance_asked = options.tolerance;
  manifest.cost = {{"seconds", seconds}, {"values", double(axis.values.size())}, {"threads", double(options.threads)}};
  for (const auto& [direction, points] : {std::pair{"upwards", &sweep.up}, std::pair{"downwards", &sweep.down}}) {
    const auto count = [&](auto is) { return std::ranges::count_if(*points, is); };
    if (points->empty()) continue;
    const auto done = count(&SweepPoint::done), failed = count([](const auto&point) { return !point.why.empty(); });
    job.say("{}: {} values of {} from {:g} to {:g}{}, {} ended short", direction, done, axis.parameter,
            axis.values.front(), axis.values.back(), parameter.unit == "1" ? "" : " " + parameter.unit, failed);
    if (!of_metrics)
      job.say("  the motion recurs within {} returns at {} of them", options.keep / 2,
              count([](const auto& point) { return point.recurrence > 0; }));
  }
  for (const auto& threshold : sweep.thresholds)
    job.say("steady sliding is unstable {} {} = {}", threshold.onset ? "above" : "below", axis.parameter,
            justified(threshold.value, threshold.error, parameter.unit));
  if (!sweep.thresholds_left_out.empty()) job.note(sweep.thresholds_left_out);
  auto result = result_of(job, sweep);
  result.cost = {{"seconds", seconds}};
  const auto status = job.finish(result, output::write_picture(job.folder(), scene, sweep));
  if (journal && !stopped) journal->remove();
  return status;
}

Verb sweep_verb() {
  return {.name = "sweep",
          .help = "section, extrema or metrics along one parameter, upwards and downwards",
          .example = "rosin sweep examples/forced-belt-sweep.toml --set sweep.points=20",
          .operands = {scene_operand},
          .needs = model_tables({{"sweep", "the parameter, its values, and what is recorded"}}),
          .options = scene_options(),
          .read = read_sweep,
          .perform = perform_sweep};
}

}  // namespace rosin::app::verbs
