/// The verb study: random oscillators under every algorithm, their statistics, tables and pictures.

#include "analysis/studies/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>

#include "app/output/figure.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verb.hpp"
#include "core/files.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

namespace fs = std::filesystem;
using analysis::studies::AlgorithmStatistics;
using analysis::studies::StudyResult;
using analysis::studies::Summary;
using analysis::studies::Weibull;

// ---------------------------------------------------------------- JSON and tables

ordered_json to_json(const Summary& s) {
  return {{"count", s.count},
          {"mean", s.mean},
          {"standard_deviation", s.standard_deviation},
          {"minimum", s.minimum},
          {"quarter", s.quarter},
          {"median", s.median},
          {"three_quarters", s.three_quarters},
          {"q95", s.q95},
          {"maximum", s.maximum}};
}

ordered_json to_json(const Weibull& fit) {
  return {{"threshold", fit.threshold},
          {"characteristic", fit.characteristic},
          {"shape", fit.shape},
          {"mean", fit.mean()},
          {"q95", fit.quantile(0.95)}};
}

ordered_json to_json(const AlgorithmStatistics& a) {
  ordered_json object{{"sticking_cases", a.sticking_cases},
                      {"alone", a.alone},
                      {"missed", a.missed},
                      {"invented", a.invented},
                      {"more_sticks", a.more_sticks},
                      {"false_starts", a.false_starts},
                      {"back_steps", a.back_steps},
                      {"error", to_json(a.smallest_error)},
                      {"last_error", to_json(a.last_error)},
                      {"drift", to_json(a.drift)},
                      {"first_stick_error", to_json(a.first_stick_error)},
                      {"stick_share_error", to_json(a.stick_share_error)},
                      {"friction_work_error", to_json(a.friction_work_error)}};
  if (a.weibull) {
    auto likelihood = to_json(a.weibull->likelihood.fit);
    likelihood["shape_interval"] = a.weibull->likelihood.shape_interval;
    likelihood["characteristic_interval"] = a.weibull->likelihood.characteristic_interval;
    object["weibull"] = {{"moments", to_json(a.weibull->moments)},
                         {"plot", to_json(a.weibull->plot)},
                         {"likelihood", std::move(likelihood)}};
  }
  return object;
}

/// One row for each case: its inputs, and what the exact motion and each algorithm showed.
results::Table table_of(const scene::Scene& scene, const StudyResult& result) {
  std::vector<results::Column> columns;
  const auto column = [&](results::Channel channel, auto value) {
    std::vector<double> values;
    for (const auto& c : result.cases) values.push_back(double(value(c)));
    columns.push_back({std::move(channel), std::move(values)});
  };
  std::size_t number = 0;
  column({"case"}, [&](const auto&) { return number++; });
  for (std::size_t k = 0; k < result.input_names.size(); ++k)
    column({result.input_names[k], result.input_units[k]}, [&](const auto& c) { return c.inputs[k]; });
  column({"average_speed", "m/s"}, [](const auto& c) { return c.average_speed; });
  const auto motion = [&](const std::string& name, auto of, bool exact) {
    column({name + "_sticks"}, [&](const auto& c) { return of(c).sticks; });
    column({name + "_first_stick", "s"}, [&](const auto& c) { return of(c).first_stick; });
    column({name + "_stick_share"}, [&](const auto& c) { return of(c).stick_share; });
    column({name + "_friction_work", "J"}, [&](const auto& c) { return of(c).friction_work; });
    column({name + "_wear_rate", "W"}, [&](const auto& c) { return of(c).wear_rate; });
    if (exact) return;
    column({name + "_error"}, [&](const auto& c) { return of(c).smallest_error; });
    column({name + "_last_error"}, [&](const auto& c) { return of(c).last_error; });
    column({name + "_drift", "m"}, [&](const auto& c) { return of(c).drift; });
    column({name + "_back_steps"}, [&](const auto& c) { return of(c).back_steps; });
    column({name + "_false_starts"}, [&](const auto& c) { return of(c).false_starts; });
  };
  motion(
      "exact", [](const auto& c) -> const analysis::studies::Motion& { return c.exact; }, true);
  const auto& algorithms = scene.task<analysis::studies::StudyOptions>().algorithms;
  for (std::size_t a = 0; a < algorithms.size(); ++a)
    motion(
        algorithms[a], [a](const auto& c) -> const analysis::studies::Motion& { return c.motions[a]; }, false);
  return results::rows("study", std::move(columns));
}

results::Result result_of(const Job& job, const StudyResult& of) {
  const auto& scene = job.scene();
  const auto& asked = scene.task<analysis::studies::StudyOptions>();
  auto result = job.result(of.outcome);
  result["cases"] = of.cases.size();
  result["dimensions"] = asked.dimensions;
  result["seed"] = asked.seed;
  result["common"] = of.common;
  result["exact"] = {{"sticking_cases", of.exact_sticking_cases},
                     {"stick_share", to_json(of.exact_stick_share)},
                     {"friction_work", to_json(of.exact_friction_work)},
                     {"wear_rate", to_json(of.exact_wear_rate)}};
  auto algorithms = ordered_json::object();
  for (const auto& a : of.algorithms) algorithms[a.name] = to_json(a);
  result["algorithms"] = std::move(algorithms);
  result["shown_case"] = of.shown_case;
  result.tables = {table_of(scene, of)};
  return result;
}

// ---------------------------------------------------------------- pictures

/// Errors in the cases where all algorithms stick, ascending.
std::vector<double> errors_of(const StudyResult& result, std::size_t a) {
  std::vector<double> errors;
  for (const auto& c : result.cases)
    if (std::ranges::all_of(c.motions, [](const auto& motion) { return motion.sticks > 0; }))
      errors.push_back(c.motions[a].smallest_error);
  std::ranges::sort(errors);
  return errors;
}

/// Points by which algorithms are told apart.
constexpr results::Point points[] = {results::Point::open_square, results::Point::circle, results::Point::open_up,
                                     results::Point::open_down, results::Point::open_diamond};
results::Look look_of(std::size_t algorithm, double size) {
  return {.style = results::style_of(algorithm), .point = points[algorithm % std::size(points)], .size = size};
}

/// The line of a Weibull distribution where it is drawn: straight over logarithmic axes.
std::vector<std::vector<double>> straight(const Weibull& fit, double low, double high) {
  std::vector<std::vector<double>> ends;
  for (const double y : {low, high})
    ends.push_back({std::abs(fit.characteristic - fit.threshold) * std::pow(y, 1 / fit.shape), y});
  return ends;
}

/// Weibull plot, shares, boxes and back-steps.
std::vector<std::string> write_statistics(const fs::path& folder, const scene::Scene& scene,
                                          const StudyResult& result) {
  results::Figure figure{.name = "study",
                         .what = "Errors of the force algorithms over random oscillators",
                         .title = scene.title,
                         .width = 980,
                         .columns = 2,
                         .height = 290,
                         .key = results::Key::own};
  const auto axis = [](std::string name, bool decades, double from, double to) {
    return results::Axis{.name = std::move(name), .decades = decades, .from = from, .to = to};
  };
  constexpr double least = 1e-3, most = 10;
  results::Panel weibull{.x = axis("distance from the threshold, |e − e₀|", true, results::unset, results::unset),
                         .y = axis("−ln R, R the share of cases above e", true, least, most),
                         .key = "top left"},
      shares{.x = axis("error e, slip rate in stick over 0.001 average speed", true, 1e-6, 10),
             .y = axis("share of cases below (%)", false, 0, 100),
             .key = "top left"},
      boxes{.x = axis("", false, 0.3, 0), .y = axis("error e", true, 1e-7, 10)},
      back{.x = axis("steps back at the first stick", false, -0.5, 9.5),
           .y = axis("cases", false, 0, results::unset),
           .key = "top right"};
  results::FigureTable data{"study-errors.csv",
                            {{"algorithm", {}}, {"error", {}}, {"distance", {}}, {"weibull", {}}, {"share", {}}}},
      steps{"study-back-steps.csv", {{"steps", {}}}};
  for (int n = 0; n < 10; ++n) {
    steps.columns[0].values.push_back(n);
    back.x.ticks.push_back({double(n), n < 9 ? fmt::format("{}", n) : "9+"});
  }
  std::vector<results::Line> lines;
  for (std::size_t a = 0; a < result.algorithms.size(); ++a) {
    const auto& found = result.algorithms[a];
    const std::vector<double> counts(found.back_steps.begin(), found.back_steps.end());
    steps.columns.push_back({found.name, counts});
    if (std::any_of(counts.begin() + 1, counts.end(), [](double n) { return n > 0; }))
      back.lines.push_back({.table = steps.file,
                            .y = {int(a) + 2},
                            .how = results::How::bars,
                            .look = look_of(a, 0),
                            .title = found.name});
    const auto errors = errors_of(result, a);
    if (errors.empty()) continue;
    const double threshold =
        found.name == "o-fbfm" ? scene.task<analysis::studies::StudyOptions>().window_threshold : 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const double p = (double(i) + 0.7) / (double(errors.size()) + 0.4);
      const double row[] = {double(a), errors[i], std::abs(errors[i] - threshold), -std::log1p(-p), 100 * p};
      for (std::size_t c = 0; c < std::size(row); ++c) data.columns[c].values.push_back(row[c]);
    }
    const std::vector<results::Where> own = {{1, '=', double(a)}};
    weibull.lines.push_back({.table = data.file,
                             .x = {3},
                             .y = {4},
                             .how = results::How::points,
                             .look = look_of(a, 0.5),
                             .title = found.name,
                             .where = own});
    if (found.weibull)
      lines.push_back(
          {.table = "", .look = look_of(a, 0), .rows = straight(found.weibull->likelihood.fit, least, most)});
    shares.lines.push_back({.table = data.file,
                            .x = {2},
                            .y = {5},
                            .how = results::How::line_and_points,
                            .look = look_of(a, 0.3),
                            .title = found.name,
                            .where = own});
    boxes.lines.push_back({.table = data.file,
                           .x = {.plus = double(a + 1)},
                           .y = {2},
                           .how = results::How::boxplot,
                           .look = look_of(a, 0),
                           .where = own});
    boxes.x.ticks.push_back({double(a + 1), found.name});
  }
  figure.tables = {std::move(data), std::move(steps)};
  if (weibull.lines.empty()) return {};
  const auto [nearest, farthest] = results::Extent::of(figure.tables.front().columns[2].values);
  weibull.x.from = nearest, weibull.x.to = farthest;
  weibull.lines.insert(weibull.lines.end(), lines.begin(), lines.end());
  boxes.x.to = double(boxes.x.ticks.size()) + 0.7;
  figure.panels = {std::move(weibull), std::move(shares), std::move(boxes)};
  if (!back.lines.empty()) figure.panels.push_back(std::move(back));
  return output::write(folder, figure);
}

/// The response of one case with its strip, and every step around the entry into its first stick.
std::vector<std::string> write_case(const fs::path& folder, const scene::Scene& scene, const StudyResult& result) {
  if (result.shown.empty()) return {};
  results::Figure figure{.name = "study-case",
                         .what = "One case: response, strip of stick and slip, and entry into stick",
                         .title = fmt::format("{}, case {}", scene.title, result.shown_case),
                         .width = 980,
                         .columns = 2,
                         .height = 320,
                         .key = results::Key::own};
  // Displacements and velocities of all that are shown; of motions and entries.
  std::map<int, results::Extent> extents[2];
  double latest = 0;
  for (const auto& motion : result.shown)
    for (const bool entry : {false, true}) {
      results::FigureTable table{fmt::format("study-{}-{}.csv", entry ? "entry" : "motion", motion.name),
                                 {{"time (s)", {}}, {"stick", {}}}};
      const auto& points = entry ? motion.entry : motion.whole;
      for (std::size_t d = 0; !points.empty() && d < points[0].displacement.size(); ++d) {
        table.columns.push_back({fmt::format("displacement_{} (m)", d + 1), {}});
        table.columns.push_back({fmt::format("velocity_{} (m/s)", d + 1), {}});
      }
      for (const auto& point : points) {
        table.columns[0].values.push_back(point.time);
        table.columns[1].values.push_back(point.stick ? 1 : 0);
        for (std::size_t d = 0; d < point.displacement.size(); ++d) {
          table.columns[2 + 2 * d].values.push_back(point.displacement[d]);
          table.columns[3 + 2 * d].values.push_back(point.velocity[d]);
        }
      }
      if (!entry && !points.empty()) latest = std::max(latest, points.back().time);
      for (std::size_t c = 2; c < table.columns.size(); ++c)
        for (const double value : table.columns[c].values) extents[entry][int(c) + 1].include(value);
      figure.tables.push_back(std::move(table));
    }
  const double first = result.cases[static_cast<std::size_t>(result.shown_case)].exact.first_stick;
  // The exact motion as a thin line, algorithms as their steps.
  const auto curves = [&](bool entry, results::Cell x, results::Cell y) {
    std::vector<results::Line> list;
    for (std::size_t a = 0; a < result.shown.size(); ++a)
      list.push_back({.table = figure.tables[2 * a + (entry ? 1 : 0)].file,
                      .x = x,
                      .y = y,
                      .how = entry && a > 0 ? results::How::line_and_points : results::How::line,
                      .look = a == 0 ? results::Look{.colour = "#000000", .width = 1} : look_of(a - 1, 0.6),
                      .title = result.shown[a].name});
    return list;
  };
  const auto along = [&](const char* name, const char* unit, bool entry, int column) {
    return results::Axis{.name = name, .unit = unit, .shown = extents[entry][column]};
  };
  const results::Axis time{.name = "time", .unit = "s", .shown = {0, latest}};
  auto after = time;
  after.name = "time after the exact stick begins";
  after.shown = {};
  for (const auto& point : result.shown.front().entry) after.shown.include(point.time - first);
  results::Panel strips{.x = time, .y = {.name = "slip, and above it stick", .from = -0.3}};
  strips.y.to = double(result.shown.size());
  for (std::size_t a = 0; a < result.shown.size(); ++a) {
    strips.lines.push_back({.table = figure.tables[2 * a].file,
                            .y = {.column = 2, .factor = 0.7, .plus = double(a)},
                            .how = results::How::steps,
                            .look = a == 0 ? results::Look{.colour = "#000000", .width = 1} : look_of(a - 1, 0)});
    strips.y.ticks.push_back({double(a), result.shown[a].name});
  }
  const results::Cell since{.column = 1, .plus = -first};
  figure.panels = {
      {.x = time, .y = along("displacement", "m", false, 3), .lines = curves(false, {1}, {3}), .key = "top right"},
      std::move(strips),
      {.x = after, .y = along("velocity", "m/s", true, 4), .lines = curves(true, since, {4}), .key = "bottom right"},
      {.x = after, .y = along("displacement", "m", true, 3), .lines = curves(true, since, {3}), .key = "top right"}};
  auto files = output::write(folder, figure);
  if (scene.task<analysis::studies::StudyOptions>().dimensions == 2) {
    const results::Figure plane{.name = "study-path",
                                .what = "Path of one case in the plane",
                                .title = figure.title,
                                .panels = {{.x = along("x", "m", false, 3),
                                            .y = along("y", "m", false, 5),
                                            .lines = curves(false, {3}, {5}),
                                            .key = "top left"}},
                                .width = 640,
                                .height = 480,
                                .key = results::Key::own};
    for (auto& file : output::write(folder, plane)) files.push_back(std::move(file));
  }
  return files;
}

// ---------------------------------------------------------------- summary

void say(const StudyResult& result, double seconds) {
  print("{} cases in {:.3g} s; exact motions stick in {}, all algorithms in {}\n", result.cases.size(), seconds,
        result.exact_sticking_cases, result.common);
  print("{:<10} {:>8} {:>6} {:>6} {:>8} {:>6} | error e: {:>9} {:>9} {:>9} | {}\n", "", "sticking", "alone", "missed",
        "invented", "false", "mean", "median", "95 %", "Weibull shape, characteristic (likelihood)");
  for (const auto& a : result.algorithms) {
    const auto& e = a.smallest_error;
    print("{:<10} {:>8} {:>6} {:>6} {:>8} {:>6} |          {:>9.3g} {:>9.3g} {:>9.3g} | ", a.name, a.sticking_cases,
          a.alone, a.missed, a.invented, a.false_starts, e.mean, e.median, e.q95);
    if (a.weibull) {
      const auto& fit = a.weibull->likelihood;
      print("{:.3g} ({:.3g} … {:.3g}), {:.3g}", fit.fit.shape, fit.shape_interval[0], fit.shape_interval[1],
            fit.fit.characteristic);
    }
    print("\n");
  }
}

Status perform_study(Job& job) {
  const auto& request = job.request();
  auto& scene = job.scene();
  auto& study = scene.task<analysis::studies::StudyOptions>();
  const auto& folder = job.folder();
  study.threads = request.threads;
  job.explain("{} random oscillators by seed {}, each exactly and by {}, steps of 1/{} of the shortest period",
              study.cases, study.seed, fmt::join(study.algorithms, ", "), study.steps_per_period);
  const auto begin = std::chrono::steady_clock::now();
  StudyResult result;
  {
    Progress progress(request.quiet);
    const auto total = static_cast<std::size_t>(study.cases);
    result = analysis::studies::study(study, [&](int done) { progress.show(static_cast<std::size_t>(done), total); });
  }
  if (result.outcome.ending == Ending::interrupted)
    return stopped_early(request, "nothing is written after " + result.outcome.detail);
  const double seconds = seconds_since(begin);
  auto files = write_statistics(folder, scene, result);
  const auto shown = write_case(folder, scene, result);
  files.insert(files.end(), shown.begin(), shown.end());
  job.manifest().cost = {{"seconds", seconds}, {"threads", double(request.threads)}};
  if (!request.json && !request.quiet) say(result, seconds);
  auto whole = result_of(job, result);
  whole.cost = {
      {"seconds", seconds}, {"exact_seconds", result.exact_seconds}, {"algorithm_seconds", result.algorithm_seconds}};
  return job.finish(whole, std::move(files));
}

void read_study_table(scene::Table table, analysis::studies::StudyOptions& study) {
  if (const auto* dimensions = table.find("dimensions")) {
    study.dimensions = scene::count(*dimensions, table.path("dimensions"), 1, 2, "1 or 2");
    if (study.dimensions > 2)
      scene::fail(dimensions->source(), "study.dimensions = {} is outside 1 … 2", study.dimensions);
    if (study.dimensions == 2) study.window_threshold = 0.2751;
  }
  table.read("cases", study.cases, 1, 1'000'000, "random oscillators");
  int seed = 1;
  table.read("seed", seed, 0, scene::largest_seed, "of the random oscillators");
  study.seed = static_cast<std::uint64_t>(seed);
  if (const auto* names = table.find("algorithms")) {
    study.algorithms = scene::texts(*names, table.path("algorithms"));
    if (study.algorithms.empty()) scene::fail(names->source(), "study.algorithms is empty");
  }
  table.read("start_factor", study.start_factor, {"", "1", {1.000001, 1e6}, "start over where stick could hold"});
  table.read("duration_factor", study.duration_factor, {"", "1", {1e-3, 1e3}, "time in four decay times"});
  table.read("steps_per_period", study.steps_per_period, 600, 1'000'000, "steps of the shortest period");
  table.read("most_sticks", study.most_sticks, 1, 1'000'000, "sticks with which a motion ends");
  table.read("window_share", study.window_share, {"", "1", {1e-9, 1}, "window of o-fbfm over the average speed"});
  table.read("window_threshold", study.window_threshold,
             {"", "1", {1e-6, 1e6}, "threshold of the distribution of o-fbfm's errors"});
  table.read("show", study.show, 0, 1'000'000, "case whose motions are drawn");
  table.finish();
}

void read_study(scene::SceneReader& reader) {  // a study draws its own models
  read_study_table(scene::Table(reader.need("study", "cases, seed and algorithms"), "study"),
                   reader.scene.task<analysis::studies::StudyOptions>());
}

}  // namespace

Verb study_verb() {
  return {.name = "study",
          .help = "the published force algorithms against exact stick-slip over random oscillators",
          .example = "rosin study examples/stick-slip-study.toml --set study.cases=20",
          .operands = {scene_operand},
          .needs = {{"study", "cases, seed and algorithms"}},
          .options = scene_options(),
          .read = read_study,
          .perform = perform_study};
}

}  // namespace rosin::app::verbs
