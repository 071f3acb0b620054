/// Ways to a cycle and their errors.
#include "bench/cycles.hpp"

#include <cmath>

#include "analysis/cycles/return_map.hpp"
#include "analysis/lanes/cycle_lanes.hpp"

namespace bench {

rosin::oscillators::Model bristol_board(double N, double lambda) {
  rosin::oscillators::Model model;
  model.law = rosin::laws::find_law("spinodal");
  model.lambda = lambda;
  model.slider = {.mass = 1, .stiffness = 1.09, .damping = 0};
  model.drive = {.speed = 1e-5, .normal_load = N, .force = 0.0};
  return model;
}

Errors errors_of(const Reading& r, const Truth& t) {
  return {std::abs(r.period / t.value.period - 1), std::abs(r.stick_fraction - t.value.stick_fraction),
          std::abs(r.loop_area - t.value.loop_area) / t.loop_size};
}

void take(Row& row, const Reading& r, const Truth& truth) {
  if (!r.failure.empty() || r.steady)
    ++row.failures[r.failure.empty() ? "called steady, but a cycle exists" : r.failure];
  else
    row.errors.push_back(errors_of(r, truth));
}

namespace {

Reading reading_of(const rosin::analysis::cycles::Metrics& m) {
  Reading r;
  r.period = m.period, r.stick_fraction = m.stick_fraction, r.loop_area = m.loop_area;
  return r;
}

Reading rosin_cycle(const Truth& at, double tolerance) {
  const auto cycle = rosin::analysis::lanes::find_cycle(bristol_board(at.N, at.lambda),
                                                        rosin::analysis::lanes::every_metric(tolerance));
  Reading r = reading_of(cycle.metrics);
  if (!cycle.outcome.complete())
    r.failure = cycle.outcome.ending == rosin::Ending::tolerance_not_met ? "says that the tolerance is not met"
                                                                         : cycle.outcome.detail;
  return r;
}

/// rosin's integrator without Newton's method: passages until two successive ones agree, as the rivals do.
Reading rosin_transient(const Truth& at, double tolerance) {
  rosin::analysis::cycles::ReturnMap map(bristol_board(at.N, at.lambda));
  auto y = map.stick(map.drive_speed());
  Reading r;
  const Problem problem = at.problem();
  Passage last{};
  while (true) {
    const auto passage = map.follow(y, tolerance, 1, r.passages > 0);
    ++r.passages;
    if (!passage.outcome.complete()) {
      r.failure = passage.outcome.detail;
      return r;
    }
    y = passage.end;
    const auto seen = map.system().observe(0, y.data());
    const Passage current{passage.duration, seen.displacement, seen.state[0]};
    if (r.passages > 2 && agrees(problem, current, last, tolerance)) break;
    if (r.passages >= most_passages) {
      r.failure = "not settled in 200 passages";
      return r;
    }
    last = current;
  }
  rosin::analysis::cycles::Recorder recorder(map.system(), tolerance, 0.1, false);
  const auto passage = map.follow(y, tolerance, 1, true, rosin::analysis::cycles::Derivative::none, &recorder);
  const int passages = r.passages + 1;
  r = reading_of(recorder.finish(passage.duration));
  r.passages = passages;
  if (!passage.outcome.complete()) r.failure = passage.outcome.detail;
  return r;
}

}  // namespace

Truth truth_of(double N, double lambda, double tolerance) {
  const auto cycle = rosin::analysis::cycles::find_cycle(bristol_board(N, lambda), {.tolerance = tolerance});
  const auto& m = cycle.metrics;
  Truth t{N,
          lambda,
          reading_of(m),
          m.slip_rate_max * m.friction_max,
          reading_of(cycle.error),
          {cycle.section_displacement, Problem().V, 0}};
  if (!cycle.section_state.empty()) t.section.psi = cycle.section_state[0];
  if (!cycle.outcome.complete()) t.value.failure = cycle.outcome.detail;
  return t;
}

bool check(const Truth& truth, double tightest, Check& result, std::string& why) {
  const Problem p = truth.problem();
  std::vector<Reading> others;
  for (const double t : {tightest, 10 * tightest, 100 * tightest}) {
    const Reading r = run_cvode<Good>(p, t, truth.section, Search::follow, 4);
    if (r.failure.empty()) others.push_back(r);
    if (!r.failure.empty()) why = r.failure;
  }
  if (others.size() < 2) return false;
  Truth other = truth;
  other.value = others.front();
  result.between = errors_of(others.front(), truth);
  result.noise.assign(3, 0);
  for (const auto& r : others) {
    const Errors e = errors_of(r, other);
    for (int i = 0; i < 3; ++i) result.noise[i] = std::max(result.noise[i], e[i]);
  }
  return true;
}

std::vector<Solver> rosin_solvers() { return {{"rosin", rosin_cycle}, {"rosin, transient only", rosin_transient}}; }

std::vector<Solver> rivals() {
  std::vector<Solver> list;
  for (const Search search : {Search::follow, Search::accelerate}) {
    const std::string suffix = search == Search::follow ? "" : ", accelerated";
    const auto add = [&](const std::string& name, auto run) {
      list.push_back({name + suffix, [run, search](const Truth& t, double tolerance) {
                        const Problem p = t.problem();
                        return run(p, tolerance, near_stick(p), search);
                      }});
    };
    add("CVODE",
        [](const Problem& p, double r, const Start& s, Search how) { return run_cvode<Natural>(p, r, s, how); });
    add("CVODE, good variables",
        [](const Problem& p, double r, const Start& s, Search how) { return run_cvode<Good>(p, r, s, how); });
    add("ARKODE, good variables",
        [](const Problem& p, double r, const Start& s, Search how) { return run_arkode<Good>(p, r, s, how); });
    add("odeint rosenbrock4",
        [](const Problem& p, double r, const Start& s, Search how) { return run_rosenbrock<Natural>(p, r, s, how); });
    add("odeint, good variables",
        [](const Problem& p, double r, const Start& s, Search how) { return run_rosenbrock<Good>(p, r, s, how); });
  }
  return list;
}

std::vector<Row> sweep(const Solver& solver, const std::vector<Truth>& points, const std::vector<double>& tolerances,
                       const Settings& settings) {
  std::vector<Reading> readings(points.size());
  return sweep(
      solver.name, int(points.size()), tolerances, settings,
      [&](int i, double tolerance) { readings[i] = solver.solve(points[i], tolerance); },
      [&](int i, Row& row) { take(row, readings[i], points[i]); });
}

std::vector<Row> sweep_scipy(const SciPy& scipy, const std::string& method, const std::vector<Truth>& points,
                             const std::vector<double>& tolerances, int repetitions) {
  json problems = json::array();
  for (const auto& p : points) problems.push_back({p.N, p.lambda});
  return scipy.sweep("cycle", method, problems, tolerances, repetitions, [&](int i, const json& answer, Row& row) {
    Reading r;
    r.failure = answer["failure"];
    if (r.failure.empty())
      r.period = answer["period"], r.stick_fraction = answer["stick_fraction"], r.loop_area = answer["loop_area"],
      r.steady = answer["steady"];
    take(row, r, points[i]);
  });
}

}  // namespace bench
