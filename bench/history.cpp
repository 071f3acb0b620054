/// `rosin bench history`: QDYN's stick–slip case, which is not stiff in good variables, and stick and slip of the board
/// slider, which is stiff in any.
#include <cmath>
#include <optional>

#include "analysis/motion/run.hpp"
#include "bench/cycles.hpp"
#include "bench/history_rivals.hpp"
#include "oscillators/slider_system.hpp"
#include "solvers/steps/collocation.hpp"
#include "solvers/steps/explicit.hpp"

namespace bench {
namespace {

using rosin::oscillators::Model;
using rosin::oscillators::SliderSystem;

/// A history: how rosin is told of it, and how errors are read off.
struct History {
  Model model;
  rosin::analysis::motion::RunOptions options;  ///< start and duration
};

/// What is measured at the end, or why there is none.
struct End {
  std::vector<double> values;
  std::string failure = {};
};

template <class Solver>
End follow(const History& history, double tolerance) {
  const SliderSystem system(history.model);
  Solver solver(system, tolerance);
  rosin::solvers::steps::Collocation consistent(system, tolerance);
  if (!consistent.start(0, rosin::analysis::motion::starting_point(system, history.options.start)))
    return {{}, "no start"};
  solver.start(0, consistent.state());
  while (solver.time() < history.options.duration)
    if (const auto outcome = solver.step(history.options.duration); !outcome.complete())
      return {{}, name(outcome.ending)};
  const auto seen = system.observe(solver.time(), solver.state().data());
  return {{seen.displacement, seen.slip_rate, seen.friction_coefficient, seen.state[0]}};
}

End run_whole(const History& history, double tolerance) {
  auto options = history.options;
  options.tolerance = tolerance;
  options.samples = 1;
  const auto run = rosin::analysis::motion::run(history.model, options);
  if (run.columns[0].size() < 2) return {{}, name(run.outcome.ending)};
  // Short of its tolerance or not: the true error counts.
  return {{run.columns[0].back(), run.columns[2].back(), run.columns[4].back(), run.columns[5].back()}};
}

using Judge = std::function<Errors(const End&)>;  ///< of rosin's observation

class Table {
 public:
  Table(const Settings& settings) : settings_(settings) {}
  void add(const std::string& solver, const std::vector<double>& list, const std::function<End(double)>& solve,
           const Judge& judge) {
    End end;
    const auto more = sweep(
        solver, 1, list, settings_, [&](int, double tolerance) { end = solve(tolerance); },
        [&](int, Row& row) {
          if (!end.failure.empty())
            ++row.failures[end.failure];
          else if (const Errors e = judge(end); std::isfinite(*std::max_element(e.begin(), e.end())))
            row.errors.push_back(e);
          else
            ++row.failures["not finite"];
        });
    rows.insert(rows.end(), more.begin(), more.end());
  }
  template <class Form, class Follow>
  void add(const std::string& solver, const std::vector<double>& list, Follow follow,
           const typename Form::Setting& setting, const State<Form>& start, double duration, const Judge& judge) {
    add(
        solver, list,
        [&](double tolerance) {
          const auto arrival = follow(setting, start, duration, tolerance);
          return End{{arrival.y.begin(), arrival.y.end()}, arrival.failure};
        },
        judge);
  }
  std::vector<Row> rows;

 private:
  const Settings& settings_;
};

json finish(const Settings& settings, const std::vector<Row>& rows, const std::vector<std::string>& quantities,
            const std::string& what, const std::string& ours, double tolerance) {
  print(settings, rows, quantities);
  json part = {{"rows", as_json(rows, quantities)}};
  part["time_to_reach"] = times_to_reach(settings, rows, what);
  part["ratios"] = ratios(settings, rows, ours, tolerance, what);
  return part;
}

// ---------------------------------------------------------------- QDYN's case

json bench_fault(const Settings& settings, const SciPy& scipy, Record& record, std::vector<Row>& rows) {
  const Fault p;
  if (const double defect = fault_jacobian_defect(); defect > 1e-4)
    record.findings.push_back(
        fmt::format("the rivals' Jacobians of the fault differ from differences by {:.1e}", defect));
  History history;
  history.model.law = rosin::laws::find_law("ageing")->with({0.6, p.a, p.b, p.L, 1e-6});
  history.model.slider = {.mass = 0, .stiffness = p.k, .damping = p.c};
  history.model.drive = {.speed = p.V, .normal_load = p.N, .force = 0.0};
  history.options.duration = p.duration;
  history.options.start.kind = rosin::analysis::motion::Start::Kind::given;
  history.options.start.slip_rate = p.first_slip_rate;
  history.options.start.states["theta"] = p.first_age;

  // Reference: explicit order 8 in extended precision; collocation, which shares nothing with it, has to agree.
  const double reference = fault_reference(p, settings.quick ? 1e-16 : 1e-19);
  const double other = std::log(follow<rosin::solvers::steps::Collocation>(history, 1e-15).values[1]);
  const double allowed = settings.quick ? 1e-8 : 1e-10;
  say(settings,
      "History of a fault patch (QDYN's stick-slip case): ln v after {} s is {:.12f}; collocation differs by {:.1e}\n",
      p.duration, reference, std::abs(other - reference));
  if (!(std::abs(other - reference) < allowed) || !(std::abs(reference + 27.8503968) < 1e-7))
    record.findings.push_back(
        fmt::format("ln v = {:.12f} and {:.12f} by two ways, −27.8503968 is published", reference, other));

  Table table(settings);
  const Judge ours = [&](const End& e) { return Errors{std::abs(std::log(e.values[1]) - reference)}; };
  const Judge logarithmic = [&](const End& e) { return Errors{std::abs(e.values[0] - reference)}; };
  const Judge natural = [&](const End& e) { return Errors{std::abs(std::log(e.values[0]) - reference)}; };
  const auto list = tolerances(settings, 4, settings.quick ? 7 : 13);
  table.add(
      "rosin, whole run", tolerances(settings, 4, settings.quick ? 7 : 10),
      [&](double t) { return run_whole(history, t); }, ours);
  table.add(
      "rosin, explicit steps", list, [&](double t) { return follow<rosin::solvers::steps::Explicit>(history, t); },
      ours);
  table.add(
      "rosin, collocation", list, [&](double t) { return follow<rosin::solvers::steps::Collocation>(history, t); },
      ours);
  const auto good = LogarithmicFault::start<double>(p);
  const auto plain = NaturalFault::start<double>(p);
  table.add<NaturalFault>("CVODE", list, follow_cvode<NaturalFault>, p, plain, p.duration, natural);
  table.add<LogarithmicFault>("CVODE, good variables", list, follow_cvode<LogarithmicFault>, p, good, p.duration,
                              logarithmic);
  table.add<LogarithmicFault>("ARKODE, good variables", list, follow_arkode<LogarithmicFault>, p, good, p.duration,
                              logarithmic);
  table.add<LogarithmicFault>("odeint rosenbrock4", list, follow_rosenbrock<LogarithmicFault>, p, good, p.duration,
                              logarithmic);
  table.add<LogarithmicFault>("odeint dopri5", list, follow_dopri5<LogarithmicFault>, p, good, p.duration, logarithmic);
  for (const char* method : {"Radau", "LSODA"}) {
    const auto more =
        scipy.sweep("fault", method, json::array({{{"duration", p.duration}}}),
                    tolerances(settings, 4, settings.quick ? 4 : 11), 1, [&](int, const json& answer, Row& row) {
                      const std::string failure = answer["failure"];
                      if (failure.empty())
                        row.errors.push_back({std::abs(answer["log_slip_rate"].get<double>() - reference)});
                      else
                        ++row.failures[failure];
                    });
    table.rows.insert(table.rows.end(), more.begin(), more.end());
  }
  rows = table.rows;
  json part =
      finish(settings, rows, {"ln v"}, "History of a fault", "rosin, explicit steps", settings.quick ? 1e-7 : 1e-9);
  part["reference"] = reference;
  part["other_way"] = other;
  // The yardstick: an error of 1e-8 in ln v.
  const auto at = [&](const char* solver) { return time_at(rows, solver, 1e-8); };
  const auto user = at("odeint dopri5");
  for (const char* solver : {"rosin, explicit steps", "rosin, whole run", "rosin, collocation"}) {
    const auto mine = at(solver);
    if (*mine.relation == '>' || *user.relation == '>') continue;
    const double ratio = mine.microseconds / user.microseconds;
    say(settings, "ln v to 1e-8: {} in {:.3g} ms, {:.2f} of the time of odeint's dopri5 ({:.3g} ms)\n", solver,
        1e-3 * mine.microseconds, ratio, 1e-3 * user.microseconds);
    part["to_1e-8"][solver] = {{"microseconds", mine.microseconds}, {"over_dopri5", ratio}};
  }
  return part;
}

// ---------------------------------------------------------------- the board slider

json bench_slider(const Settings& settings, Record& record, std::vector<Row>& rows) {
  Problem p;
  p.N = 1e-3 * weight;
  p.lambda = 1;
  constexpr double duration = 600;  // s, several periods: ends in stick
  const Start start = near_stick(p);
  History history;
  history.model = bristol_board(p.N, p.lambda);
  history.options.duration = duration;
  auto& given = history.options.start;
  given.kind = rosin::analysis::motion::Start::Kind::given;
  given.displacement = start.x, given.slip_rate = start.v, given.states["psi"] = start.psi;

  // At the end: x in units of N a/k, μ in units of a, ln ψ. By collocation; ARKODE has to agree within its accuracy.
  const auto truth = follow<rosin::solvers::steps::Collocation>(history, 1e-16).values;
  const auto compare = [p](double x, double mu, double psi, const std::vector<double>& to) {
    return Errors{std::abs(x - to[0]) * p.k / (p.N * p.a), std::abs(mu - to[2]) / p.a, std::abs(std::log(psi / to[3]))};
  };
  const Judge ours = [&](const End& e) { return compare(e.values[0], e.values[2], e.values[3], truth); };
  const Judge natural = [&](const End& e) {
    return compare(e.values[0], p.friction(e.values[1], e.values[2]), e.values[2], truth);
  };
  const Judge good = [&](const End& e) {
    return compare(e.values[0], p.a * e.values[1], std::exp(e.values[2]), truth);
  };
  const auto from_natural = Natural::start(p, start.x, start.v, start.psi);
  const auto from_good = Good::start(p, start.x, start.v, start.psi);
  const auto other = follow_arkode<Good>(p, from_good, duration, settings.quick ? 1e-9 : 1e-11);
  const Errors apart = good({{other.y.begin(), other.y.end()}, {}});
  const double defect = *std::max_element(apart.begin(), apart.end());
  say(settings,
      "\nHistory of the board slider over {} s; ARKODE at its tightest differs from the reference by {:.1e}\n",
      duration, defect);
  if (!other.failure.empty() || !(defect < (settings.quick ? 1e-5 : 1e-7)))
    record.findings.push_back(fmt::format("the board slider's history differs by {:.1e} between two ways", defect));

  Table table(settings);
  const auto list = tolerances(settings, 4, settings.quick ? 7 : 12);
  table.add(
      "rosin, whole run", tolerances(settings, 4, settings.quick ? 7 : 10),
      [&](double t) { return run_whole(history, t); }, ours);
  table.add(
      "rosin, collocation", list, [&](double t) { return follow<rosin::solvers::steps::Collocation>(history, t); },
      ours);
  table.add<Natural>("CVODE", list, follow_cvode<Natural>, p, from_natural, duration, natural);
  table.add<Good>("CVODE, good variables", list, follow_cvode<Good>, p, from_good, duration, good);
  table.add<Good>("ARKODE, good variables", list, follow_arkode<Good>, p, from_good, duration, good);
  table.add<Natural>("odeint rosenbrock4", list, follow_rosenbrock<Natural>, p, from_natural, duration, natural);
  table.add<Good>("odeint, good variables", list, follow_rosenbrock<Good>, p, from_good, duration, good);
  table.add<Good>("odeint dopri5", list, follow_dopri5<Good>, p, from_good, duration, good);
  rows = table.rows;
  json part = finish(settings, rows, {"x", "mu", "ln psi"}, "History of the board slider", "rosin, collocation",
                     settings.quick ? 1e-7 : 1e-6);
  part["other_way"] = defect;
  return part;
}

}  // namespace

Record bench_history(const Settings& settings, const SciPy& scipy, const std::filesystem::path& curves) {
  Record record;
  std::vector<Row> rows;
  record.content["fault"] = bench_fault(settings, scipy, record, rows);
  auto second = curves;
  write_curves(curves, rows);
  record.content["slider"] = bench_slider(settings, record, rows);
  write_curves(second.replace_extension(".stiff.dat"), rows);
  record.panels = {
      {curves, "Fault patch, five earthquakes in 5000 s", "true error of ln v at the end", "processor time (s)"},
      {second, "Board slider, stick and slip over 600 s", "largest true error of x k/(N a), μ/a, ln ψ at the end",
       "processor time (s)"}};
  return record;
}

}  // namespace bench
