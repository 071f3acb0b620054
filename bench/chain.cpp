/// `rosin bench chain`: what a step costs in chains of 50 to 1000 blocks, and CVODE with a banded Jacobian beside it.
#include <cmath>

#include "bench/chain_rivals.hpp"
#include "bench/rows.hpp"
#include "laws/adapter.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/structure_system.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace bench {

using namespace rosin;

/// Friction that falls with the slip rate and turns over within v0: Coulomb's law without stick.
template <class Real = double>
struct SmoothFriction {
  static constexpr Card card{"smooth", "SmoothFriction friction that falls with the slip rate",
                             R"(\Bigl(\mu_d + \frac{\mu_s - \mu_d}{1 + (v/v_1)^2}\Bigr)\frac{v}{\sqrt{v^2 + v_0^2}})",
                             "none", "a bench"};
  Real mu_s = 0.6, mu_d = 0.4, v0 = 0.01, v1 = 0.1;
  static constexpr auto parameters =
      table(field(&SmoothFriction::mu_s, "mu_s", "1", {0, 10}, "slow friction"),
            field(&SmoothFriction::mu_d, "mu_d", "1", {0, 10}, "fast friction"),
            field(&SmoothFriction::v0, "v0", "m/s", {1e-12, 1e3}, "speed within which friction turns over"),
            field(&SmoothFriction::v1, "v1", "m/s", {1e-12, 1e3}, "speed over which friction falls"));
  Real friction(Sliding<Real> at) const {
    const Real v = at.slip_rate, part = v / v1;
    return (mu_d + (mu_s - mu_d) / (1.0 + part * part)) * v / sqrt(v * v + v0 * v0);
  }
};

namespace {

namespace stick_slip = solvers::stick_slip;

ChainProblem problem_of(int blocks) {
  ChainProblem problem;
  for (int i = 0; i < blocks; ++i) problem.start.push_back(0.3 + 0.2 * std::sin(2.3 * i) + 0.1 * std::sin(0.11 * i));
  problem.duration = std::min(4.0, 200.0 / blocks);  // friction turns over in some block all the time
  return problem;
}

oscillators::Structure chain_of(const ChainProblem& p, std::shared_ptr<const FrictionLaw> law) {
  const std::size_t n = p.start.size();
  oscillators::FrictionContact contact;
  contact.law = std::move(law);
  contact.speed = p.speed;
  return oscillators::chain({.mass = std::vector<double>(n, 1.0),
                             .coupling_stiffness = std::vector<double>(n - 1, p.coupling),
                             .coupling_damping = std::vector<double>(n - 1, 0.0),
                             .pull_stiffness = std::vector<double>(n, p.pull),
                             .pull_damping = std::vector<double>(n, 0.0)},
                            std::vector<oscillators::FrictionContact>(n, contact));
}

std::vector<double> start_of(const oscillators::StructureSystem& system, const ChainProblem& p) {
  const auto n = Eigen::Index(p.start.size());
  return system.unknowns_at(0, Eigen::Map<const Eigen::VectorXd>(p.start.data(), n),
                            Eigen::VectorXd::Constant(n, p.speed));
}

ChainMotion follow(oscillators::StructureSystem& system, const ChainProblem& p, double tolerance) {
  stick_slip::StickSlip solver(system, tolerance);
  if (!solver.start(0, start_of(system, p))) return {{}, 0, "no start"};
  stick_slip::Switch switched;
  while (solver.time() < p.duration)
    if (const auto outcome = solver.step(p.duration, switched); !outcome.complete())
      return {{}, 0, name(outcome.ending)};
  return {{solver.state().begin(), solver.state().begin() + long(p.start.size())}, solver.stepper().count().steps, ""};
}

/// Processor time of a step (s), the mean of many from the start on.
double time_of_step(oscillators::StructureSystem& system, const ChainProblem& p, double tolerance, int steps,
                    long& switches) {
  stick_slip::StickSlip solver(system, tolerance);
  solver.start(0, start_of(system, p));
  switches = 0;
  const double begin = now();
  for (int i = 0; i < steps; ++i) {
    stick_slip::Switch switched;
    if (!solver.step(1000, switched).complete()) return NAN;
    switches += long(solver.events().size());
  }
  return (now() - begin) / steps;
}

/// Slope of ln time over ln blocks.
double exponent(const std::vector<int>& sizes, const std::vector<double>& times) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = double(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double a = std::log(sizes[i]), b = std::log(times[i]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

Record bench_chain(const Settings& settings, const SciPy&, const std::filesystem::path& curves) {
  Record record;
  const std::vector<int> sizes = settings.quick ? std::vector{50, 100} : std::vector{50, 100, 200, 500, 1000};
  const std::vector<std::pair<std::string, std::shared_ptr<const FrictionLaw>>> laws = {
      {"Coulomb", laws::find_law("coulomb")->with({0.6, 0.4})}, {"smooth", laws::make_law<SmoothFriction>()}};
  say(settings, "Time of a step, tolerance 1e-8, over that of {} blocks\n{:<10}", sizes.front(), "friction");
  for (const int size : sizes) say(settings, " {:>8}", size);
  say(settings, " {:>9}   {}\n", "exponent", "switches");
  for (const auto& [name, law] : laws) {
    std::vector<double> times;
    std::vector<long> switches;
    for (const int size : sizes) {
      progress(settings, fmt::format("steps of {} blocks, {} friction", size, name));
      const auto problem = problem_of(size);
      oscillators::StructureSystem system(chain_of(problem, law));
      times.push_back(time_of_step(system, problem, 1e-8, settings.quick ? 40 : 300, switches.emplace_back()));
    }
    say(settings, "{:<10}", name);
    for (const double time : times) say(settings, " {:>8.2f}", time / times.front());
    say(settings, " {:>9.2f}   {}\n", exponent(sizes, times), fmt::join(switches, " "));
    record.content["step"][name] = {{"blocks", sizes},
                                    {"microseconds", json::array()},
                                    {"exponent", exponent(sizes, times)},
                                    {"switches", switches}};
    for (const double time : times) record.content["step"][name]["microseconds"].push_back(1e6 * time);
  }

  std::vector<Row> rows;
  for (const int size : settings.quick ? std::vector{50} : std::vector{50, 200, 1000}) {
    const auto problem = problem_of(size);
    oscillators::StructureSystem system(chain_of(problem, laws[1].second));
    const ChainMotion truth = follow(system, problem, 1e-12), check = follow_cvode_chain(problem, 1e-11);
    const auto error_of = [&](const ChainMotion& found) {
      double worst = found.q.size() == truth.q.size() ? 0 : NAN;
      for (std::size_t i = 0; i < found.q.size() && i < truth.q.size(); ++i)
        worst = std::max(worst, std::abs(found.q[i] - truth.q[i]) / 0.6);
      return worst;
    };
    if (!(error_of(check) < 1e-7))
      record.findings.push_back(
          fmt::format("{} blocks: CVODE at 1e-11 differs from rosin at 1e-12 by {:.1e} of the "
                      "largest start",
                      size, error_of(check)));
    const std::string blocks = fmt::format(", {} blocks", size);
    const auto add = [&](const std::string& solver, const std::vector<double>& list, const auto& solve) {
      ChainMotion found;
      const auto more = sweep(
          solver + blocks, 1, list, settings, [&](int, double tolerance) { found = solve(tolerance); },
          [&](int, Row& row) {
            row.note = fmt::format("{} steps", found.steps);
            if (found.failure.empty())
              row.errors.push_back({error_of(found)});
            else
              ++row.failures[found.failure];
          });
      rows.insert(rows.end(), more.begin(), more.end());
    };
    add("rosin", tolerances(settings, 3, 11), [&](double tolerance) { return follow(system, problem, tolerance); });
    add("CVODE, banded", tolerances(settings, 3, 11),
        [&](double tolerance) { return follow_cvode_chain(problem, tolerance); });
    for (const double error : {1e-4, 1e-6, 1e-8}) {
      const auto ours = time_at(rows, "rosin" + blocks, error), other = time_at(rows, "CVODE, banded" + blocks, error);
      if (*ours.relation == '>' || *other.relation == '>') continue;
      record.content["cvode_over_rosin"][std::to_string(size)][fmt::format("{:.0e}", error)] =
          other.microseconds / ours.microseconds;
    }
  }
  say(settings,
      "\nSmooth friction over 200 s divided by the number of blocks, largest error of a displacement over the "
      "largest start\n");
  print(settings, rows, {"q"});
  record.content["rows"] = as_json(rows, {"q"});
  record.content["time_to_reach"] = times_to_reach(settings, rows, "A chain under smooth friction");
  if (record.content.contains("cvode_over_rosin"))
    for (const auto& [blocks, ratios] : record.content["cvode_over_rosin"].items())
      for (const auto& [error, ratio] : ratios.items())
        say(settings, "{} blocks to {}: CVODE takes {:.3g} times as long\n", blocks, error, ratio.get<double>());
  std::vector<Row> drawn;
  for (const Row& row : rows)
    if (settings.quick || row.solver.ends_with(", 200 blocks")) drawn.push_back(row);
  write_curves(curves, drawn);
  record.panels = {{curves, "Chain of 200 blocks under smooth friction",
                    "largest true error of a displacement over the largest start", "processor time (s)"}};
  return record;
}

}  // namespace bench
