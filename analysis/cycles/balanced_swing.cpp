/// Slip from one crossing of the drive speed to the next, and the amplitude that it keeps.
#include "analysis/cycles/balanced_swing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/cycles/return_map.hpp"
#include "analysis/cycles/slow_swing.hpp"
#include "analysis/motion/slider_swings.hpp"
#include "analysis/steady/stability.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace rosin::analysis::cycles {

using oscillators::SliderSystem;

StickSlipPeriod slip_return(const Model& model, double swing, double tolerance, double stick_threshold, bool record) {
  StickSlipPeriod result;
  SliderSystem system(model);
  const motion::SliderSwings swings(system);
  solvers::stick_slip::StickSlip solver(system, tolerance, swings.present());
  const auto steady = steady::steady_sliding(model);
  const double V = model.drive.speed.level(), x_steady = steady.displacement;
  SwingWork work(system, steady.friction_force);
  const double natural = 2 * std::numbers::pi * std::sqrt(model.slider.mass / model.slider.stiffness);
  solver.bound_slip_step(0.1 * natural);
  if (!solver.start(0, system.unknowns_at(0, x_steady + swing, V, {}, 0))) {
    result.outcome = {Ending::not_finite, "at the start"};
    return result;
  }
  Recorder recorder(system, tolerance, stick_threshold, true);
  const auto section = [&](double t, const double* y) { return system.slip_rate(t, y) - V; };
  const double longest = 100 * natural + 10 * std::abs(system.loaded_at_rest({}, 1)[0]) / V;
  bool below = false;
  double period = 0, stuck = 0;
  std::vector<double> y(system.size());
  while (!result.found && solver.time() < longest && solver.stepper().count().steps < 5'000) {
    solvers::stick_slip::Switch switched;
    result.outcome = solver.step(longest, switched);
    if (!result.outcome.complete()) break;
    auto& step = solver.stepper();
    double low = 0, low_value = section(step.time_before(), step.state_before().data());
    for (int i = 0; i < solvers::steps::Collocation::stages; ++i) {
      step.stage(i, y.data());
      const double value = section(step.stage_time(i), y.data());
      if (below && value >= 0) {
        const auto located = step.locate(section, low, step.node(i), std::min(low_value, -1e-300), value);
        result.found = located && step.shorten(*located);
        break;
      }
      if (value < -1e-10 * V) below = true;
      low = step.node(i), low_value = value;
    }
    period += step.length();
    if (system.mode() == ContactMode::stick) stuck += step.length();
    work.step(step);
    if (record) recorder.step(step);
  }
  if (result.found) {
    result.growth = work.growth(swing);
    if (record) {
      result.metrics = recorder.finish(period);
      result.metrics.stick_fraction = stuck / period;
      result.orbit = std::move(recorder.orbit);
    }
  }
  result.steps = solver.stepper().count().steps;
  result.evaluations = solver.stepper().count().evaluations;
  return result;
}

double static_limit_of_curve(const Model& model) {
  const double N = model.drive.normal_load.level();
  return model.law->static_limit(N, model.law->steady({0, N}));
}

BalancedSwing balanced_swing(const Model& model, double tolerance) {
  const double natural = std::sqrt(model.slider.mass / model.slider.stiffness);
  const double at_drive = model.drive.speed.level() * natural;  // free oscillations of this amplitude just come to rest
  const double largest =
      at_drive + 2 * model.drive.normal_load.level() * static_limit_of_curve(model) / model.slider.stiffness;
  constexpr long most_steps = 200'000;
  long steps = 0;
  const auto growth = [&](double log_swing) {
    if (steps > most_steps) return -1.0;
    const auto returned = slip_return(model, std::exp(log_swing), tolerance, 0.1, false);
    steps += returned.steps;
    return returned.found && std::isfinite(returned.growth) ? returned.growth : -1.0;
  };
  constexpr double step = 0.25, farthest = 12;  // e-foldings of the amplitude
  double high = std::log(8 * largest), f_high = growth(high);
  const double lowest = std::log(at_drive) - farthest;
  for (double low = high - step; low > lowest && f_high < 0 && steps <= most_steps; low -= step) {
    const double f_low = growth(low);
    if (f_low <= 0) {
      high = low, f_high = f_low;
      continue;
    }
    std::uintmax_t iterations = 100;
    const auto [a, b] = boost::math::tools::toms748_solve(growth, low, high, f_low, f_high,
                                                          boost::math::tools::eps_tolerance<double>(50), iterations);
    if (steps <= most_steps) return {std::exp(0.5 * (a + b)), {}};
  }
  if (steps <= most_steps) return {};
  return {
      {},
      {Ending::budget_spent, fmt::format("no oscillation that repeats itself within {} steps of slip", most_steps)}};
}

double slope_of_swing(const Model& model, double swing, double stick_threshold, double relative_distance) {
  constexpr double closely = 1e-10;
  const auto left = slip_return(model, swing * (1 - relative_distance), closely, stick_threshold, false);
  const auto right = slip_return(model, swing * (1 + relative_distance), closely, stick_threshold, false);
  return (right.growth - left.growth) / (2 * relative_distance);
}

}  // namespace rosin::analysis::cycles
