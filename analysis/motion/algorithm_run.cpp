/// Steps of an algorithm turned into the record of a run, beside the exact motion.
#include "analysis/motion/algorithm_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/motion/motion_record.hpp"

namespace rosin::analysis::motion {

namespace algorithms = solvers::force_algorithms;
using algorithms::State;
using solvers::stick_slip::DryOscillator;

algorithms::DryMass<1> dry_mass(const DryOscillator& oscillator) {
  if (!oscillator.speed.constant())
    throw InputError("the force algorithms are stated for a surface of constant speed; use solver 'exact'");
  if (oscillator.viscous != 0)
    throw InputError("the force algorithms are stated for Coulomb friction without a viscous part; use solver 'exact'");
  return {oscillator.mass,
          {oscillator.stiffness},
          {oscillator.damping},
          oscillator.static_friction,
          oscillator.dynamic_friction,
          {oscillator.speed.level()},
          oscillator.load,
          {oscillator.force}};
}

namespace {

using Track = algorithms::Track<1>;

/// Displacement by the cubic through places and velocities of the step around t; velocity and friction linearly.
std::array<double, 3> between(const Track& track, double t) {
  const auto& points = track.points;
  const auto next = std::ranges::upper_bound(points, t, {}, &algorithms::SteppedMotion<1>::Point::time);
  if (next == points.end()) return {points.back().x[0], points.back().v[0], points.back().friction[0]};
  const auto &a = *(next - 1), &b = *next;
  const double h = b.time - a.time, p = (t - a.time) / h, q = 1 - p;
  const double x = q * q * (1 + 2 * p) * a.x[0] + p * p * (1 + 2 * q) * b.x[0] + p * q * h * (q * a.v[0] - p * b.v[0]);
  return {x, std::lerp(a.v[0], b.v[0], p), std::lerp(a.friction[0], b.friction[0], p)};
}

}  // namespace

void run_algorithm(const Model& model, const DryOscillator& oscillator, const RunOptions& options,
                   const std::vector<double>& times, Run& result) {
  const auto mass = dry_mass(oscillator);
  algorithms::check(result.solver, mass, options.algorithm);
  const double end = std::max(options.duration, times.back()), step = algorithms::step_of(mass, options.algorithm);
  const double steps = std::ceil(end / step * (1 - 1e-12));
  if (steps > double(options.most_steps))
    throw InputError(fmt::format("solver.step = {} s makes {:.3g} steps, more than {}; take it above {:.3g} s", step,
                                 steps, options.most_steps, end / double(options.most_steps)));
  if (options.algorithm.closed_form && std::isfinite(std::min(mass.load.next_break(0), mass.force[0].next_break(0))))
    throw InputError("solver.stepping = 'closed-form' needs a load and a force that are constant or harmonic");
  const oscillators::SliderSystem system(model);
  const auto y = starting_point(system, options.start);
  const double V = oscillator.speed.level(), v0 = V - y[1];
  const algorithms::Forcing<1> forcing(mass, step, static_cast<std::size_t>(steps));
  const auto track = algorithms::follow<1>(result.solver, mass, forcing, options.algorithm, {y[0]}, {v0});

  const auto row = [&](double t, double* to) {
    const auto [x, v, F] = between(track, t);
    const double N = oscillator.load.value(t), rest = oscillator.force.value(t) - oscillator.stiffness * x,
                 values[] = {x, v, V - v, F, N > 0 ? F / N : 0, (F + rest - oscillator.damping * v) / oscillator.mass};
    std::ranges::copy(values, to);
  };
  constexpr std::size_t columns = 6;
  MotionRecord record(columns, 0, times, {slip_columns(model, 0)});
  const auto& points = track.points;
  for (std::size_t n = 1; n < points.size() && points[n - 1].time < end; ++n) {
    const auto &before = points[n - 1], &now = points[n];
    const bool stuck = before.state == State::stick, sticks = now.state == State::stick;
    record.step(before.time, std::min(now.time, end), {}, row);
    if (now.time > end) break;
    if (stuck != sticks) {
      record.switched(0, stuck);
      result.events.push_back({now.time, sticks ? "stick" : "slip", now.x[0]});
    } else if (!sticks && (before.v[0] - V) * (now.v[0] - V) < 0) {
      result.events.push_back({now.time, "reversal", now.x[0]});
    }
  }
  record.rest(end, true, row);

  Run exact;
  exact.column_names = result.column_names;
  run_exactly(model, oscillator, options, times, exact);
  for (std::size_t c = 0; c < columns; ++c) {
    result.column_error.push_back(largest_difference(exact.columns[c], record.columns()[c]));
    result.columns.push_back(record.columns()[c]);
  }
  state_what_is_seen(record, nullptr, std::vector<ErrorRule>(columns), result);
  for (auto& [name, error] : result.metric_error)
    error = std::abs(result.metrics.at(name) - exact.metrics.at(name)) + exact.metric_error.at(name);

  double stick_time = 0, work = 0, wear = 0, most_back_steps = 0, false_starts = 0;
  for (std::size_t n = 1; n < points.size(); ++n) {
    const double h = points[n].time - points[n - 1].time;
    if (points[n - 1].state == State::stick) stick_time += h;
    const double slip_rate = (points[n - 1].v[0] + points[n].v[0] - 2 * V) / 2;
    work += h * std::abs(points[n - 1].friction[0] * slip_rate);
    wear += h * oscillator.load.value(points[n - 1].time) * std::abs(slip_rate);
  }
  for (const auto& stick : track.sticks) {
    most_back_steps = std::max(most_back_steps, double(stick.back_steps));
    false_starts += stick.false_start;
  }
  result.metrics["stick_time"] = stick_time;
  result.metrics["sticks"] = double(track.sticks.size());
  result.metrics["false_starts"] = false_starts;
  result.metrics["most_back_steps"] = most_back_steps;
  result.metrics["friction_work"] = work;
  result.metrics["wear_work_rate"] = wear / points.back().time;
  result.cost.steps = static_cast<long>(points.size()) - 1;
  result.why += fmt::format("; steps of {:.6g} s", step);
}

}  // namespace rosin::analysis::motion
