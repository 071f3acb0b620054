/// `rosin bench stick-slip`: closed form, event-driven integrators and the published force algorithms at equal error.
#include <cmath>

#include "analysis/motion/run.hpp"
#include "bench/rows.hpp"
#include "bench/stick_slip_rivals.hpp"
#include "laws/catalogue.hpp"
#include "solvers/force_algorithms/force_algorithms.hpp"
#include "solvers/stick_slip/exact.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace bench {
namespace {

using namespace rosin;
namespace algorithms = solvers::force_algorithms;

// Seven cases with two to eighteen sticks in two seconds, those of docs/force-algorithms.md.
constexpr StickSlip cases[] = {
    {1, 400, 1, 0.4, 0.23, 0.1, 9.8, 5, 3, 15, 10}, {1, 400, 1, 0.4, 0.23, 0.1, 9.8, 0, 3, 15, 10},
    {1, 400, 1, 0.3, 0.3, 0.1, 9.8, 5, 3, 15, 10},  {1, 400, 1, 0.4, 0.23, 0.1, 9.8, 8, 3, 120, 10},
    {1, 400, 1, 0.6, 0.3, 0.05, 9.8, 3, 6, 4, 1.5}, {1, 900, 1, 0.45, 0.3, 0.02, 9.8, 9.5, 5, 60, 10},
    {1, 400, 1, 0.4, 0.25, 0.1, 9.8, 5, 2, 15, 10}};
constexpr int count = static_cast<int>(std::size(cases));

Signal load_of(const StickSlip& p) { return Signal(Signal::Harmonics{p.Nc, {{p.Nv, p.wn, 0}}}); }
Signal force_of(const StickSlip& p) { return Signal(Signal::Harmonics{0, {{p.P, p.we, 0}}}); }

template <class Real>
Displacements exactly(const StickSlip& p) {
  solvers::stick_slip::Exact<Real> exact({p.m, p.k, p.c, p.mus, p.muk, 0, 0.0, load_of(p), force_of(p)});
  exact.start(0, p.x0, 0);
  Displacements found;
  for (int i = 0; i < sample_count; ++i) {
    const double t = sample_interval * (i + 1);
    while (exact.time() < t) exact.advance(sample_interval * sample_count);
    found.x[static_cast<std::size_t>(i)] = double(exact.at(t).displacement);
  }
  return found;
}

/// Smooth pieces by collocation with located switches, one pass.
Displacements by_events(const StickSlip& p, double tolerance) {
  oscillators::Model model;
  model.law = laws::find_law("coulomb")->with({p.mus, p.muk});
  model.slider = {p.m, p.k, p.c};
  model.drive = {0.0, load_of(p), force_of(p)};
  oscillators::SliderSystem system(model);
  solvers::stick_slip::StickSlip solver(system, tolerance);
  analysis::motion::Start start;
  start.kind = analysis::motion::Start::Kind::given;
  start.displacement = p.x0, start.velocity = 0.0;
  solver.start(0, analysis::motion::starting_point(system, start));
  Displacements found;
  for (int i = 0; i < sample_count; ++i) {
    while (solver.time() < sample_interval * (i + 1)) {
      solvers::stick_slip::Switch switched;
      const auto outcome = solver.step(sample_interval * (i + 1), switched);
      if (!outcome.complete()) return {{}, name(outcome.ending)};
    }
    found.x[static_cast<std::size_t>(i)] = solver.state()[0];
  }
  return found;
}

/// `step`: in units of the shortest period, rounded so that samples are step ends.
Displacements by_algorithm(const char* name, const StickSlip& p, double step) {
  const algorithms::DryMass<1> mass{p.m, {p.k}, {p.c}, p.mus, p.muk, {0}, load_of(p), {force_of(p)}};
  algorithms::Options options;
  const double wanted = 1000 * step * algorithms::step_of(mass, options);
  const auto every = static_cast<std::size_t>(std::ceil(sample_interval / wanted));
  options.step = sample_interval / double(every);
  options.window = 0.1 * p.x0 * std::sqrt(p.k / p.m) * step;  // shrinks with the step
  Displacements found;
  try {
    algorithms::check(name, mass, options);
  } catch (const InputError&) {
    return {{}, "unstable step"};
  }
  const algorithms::Forcing<1> forcing(mass, options.step, every * sample_count);
  const auto track = algorithms::follow<1>(name, mass, forcing, options, {p.x0}, {0});
  std::size_t n = 0;
  for (int i = 0; i < sample_count; ++i) {
    const double t = sample_interval * (i + 1);
    while (n + 1 < track.points.size() && track.points[n].time < t * (1 - 1e-12)) ++n;
    // Steps after an event are not on the grid of samples: the cubic through places and velocities.
    const auto &a = track.points[n == 0 ? 0 : n - 1], &b = track.points[n];
    const double h = b.time - a.time, q = h > 0 ? std::min(1.0, (t - a.time) / h) : 1, r = 1 - q;
    found.x[static_cast<std::size_t>(i)] =
        r * r * (1 + 2 * q) * a.x[0] + q * q * (1 + 2 * r) * b.x[0] + q * r * h * (r * a.v[0] - q * b.v[0]);
  }
  return found;
}

}  // namespace

Record bench_stick_slip(const Settings& settings, const SciPy&, const std::filesystem::path& curves) {
  Record record;
  std::vector<Displacements> truth;
  for (const auto& p : cases) truth.push_back(exactly<long double>(p));
  std::vector<Row> rows;
  std::vector<Displacements> found(count);
  const auto add = [&](const std::string& solver, const std::vector<double>& list,
                       const std::function<Displacements(const StickSlip&, double)>& solve) {
    const auto more = sweep(
        solver, count, list, settings, [&](int i, double tolerance) { found[i] = solve(cases[i], tolerance); },
        [&](int i, Row& row) {
          double worst = 0;
          for (int k = 0; k < sample_count; ++k)
            worst = std::max(worst, std::abs(found[i].x[k] - truth[i].x[k]) / cases[i].x0);
          if (!found[i].failure.empty())
            ++row.failures[found[i].failure];
          else if (std::isfinite(worst))
            row.errors.push_back({worst});
          else
            ++row.failures["not finite"];
        });
    rows.insert(rows.end(), more.begin(), more.end());
  };
  const auto list = tolerances(settings, 4, 12);
  add("rosin, closed form", {1e-15}, [](const StickSlip& p, double) { return exactly<double>(p); });
  add("rosin, events", list, by_events);
  add("CVODE Adams", list, [](const StickSlip& p, double t) { return follow_cvode_events(p, true, t); });
  add("CVODE BDF", list, [](const StickSlip& p, double t) { return follow_cvode_events(p, false, t); });
  add("meijaard", tolerances(settings, 1, 4),
      [](const StickSlip& p, double h) { return by_algorithm("meijaard", p, h); });
  for (const char* name : {"cfm", "o-fbfm", "r-fbfm", "aabg-sdfm", "tr-sdfm"})
    add(name, tolerances(settings, 3, settings.quick ? 4 : 5),
        [name](const StickSlip& p, double h) { return by_algorithm(name, p, h); });
  // CVODE shares nothing with the closed form: where it is tight they agree.
  for (const auto& row : rows)
    if (row.solver == "CVODE Adams" && row.tolerance <= 1e-8 && !(row.quantile(1) < 1e-4))
      record.findings.push_back(fmt::format("CVODE at {:.0e} differs from the closed form by {:.1e} of the start",
                                            row.tolerance, row.quantile(1)));
  say(settings, "Seven cases of stick-slip over {} s, largest error of eight displacements over the start\n",
      sample_interval * sample_count);
  print(settings, rows, {"x/x0"});
  record.content = {{"rows", as_json(rows, {"x/x0"})}};
  record.content["time_to_reach"] = times_to_reach(settings, rows, "A case of stick-slip");
  const auto exact = time_at(rows, "rosin, closed form", 1e-14);
  for (const char* solver : {"CVODE Adams", "meijaard", "tr-sdfm"})
    for (const double error : {1e-3, 1e-4, 1e-6, 1e-8}) {
      const auto other = time_at(rows, solver, error);
      if (*other.relation == '>') continue;
      const double ratio = other.microseconds / exact.microseconds;
      say(settings, "{} to {:.0e}: {:.3g} ms, {:.3g} times the closed form's\n", solver, error,
          1e-3 * other.microseconds, ratio);
      record.content["over_closed_form"][solver][fmt::format("{:.0e}", error)] = ratio;
    }
  write_curves(curves, rows);
  record.panels = {{curves, "Stick-slip: seven cases, two to eighteen sticks in 2 s",
                    "largest true error of eight displacements over the start, met by nine cases in ten",
                    "processor time per case (s)"}};
  return record;
}

}  // namespace bench
