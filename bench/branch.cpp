/// `rosin bench branch`: branches of cycles from their Hopf point on, and round a fold, beside AUTO-07p.
#include <algorithm>
#include <bench_scripts.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "analysis/branches/branches.hpp"
#include "bench/rows.hpp"
#include "core/files.hpp"
#include "core/process.hpp"
#include "laws/catalogue.hpp"

namespace bench {
namespace {

using namespace rosin;
using namespace rosin::analysis;

/// The slider on board, steady sliding and cycles along one parameter.
struct Along {
  const char *name, *path;
  double lambda, load, speed;  ///< from where AUTO looks for its Hopf point
  branches::ParameterScale range;
  bool has_fold;
  std::vector<double> values;  ///< at which cycles are wanted

  oscillators::Model model() const {
    oscillators::Model model;
    model.law = laws::preset(*laws::find_law("spinodal"), "bristol-board");
    model.lambda = lambda;
    model.slider = {1, 1.09, 0};
    model.drive.normal_load = load, model.drive.speed = speed;
    return model;
  }
};

struct Cycle {
  double value, period;  ///< of the parameter; s
};
struct Found {
  double hopf = NAN, fold = NAN;
  std::vector<Cycle> cycles;
  double hopf_error = 0, fold_error = 0, period_error = 0;  ///< stated, relative
  std::size_t points = 0;
};

Found follow(const Along& problem, double tolerance, std::vector<double> values) {
  const auto model = problem.model();
  const branches::Family family = [&](double p) { return branches::oscillator_of(model.with(problem.path, p)); };
  const auto all = branches::from_steady_sliding(
      family, {.parameter = problem.range, .tolerance = tolerance, .at = std::move(values)},
      branches::crossings_of(model, problem.path, problem.range));
  Found found;
  found.points = all.steady.size();
  if (!all.crossings.empty())
    found.hopf = all.crossings.front().value, found.hopf_error = all.crossings.front().error / found.hopf;
  for (const auto& [from, value, parent, to_value, branch] : all.cycles) {
    found.points += branch.points.size();
    for (const auto& point : branch.points)
      if (point.asked) {
        found.cycles.push_back({point.p, point.view.metrics.at("period")});
        found.period_error = std::max(found.period_error, point.x_error);
      }
    for (const auto& special : branch.special)
      if (special.kind == "fold") found.fold = special.p, found.fold_error = special.error / special.p;
  }
  return found;
}

/// A cycle that is wanted; its period may be asked for close by, where a program puts the value that was wanted.
struct Wanted {
  double value, period, exponent;  ///< d ln period/d ln value
  double at(double near) const { return period * std::pow(near / value, exponent); }
};
struct Truth {
  double hopf, fold;
  std::vector<Wanted> cycles;
};

Truth truth_of(const Along& problem, double tolerance) {
  constexpr double apart = 1e-4;
  std::vector<double> values = problem.values;
  for (const double value : problem.values) values.push_back(value * (1 + apart));
  const auto found = follow(problem, tolerance, values);
  Truth truth{found.hopf, found.fold, {}};
  for (const auto& here : found.cycles)
    for (const auto& there : found.cycles)
      if (std::abs(there.value / here.value - 1 - apart) < 1e-9 && std::abs(there.period / here.period - 1) < 0.01)
        truth.cycles.push_back(
            {here.value, here.period, std::log(there.period / here.period) / std::log(there.value / here.value)});
  return truth;
}

/// Errors of the Hopf point, of the fold and of the worst period; a cycle that is missing is a failure.
void judge(const Truth& truth, const Found& found, Row& row) {
  double worst = 0;
  for (const auto& wanted : truth.cycles) {
    double least = INFINITY;
    for (const auto& [value, period] : found.cycles)
      if (std::abs(value / wanted.value - 1) < 1e-3) least = std::min(least, std::abs(period / wanted.at(value) - 1));
    worst = std::max(worst, least);
  }
  const bool has_fold = std::isfinite(truth.fold);
  if (!(worst < 0.01))
    ++row.failures["cycles passed over"];
  else if (!std::isfinite(found.hopf) || (has_fold && !std::isfinite(found.fold)))
    ++row.failures["Hopf point or fold passed over"];
  else
    row.errors.push_back(
        {std::abs(found.hopf / truth.hopf - 1), has_fold ? std::abs(found.fold / truth.fold - 1) : 0, worst});
}

/// AUTO-07p where it is installed, each mesh a row, whose tolerance is one over its intervals.
std::vector<Row> ask_auto(const Settings& settings, const std::vector<Along>& problems,
                          const std::vector<Truth>& truths) {
  const auto program = find_program("auto-07p"), compiler = find_program("gfortran");
  if (!program || !compiler) {
    say(settings, "AUTO-07p: {} not found, left out\n", program ? "gfortran" : "auto-07p");
    return {};
  }
  const TemporaryFolder folder(std::filesystem::temp_directory_path());
  json task{{"repetitions", settings.quick ? 1 : 3}, {"meshes", json::array()}, {"branches", json::array()}};
  for (const int intervals : settings.quick ? std::vector<int>{100} : std::vector<int>{50, 70, 100, 200, 400})
    task["meshes"].push_back({intervals, 4});
  if (!settings.quick) task["meshes"].push_back({100, 7}), task["meshes"].push_back({200, 7});
  for (const auto& problem : problems) {
    task["branches"].push_back({{"name", problem.name},
                                {"from", problem.range.from},
                                {"to", problem.range.to},
                                {"fold", problem.has_fold},
                                {"values", problem.values}});
    std::string equations = auto_equations;
    const std::string start = "START";
    equations.replace(equations.find(start), start.size(),
                      fmt::format("{:.16f}D0, {:.16f}D0, {:.16f}D0", problem.load, problem.lambda, problem.speed));
    write_whole(folder.path() / fmt::format("{}.f90", problem.name), equations);
  }
  write_whole(folder.path() / "job.json", task.dump());
  write_whole(folder.path() / "board.auto", auto_script);
  progress(settings, "AUTO-07p");
  // AUTO takes the first Python of PATH; its threads slow problems of this size down.
  const char* path = std::getenv("PATH");
  const auto ran = run_program(
      {*program,
       {"board.auto"},
       folder.path(),
       {fmt::format("PATH={}:{}", std::filesystem::path(settings.python).parent_path().string(), path ? path : ""),
        "OMP_NUM_THREADS=1"}});
  std::ifstream answer(folder.path() / "answer.json");
  if (!ran || !answer) {
    tell("AUTO-07p is left out: {}\n", ran ? ran->messages : "it cannot be started");
    return {};
  }
  const auto found = json::parse(answer);
  std::vector<Row> rows;
  for (std::size_t m = 0; m < found.size(); ++m) {
    const int intervals = task["meshes"][m][0], points = task["meshes"][m][1];
    Row row{fmt::format("AUTO-07p, {} points an interval", points), 1.0 / intervals};
    row.asked = int(problems.size());
    std::vector<std::string> sizes;
    for (std::size_t i = 0; i < problems.size(); ++i) {
      ++row.tried;
      const auto& told = found[m][i];
      if (told.contains("failure")) {
        ++row.failures[told["failure"]];
        continue;
      }
      row.seconds += told["seconds"].get<double>();
      sizes.push_back(std::to_string(told["points"].get<int>()));
      Found of_auto;
      of_auto.hopf = told["hopf"];
      for (const auto& cycle : told["cycles"]) of_auto.cycles.push_back({cycle[0], cycle[1]});
      if (!told["folds"].empty()) of_auto.fold = told["folds"][0][0];
      judge(truths[i], of_auto, row);
    }
    row.note = fmt::format("{} intervals, {} points", intervals, fmt::join(sizes, " and "));
    rows.push_back(std::move(row));
  }
  keep(settings, rows);
  return rows;
}

}  // namespace

Record bench_branch(const Settings& settings, const SciPy&, const std::filesystem::path& curves) {
  const std::vector<Along> problems = {
      {"load", "drive.normal_load", 10, 1e-4, 1e-5, {1e-4, 1e-2, true}, false, {5e-4, 1e-3, 2e-3, 5e-3}},
      {"speed", "drive.speed", 1, 9.81e-2, 3e-4, {4e-4, 5e-3, true}, true, {1e-3, 1.25e-3}}};
  Record record;
  progress(settings, "reference");
  std::vector<Truth> truths;
  for (const auto& problem : problems) truths.push_back(truth_of(problem, settings.quick ? 1e-9 : 1e-11));
  // The Hopf point in closed form; the fold of AUTO-07p 0.9.2, on which its meshes of 200 x 4 and finer agree.
  constexpr double hopf = 4.087751405677e-4, fold = 2.386858673594e-3;
  if (std::abs(truths[0].hopf / hopf - 1) > 1e-12 || std::abs(truths[1].fold / fold - 1) > 1e-10)
    record.findings.push_back(fmt::format("Hopf point {:.13g} N is not {:.13g} N, or fold {:.13g} m/s not {:.13g} m/s",
                                          truths[0].hopf, hopf, truths[1].fold, fold));
  if (truths[0].cycles.size() != 4 || truths[1].cycles.size() != 4)
    record.findings.push_back("the reference lacks cycles");

  std::vector<Row> rows;
  std::vector<Found> found(problems.size());
  const auto solve = [&](int i, double tolerance) { found[i] = follow(problems[i], tolerance, problems[i].values); };
  for (auto& row : sweep("rosin", int(problems.size()), tolerances(settings, 4, settings.quick ? 7 : 10), settings,
                         solve, [&](int i, Row&row) {
                           judge(truths[i], found[i], row);
                           if (i == 0) row.note.clear();
                           row.note += fmt::format("{}{} points", i ? " and " : "", found[i].points);
                           if (row.errors.empty()) return;
                           const auto& error = row.errors.back();
                           row.understated += error[0] > found[i].hopf_error + 1e-14 ||
                                              error[1] > found[i].fold_error + 1e-11 ||
                                              error[2] > found[i].period_error + 1e-11;
                         }))
    rows.push_back(std::move(row));
  auto of_auto = ask_auto(settings, problems, truths);
  const bool had_auto = !of_auto.empty();
  for (auto& row : of_auto) rows.push_back(std::move(row));
  const std::vector<std::string> quantities = {"Hopf point", "fold", "period"};
  print(settings, rows, quantities);
  record.content = {{"rows", as_json(rows, quantities)}, {"auto", had_auto}};
  record.content["time_to_reach"] = times_to_reach(settings, rows, "Both branches");
  write_curves(curves, rows);
  record.panels = {{curves, "Branches of cycles of the board slider, over load and over speed",
                    "largest true error of Hopf point, fold, periods (relative)", "processor time per branch (s)"}};
  return record;
}

}  // namespace bench
