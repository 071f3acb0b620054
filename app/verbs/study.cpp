/// The verb study: random oscillators under every algorithm, their statistics, tables and pictures.

#include "analysis/studies/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "app/output/gnuplot.hpp"
#include "app/output/sheet.hpp"
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

/// Weibull plot, shares, boxes and back-steps.
std::vector<std::string> write_statistics(const fs::path& folder, const scene::Scene& scene,
                                          const StudyResult& result) {
  std::string data = "algorithm,error,distance,weibull,share\n";
  const output::Sheet sheet{
      "study",
      "Errors of the force algorithms over random oscillators",
      {.width = 980, .panels = 4, .columns = 2, .panel = 290, .between_rows = 80, .key = output::Layout::Key::own},
      scene.title};
  std::string script = "set grid\n";
  std::vector<std::string> weibull, lines, shares, boxes, labels;
  int most_back_steps = 0;
  for (std::size_t a = 0; a < result.algorithms.size(); ++a) {
    const auto& found = result.algorithms[a];
    const auto errors = errors_of(result, a);
    if (errors.empty()) continue;
    const double threshold =
        found.name == "o-fbfm" ? scene.task<analysis::studies::StudyOptions>().window_threshold : 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const double p = (double(i) + 0.7) / (double(errors.size()) + 0.4);
      data += fmt::format("{},{},{},{},{}\n", a, errors[i], std::abs(errors[i] - threshold), -std::log1p(-p), 100 * p);
    }
    const int style = static_cast<int>(a % 5) + 1;
    const auto title = output::single_quoted(found.name);
    const auto of = [&](int column) { return fmt::format("'study-errors.csv' using ($1=={}?${}:NaN)", a, column); };
    weibull.push_back(fmt::format("{}:4 with points linestyle {} pointtype {} pointsize 0.5 title {}", of(3), style,
                                  4 + 2 * a, title));
    if (found.weibull) {
      const auto& fit = found.weibull->likelihood.fit;
      lines.push_back(fmt::format("(x/{})**({}) with lines linestyle {} notitle",
                                  std::abs(fit.characteristic - fit.threshold), fit.shape, style));
    }
    shares.push_back(fmt::format("{}:5 with linespoints linestyle {} pointtype {} pointsize 0.3 title {}", of(2), style,
                                 4 + 2 * a, title));
    boxes.push_back(fmt::format("'study-errors.csv' using ({}):($1=={}?$2:NaN) with boxplot linestyle {} notitle",
                                a + 1, a, style));
    labels.push_back(fmt::format("{} {}", title, a + 1));
    for (std::size_t n = 1; n < found.back_steps.size(); ++n)
      most_back_steps = std::max(most_back_steps, found.back_steps[n]);
  }
  write_whole(folder / "study-errors.csv", data);
  if (weibull.empty()) return {"study-errors.csv"};
  weibull.insert(weibull.end(), lines.begin(), lines.end());
  script += fmt::format(
      "set logscale xy\nset format xy '10^{{%T}}'\nset yrange [1e-3:10]\n"
      "set xlabel 'distance from the threshold, |e - e_0|'\nset ylabel '-ln R, R the share of cases above e'\n"
      "set key top left\nplot {}\n",
      fmt::join(weibull, ", \\\n     "));
  script += fmt::format(
      "unset logscale y\nset format y '%g'\nset yrange [0:100]\nset xlabel 'error e, slip rate in stick over 0.001 "
      "average speed'\n"
      "set ylabel 'share of cases below (%)'\nset xrange [1e-6:10]\nplot {}\n",
      fmt::join(shares, ", \\\n     "));
  script += fmt::format(
      "unset logscale x\nset logscale y\nset format x '%g'\nset format y '10^{{%T}}'\nset yrange [1e-7:10]\n"
      "set xrange [0.3:{}]\nset xtics ({})\nset xlabel ''\nset ylabel 'error e'\nset style fill empty\n"
      "set boxwidth 0.5\nset style boxplot range 1.5 outliers pointtype 6\nplot {}\n",
      double(labels.size()) + 0.7, fmt::join(labels, ", "), fmt::join(boxes, ", \\\n     "));
  std::string steps = "steps";
  for (const auto& found : result.algorithms) steps += "," + found.name;
  for (std::size_t n = 0; n < 10; ++n) {
    steps += fmt::format("\n{}", n);
    for (const auto& found : result.algorithms) steps += fmt::format(",{}", found.back_steps[n]);
  }
  write_whole(folder / "study-back-steps.csv", steps + "\n");
  std::vector<std::string> bars;
  for (std::size_t a = 0; a < result.algorithms.size(); ++a)
    if (std::any_of(result.algorithms[a].back_steps.begin() + 1, result.algorithms[a].back_steps.end(),
                    [](int n) { return n > 0; }))
      bars.push_back(fmt::format("'study-back-steps.csv' every ::1 using 1:{} with boxes linestyle {} title {}", a + 2,
                                 a % 5 + 1, output::single_quoted(result.algorithms[a].name)));
  if (!bars.empty())
    script += fmt::format(
        "unset logscale y\nset format y '%g'\nset yrange [0:*]\nset xrange [-0.5:9.5]\n"
        "set xtics (0, 1, 2, 3, 4, 5, 6, 7, 8, '9+' 9)\nset xlabel 'steps back at the first stick'\nset ylabel "
        "'cases'\n"
        "set key top right\nset style fill solid 0.4\nplot {}\n",
        fmt::join(bars, ", "));
  write_whole(folder / "study.gp", sheet.with(std::move(script)));
  return {"study-errors.csv", "study-back-steps.csv", "study.gp"};
}

/// The response of one case with its strip, and every step around the entry into its first stick.
std::vector<std::string> write_case(const fs::path& folder, const scene::Scene& scene, const StudyResult& result) {
  if (result.shown.empty()) return {};
  std::vector<std::string> files;
  for (const auto& motion : result.shown)
    for (const bool entry : {false, true}) {
      const auto& points = entry ? motion.entry : motion.whole;
      std::string text = "time (s),stick";
      for (std::size_t d = 0; !points.empty() && d < points[0].displacement.size(); ++d)
        text += fmt::format(",displacement_{0} (m),velocity_{0} (m/s)", d + 1);
      text += '\n';
      for (const auto& point : points) {
        text += fmt::format("{},{}", point.time, point.stick ? 1 : 0);
        for (std::size_t d = 0; d < point.displacement.size(); ++d)
          text += fmt::format(",{},{}", point.displacement[d], point.velocity[d]);
        text += '\n';
      }
      files.push_back(fmt::format("study-{}-{}.csv", entry ? "entry" : "motion", motion.name));
      write_whole(folder / files.back(), text);
    }
  const auto curves = [&](std::string_view which, std::string_view columns, std::string_view how) {
    std::vector<std::string> list;
    for (std::size_t a = 0; a < result.shown.size(); ++a)
      list.push_back(fmt::format("'study-{}-{}.csv' using {} with {} linestyle {}{} title {}", which,
                                 result.shown[a].name, columns, a == 0 ? "lines" : how, a == 0 ? 6 : (a - 1) % 5 + 1,
                                 a == 0 || how == "lines" ? "" : fmt::format(" pointtype {} pointsize 0.6", 4 + 2 * a),
                                 output::single_quoted(result.shown[a].name)));
    return fmt::format("{}", fmt::join(list, ", \\\n     "));
  };
  const double first = result.cases[static_cast<std::size_t>(result.shown_case)].exact.first_stick;
  const auto title = fmt::format("{}, case {}", scene.title, result.shown_case);
  const output::Sheet sheet{
      "study-case",
      "One case: response, strip of stick and slip, and entry into stick",
      {.width = 980, .panels = 4, .columns = 2, .panel = 320, .between_rows = 80, .key = output::Layout::Key::own},
      title};
  std::string script = "set grid\n";
  script += "set style line 6 linecolor '#000000' linewidth 1\n";
  script += "set xlabel 'time (s)'\nset ylabel 'displacement (mm)'\nset key top right\nplot " +
            curves("motion", "1:($3*1e3)", "lines") + "\n";
  std::vector<std::string> strips, tics;
  for (std::size_t a = 0; a < result.shown.size(); ++a) {
    strips.push_back(fmt::format("'study-motion-{}.csv' using 1:($2*0.7+{}) with steps linestyle {} notitle",
                                 result.shown[a].name, a, a == 0 ? 6 : (a - 1) % 5 + 1));
    tics.push_back(fmt::format("{} {}", output::single_quoted(result.shown[a].name), a));
  }
  script += fmt::format("set ylabel 'slip, and above it stick'\nset ytics ({})\nset yrange [-0.3:{}]\nplot {}\n",
                        fmt::join(tics, ", "), result.shown.size(), fmt::join(strips, ", \\\n     "));
  script += fmt::format(
      "set ytics autofreq\nset yrange [*:*]\nset xlabel 'time after the exact stick begins (ms)'\n"
      "set ylabel 'velocity (mm/s)'\nset key bottom right\nplot {}\n",
      curves("entry", fmt::format("(($1-{})*1e3):($4*1e3)", first), "linespoints"));
  script += fmt::format("set ylabel 'displacement (mm)'\nset format y '%.6g'\nset key top right opaque\nplot {}\n",
                        curves("entry", fmt::format("(($1-{})*1e3):($3*1e3)", first), "linespoints"));
  if (scene.task<analysis::studies::StudyOptions>().dimensions == 2) {
    const output::Sheet plane{"study-path", "Path of one case in the plane", {.width = 640, .panel = 480}, title};
    write_whole(folder / "study-path.gp",
                plane.with(fmt::format("set style line 6 linecolor '#000000' linewidth 1\nset key top "
                                       "left\nset xlabel 'x (mm)'\nset ylabel 'y (mm)'\nset "
                                       "grid\nplot {}\n",
                                       curves("motion", "($3*1e3):($5*1e3)", "lines"))));
    files.emplace_back("study-path.gp");
  }
  write_whole(folder / "study-case.gp", sheet.with(std::move(script)));
  files.emplace_back("study-case.gp");
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
