/// The plane slider followed by events or by an algorithm, and sampled.
#include "analysis/motion/plane_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <memory>

#include "analysis/motion/motion_record.hpp"
#include "oscillators/contact_rows.hpp"
#include "solvers/force_algorithms/force_algorithms.hpp"
#include "solvers/force_algorithms/stepped_motion.hpp"

namespace rosin::analysis::motion {

namespace algorithms = solvers::force_algorithms;
using algorithms::State;
using algorithms::Vector;
using solvers::stick_slip::Switch;

namespace {

constexpr std::size_t columns = 6;  ///< before those of the states

/// One pass, by located events or by smooth steps.
struct PlanePass {
  MotionRecord record;
  std::vector<RunEvent> events;
  Outcome outcome;
  std::map<std::string, double> metrics;
  long steps;

  PlanePass(const PlaneModel& model, const std::vector<double>& times, double end, long most_steps, double tolerance)
      : record(columns + memory_of(model).size(), 0, times) {
    const auto memory = memory_of(model);
    const auto of_model = solver_of(model, tolerance);
    auto& solver = *of_model;
    solver.start(0, start_of(model));
    const auto row = [&](bool near) {
      return [&, near](double t, double* to) {
        const auto [x, v, F, states] = solver.at(t, near);
        const double values[] = {x[0], x[1], v[0], v[1], F[0], F[1]};
        std::ranges::copy(values, to);
        for (std::size_t m = 0; m < memory.size(); ++m)
          to[columns + m] = oscillators::to_state(memory[m].state, states[std::size_t(memory[m].place)]);
      };
    };
    std::vector<double> inside;
    double wear = 0;  // J, ∫ N |w| dt
    for (long steps = 0; solver.time() < end && outcome.complete(); ++steps) {
      Switch what;
      outcome = steps < most_steps ? solver.advance(end, what) : Outcome{Ending::budget_spent, "too many steps"};
      if (!outcome.complete()) {
        outcome.detail += fmt::format(" at t = {:.9g} s", solver.time());
        break;
      }
      const double from = solver.time_before(), to = solver.time(), parts = solver.parts() + 1;
      inside.clear();
      for (double k = 1; k < parts; ++k) inside.push_back(std::lerp(from, to, k / parts));
      record.step(from, to, inside, row(true), row(false));
      const auto wear_rate = [&](double t) {
        const auto v = solver.at(t, true).velocity;
        return model.mass.load.value(t) *
               std::hypot(v[0] - model.mass.surface_velocity[0], v[1] - model.mass.surface_velocity[1]);
      };
      for (double k = 0; k < parts; ++k)
        wear += boost::math::quadrature::gauss<double, 3>::integrate(wear_rate, std::lerp(from, to, k / parts),
                                                                     std::lerp(from, to, (k + 1) / parts));
      if (what == Switch::none) continue;
      const auto at = solver.at(solver.time()).displacement;
      events.push_back({solver.time(), name(what), at[0], at[1]});
    }
    if (outcome.complete()) record.rest(end, true, row(false));
    metrics = {{"friction_work", solver.friction_work()},
               {"path_length", solver.path_length()},
               {"wear_work_rate", wear / solver.time()},
               {"energy_residual", solver.energy_residual()}};
    if (memory.empty()) metrics["stick_time"] = solver.stick_time();
    steps = solver.steps();
  }
};

/// The largest error of displacements and velocities. Motion along one axis is known by the size of the vector: across
/// it there is rounding alone.
double error_over_size(const MotionRecord& record, const MotionRecord& other, const std::vector<ErrorRule>& rules) {
  constexpr std::size_t of_motion = 4;
  double worst = 0;
  for (std::size_t c = 0; c < of_motion; ++c) {
    const double difference = largest_difference(other.columns()[c], record.columns()[c]);
    const double of_vector = std::max(record.size(c), record.size(c ^ 1));
    if (of_vector > 0) worst = std::max(worst, rules[c].error(difference, record.size(c)) / of_vector);
  }
  return worst;
}

/// Columns of a record, and their errors from another.
void take(const MotionRecord& record, const MotionRecord& other, const std::vector<ErrorRule>& rules,
          const std::vector<double>& times, Run& result) {
  for (std::size_t c = 0; c < record.columns().size(); ++c)
    result.column_error.push_back(
        rules[c].error(largest_difference(other.columns()[c], record.columns()[c]), record.size(c)));
  state_what_is_seen(record, &other, rules, result);
  result.columns = record.columns();
  result.time.assign(times.begin(), times.begin() + static_cast<long>(record.samples()));
}

MotionRecord stepped(const PlaneModel& model, const RunOptions& options, const std::vector<double>& times, double end,
                     Run& result) {
  algorithms::check(options.solver, model.mass, options.algorithm);
  const double step = algorithms::step_of(model.mass, options.algorithm), count = std::ceil(end / step * (1 - 1e-12));
  if (count > double(options.most_steps))
    throw InputError(fmt::format("solver.step = {} s makes {:.3g} steps, more than {}; take it above {:.3g} s", step,
                                 count, options.most_steps, end / double(options.most_steps)));
  const algorithms::Forcing<2> forcing(model.mass, step, static_cast<std::size_t>(count));
  const auto track =
      algorithms::follow<2>(options.solver, model.mass, forcing, options.algorithm, model.displacement, model.velocity);
  const auto& points = track.points;
  MotionRecord record(columns, 0, times);
  const auto row = [&](double t, double* to) {
    const auto n = std::min(static_cast<std::size_t>(t / step), points.size() - 1),
               m = std::min(n + 1, points.size() - 1);
    const double part = std::clamp(t / step - double(n), 0.0, 1.0);
    const auto &a = points[n], &b = points[m];
    for (int d = 0; d < 2; ++d) {
      to[d] = std::lerp(a.x[d], b.x[d], part);
      to[2 + d] = std::lerp(a.v[d], b.v[d], part);
      to[4 + d] = std::lerp(a.friction[d], b.friction[d], part);
    }
  };
  for (std::size_t n = 1; n < points.size() && points[n - 1].time < end; ++n)
    record.step(points[n - 1].time, std::min(points[n].time, end), {}, row);
  record.rest(end, true, row);
  double stick_time = 0;
  for (std::size_t n = 1; n < points.size(); ++n) {
    const bool stuck = points[n - 1].state == State::stick, sticks = points[n].state == State::stick;
    if (stuck) stick_time += step;
    if (stuck != sticks)
      result.events.push_back({points[n].time, sticks ? "stick" : "slip", points[n].x[0], points[n].x[1]});
  }
  double most_back_steps = 0, false_starts = 0;
  for (const auto& stick : track.sticks) {
    most_back_steps = std::max(most_back_steps, double(stick.back_steps));
    false_starts += stick.false_start;
  }
  result.metrics = {{"stick_time", stick_time},
                    {"sticks", double(track.sticks.size())},
                    {"false_starts", false_starts},
                    {"most_back_steps", most_back_steps}};
  result.cost.steps = static_cast<long>(points.size()) - 1;
  result.why = fmt::format("as asked, steps of {:.6g} s; its errors are the differences to located events", step);
  return record;
}

}  // namespace

std::vector<std::string> plane_solver_names() {
  std::vector<std::string> names = {"auto", "exact"};
  for (const auto& algorithm : algorithms::algorithms())
    if (algorithm.name != "meijaard") names.emplace_back(algorithm.name);
  return names;
}

Run run_plane(const PlaneModel& model, const RunOptions& options) {
  require(options.tolerance, {1e-13, 0.1}, "tolerance", "relative accuracy of a run", "1");
  const auto known = plane_solver_names();
  if (std::ranges::find(known, options.solver) == known.end())
    throw InputError(fmt::format("solver '{}' does not serve a plane slider; use one of {}", options.solver,
                                 fmt::join(known, ", ")));
  const bool exactly = options.solver == "auto" || options.solver == "exact";
  if (model.law && !exactly)
    throw InputError(fmt::format("solver '{}' is for Coulomb friction; law '{}' depends on {}, use 'exact'",
                                 options.solver, model.law->card().name,
                                 model.remembers() ? "states" : "the slip rate"));
  Run result;
  const auto times = sample_times(options);
  const double end = std::max(options.duration, times.back());
  result.column_names = {"displacement_x", "displacement_y", "velocity_x", "velocity_y", "friction_x", "friction_y"};
  result.column_units = {"m", "m", "m/s", "m/s", "N", "N"};
  for (const auto& [state, place] : memory_of(model))
    result.column_names.push_back(state.name), result.column_units.push_back(state.unit);
  double tolerance = std::clamp(1e-3 * options.tolerance, 1e-13, 1e-9);
  constexpr double apart = 30, least_tolerance = 1e-15;
  const auto pass = [&](double at) {
    return std::make_unique<const PlanePass>(model, times, end, options.most_steps, at);
  };
  auto fine = pass(tolerance);
  result.solver = exactly ? "exact" : options.solver;
  if (!exactly) {
    const MotionRecord steps = stepped(model, options, times, end, result);
    take(steps, fine->record, std::vector<ErrorRule>(columns), times, result);
    return result;
  }
  auto coarse = pass(apart * tolerance);
  result.cost.steps = fine->steps + coarse->steps;
  const auto rules = [&] { return std::vector<ErrorRule>(fine->record.columns().size(), {3, tolerance}); };
  double worst = error_over_size(fine->record, coarse->record, rules());
  while (fine->outcome.complete() && worst > options.tolerance && tolerance > apart * least_tolerance) {
    tolerance /= apart;
    coarse = std::move(fine), fine = pass(tolerance);
    result.cost.steps += fine->steps;
    worst = error_over_size(fine->record, coarse->record, rules());
  }
  result.events = fine->events;
  result.outcome = fine->outcome;
  result.why = model.remembers()
                   ? "in the plane, under friction that remembers and is smooth at rest: implicit steps, and stick "
                     "is slow creep"
                   : "in the plane slip has no closed form: smooth pieces in the logarithm of speed, events located";
  result.metrics = fine->metrics;
  state_event_errors(result, coarse->events, {3});
  take(fine->record, coarse->record, rules(), times, result);
  if (result.outcome.complete() && worst > options.tolerance)
    result.outcome = {Ending::tolerance_not_met, fmt::format("the motion is known to {:.1e} of its size only", worst)};
  return result;
}

}  // namespace rosin::analysis::motion
