/// Returns to the section v = V, and their derivative.
#include "analysis/cycles/return_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/motion/motion_end.hpp"
#include "analysis/steady/stability.hpp"

namespace rosin::analysis::cycles {

using oscillators::Mechanics;
using solvers::steps::Collocation;

ReturnMap::ReturnMap(const Model& model) : system_(model), speed_(model.drive.speed.level()) {
  for (const auto& e : steady::stability(model).eigenvalues)
    if (e.real() > 0) {
      growth_time_ = std::min(growth_time_, 1 / std::abs(e));
      spirals_ = spirals_ || e.imag() != 0;
    }
  const int n = system_.size();
  std::vector<double> mass(n), scale(n);
  const auto y = system_.steady(0);
  system_.mass(0, mass.data());
  system_.scale(y.data(), scale.data());
  for (int i = 0; i < n; ++i)
    if (mass[i] > 0) differential_.push_back(i);
  scale_.resize(differential_.size());
  for (std::size_t i = 0; i < differential_.size(); ++i) scale_[i] = scale[differential_[i]];
  // No return takes longer than many natural periods and many times the loading of the spring to the friction force.
  const auto& s = model.slider;
  const double N = model.drive.normal_load.level();
  const auto& contact = model.contact_stiffness;
  const double loading = s.stiffness > 0 ? N * (1 / s.stiffness + contact.compliance(N)) / speed_ : 0;
  const double natural = s.mass > 0 && s.stiffness > 0 ? 2 * std::numbers::pi * std::sqrt(s.mass / s.stiffness) : 0;
  if (s.mass > 0 && !system_.rigid()) {
    const double k_t = 1 / contact.compliance(N);
    const double ringing = 2 * std::numbers::pi * std::sqrt(s.mass / (s.stiffness + k_t));
    if (loading > 100 * ringing && s.damping < 1e-3 * std::sqrt(s.mass * (s.stiffness + k_t)))
      ringing_ = fmt::format(
          ": the slider rings on the contact spring, with a period of {:.3g} s and hardly damped, while the contact "
          "loads "
          "for {:.3g} s",
          ringing, loading);
  }
  longest_return_ = 1e3 * (natural + loading + s.damping / std::max(s.stiffness, 1e-300));
}

std::vector<double> ReturnMap::stick(double aged_at) const {
  const auto& model = system_.model();
  const double N = model.drive.normal_load.level(), f = model.drive.force.level(), u = 1e-3 * speed_;
  // With λ = 0 the state follows the slip rate at once; any other state would need slip at 1e-100 m/s for this
  // friction.
  const auto state = model.law->steady({model.lambda == 0 ? u : aged_at, N});
  const double F = N * model.law->friction({u, N}, state);
  if (system_.mechanics() == Mechanics::inertial && !system_.rigid()) {
    // While the contact sticks, its spring and the slider's share the motion of the drive. Any other start rings,
    // perhaps without damping.
    const auto& s = model.slider;
    const double k_t = 1 / model.contact_stiffness.compliance(N);
    const double imposed = speed_ * s.stiffness / (s.stiffness + k_t);
    return system_.unknowns_at(0, (F + f - s.damping * (speed_ - imposed)) / s.stiffness, imposed, state, F);
  }
  const double x = system_.mechanics() == Mechanics::damped
                       ? (F + f - model.slider.damping * (speed_ - u)) / model.slider.stiffness
                       : system_.steady(0)[0];
  return system_.unknowns_at(0, x, u, state, F);
}

double ReturnMap::distance(const std::vector<double>& a, const std::vector<double>& b) const {
  return length(difference(a, b));
}

Eigen::VectorXd ReturnMap::difference(const std::vector<double>& a, const std::vector<double>& b) const {
  Eigen::VectorXd d(differential_.size());
  for (std::size_t i = 0; i < differential_.size(); ++i) d[i] = a[differential_[i]] - b[differential_[i]];
  return d;
}

std::vector<double> ReturnMap::moved(const std::vector<double>& a, const Eigen::VectorXd& step, double factor) const {
  auto y = a;
  for (std::size_t i = 0; i < differential_.size(); ++i) y[differential_[i]] += factor * step[i];
  if (system_.slip_rate_index() >= 0 && system_.rigid()) y[system_.slip_rate_index()] = speed_;
  return y;
}

double friction_over_swing(const Model& model) {
  const double V = std::abs(model.drive.speed.level());
  return model.drive.normal_load.level() / (V * std::sqrt(model.slider.stiffness * model.slider.mass));
}

/// Longest step (s) of decelerating slip: the slip rate falls by 80 % at most. The direct effect reverses friction
/// within a tiny slip rate, and a step from far above would end there at random. Bristles reverse more slowly, but
/// where friction is weak a step may pass over a whole reversal.
double ReturnMap::reversal_step(const Collocation& solver) const {
  const int at = system_.slip_rate_index();
  const bool direct = system_.carries_friction();
  if (at < 0 || !system_.rigid() || solver.count().steps == 0 ||
      !(direct || friction_over_swing(system_.model()) < weak_friction))
    return infinity;
  std::vector<double> rate(system_.size());
  solver.rate(rate.data());
  const double u = solver.state()[at];
  if (!(u * rate[at] < 0)) return infinity;
  constexpr double share = 0.8;
  const double near_rest = direct ? 1e-13 : 1e-6;
  const double clock = 1e-28 * solver.time();  // the step stays above rounding error of the time
  return std::max(std::max(share * std::abs(u), near_rest * speed_) / std::abs(rate[at]), clock);
}

/// Time derivatives of the differential unknowns at the end of the last step: M⁻¹f, or the derivative of the
/// collocation polynomial where the terms of f cancel to rounding error, as for a slider so damped that its mass hardly
/// counts.
std::vector<double> ReturnMap::rates_at_end(const Collocation& solver, double tolerance) const {
  const int n = system_.size();
  const auto& y = solver.state();
  std::vector<double> rate(n), f(n), mass(n), J(n * n);
  solver.rate(rate.data());
  system_.linearise(solver.time(), y.data(), f.data(), J.data());
  system_.mass(solver.time(), mass.data());
  for (std::size_t k = 0; k < differential_.size(); ++k) {
    const int i = differential_[k];
    const double terms = size_of_terms(&J[i * n], y.data(), n);
    constexpr double rounding = 1e-16, solved = 1e-2;
    if (rounding * terms / mass[i] < solved * tolerance * scale_[k] / solver.length()) rate[i] = f[i] / mass[i];
  }
  return rate;
}

/// Removes the component along the motion from the columns of S, at the end of the last step.
void ReturnMap::take_out_motion(std::vector<double>& S, int columns, const Collocation& solver,
                                double tolerance) const {
  const auto rate = rates_at_end(solver, tolerance);
  double square = 0;
  for (std::size_t k = 0; k < differential_.size(); ++k) square += std::pow(rate[differential_[k]] / scale_[k], 2);
  for (int c = 0; c < columns; ++c) {
    double along = 0;
    for (std::size_t k = 0; k < differential_.size(); ++k)
      along += rate[differential_[k]] * S[differential_[k] * columns + c] / (scale_[k] * scale_[k]);
    for (const int i : differential_) S[i * columns + c] -= rate[i] * along / square;
  }
}

ReturnMap::Return ReturnMap::follow(const std::vector<double>& y0, double tolerance, int returns, bool from_section,
                                    Derivative derivative, StepObserver* observer, double dip) {
  Return returned;
  const int n = system_.size(), columns = int(differential_.size());
  const bool across = derivative == Derivative::across_motion;
  system_.mark_reversals(across);
  Collocation solver(system_, tolerance);
  if (!solver.start(0, y0)) {
    returned.outcome = {Ending::not_finite, "the start cannot be made consistent"};
    returned.end = y0;
    return returned;
  }
  std::vector<double> S, work(n);
  if (derivative != Derivative::none) {
    S.assign(n * columns, 0.0);
    for (int c = 0; c < columns; ++c) S[differential_[c] * columns + c] = 1;
  }
  const auto section = [&](double t, const double* y) { return system_.contact_slip_rate(t, y) - speed_; };
  // Motion that has been below the section by more than rounding error returns at its next rising zero.
  const double noise = dip * speed_;
  bool below = !from_section && section(0, solver.state().data()) < -noise;
  const long allowed = std::min(returns * allowed_, most_steps);
  while (returns > 0) {
    // An implicit step over many periods of a growing oscillation would damp it.
    const bool near_steady = std::abs(section(solver.time(), solver.state().data())) < 0.9 * speed_;
    const double growing = near_steady && spirals_ ? growth_time_ : infinity;
    solver.bound_step(std::min({growing, reversal_step(solver), reversal_steps_.longest(solver)}));
    const Outcome outcome = solver.step(longest_return_);
    if (!outcome.complete()) {
      const auto end = motion::why_motion_ends(system_, solver.time(), solver.state().data());
      returned.outcome = end ? Outcome{Ending::none_exists, *end} : outcome;
      break;
    }
    if (const auto away = motion::why_slip_runs_away(system_, solver.time(), solver.state().data())) {
      returned.outcome = {Ending::none_exists, *away};
      break;
    }
    const double t0 = solver.time_before();
    double low = 0, low_value = section(t0, solver.state_before().data());
    bool passed = false;
    for (int i = 0; i < Collocation::stages && !passed; ++i) {
      solver.stage(i, work.data());
      const double theta = solver.node(i), value = section(solver.stage_time(i), work.data());
      returned.amplitude = std::max(returned.amplitude, std::abs(value) / speed_);
      if (below && value >= 0) {
        const auto located = solver.locate(section, low, theta, std::min(low_value, -1e-300), value);
        if (--returns == 0 && (!located || !solver.shorten(*located))) {
          const auto end = motion::why_motion_ends(system_, solver.time(), solver.state().data());
          returned.outcome =
              end ? Outcome{Ending::none_exists, *end} : Outcome{Ending::not_finite, "while locating the section"};
          returns = 0;
        }
        passed = returns == 0;
        below = false;
      }
      if (value < -noise) below = true;
      low = theta, low_value = value;
    }
    if (derivative != Derivative::none) solver.propagate(S, columns);
    if (across) take_out_motion(S, columns, solver, tolerance);
    if (observer) observer->step(solver);
    // Any growing motion is above 1e-9 after 2 000 steps.
    const bool at_rest = returned.amplitude < 1e-9 && solver.count().steps > 2'000;
    if (returns > 0 && (at_rest || solver.time() >= longest_return_ || solver.count().steps > allowed)) {
      if (const auto never = motion::why_nothing_slips_again(system_, solver.time(), solver.state().data())) {
        returned.outcome = {Ending::none_exists, *never};
        break;
      }
      const auto end = motion::why_rest_lasts(system_, solver.time(), solver.state().data());
      returned.outcome = {Ending::budget_spent,
                          fmt::format("no return through v = V within {:.3g} s and {} steps{}", solver.time(),
                                      solver.count().steps, end ? ": " + *end : ringing_)};
      break;
    }
  }
  system_.mark_reversals(false);
  cost_.steps += solver.count().steps;
  cost_.evaluations += solver.count().evaluations + solver.count().linearisations;
  ++cost_.cycles;
  returned.duration = solver.time();
  returned.end = solver.state();
  returned.ringing.assign(solver.ringing_errors().begin(), solver.ringing_errors().end());
  for (const double x : returned.end)
    if (!std::isfinite(x) && returned.outcome.complete()) returned.outcome = {Ending::not_finite, "at the section"};
  if (derivative != Derivative::none && returned.outcome.complete()) {
    // Projection along the flow onto the section: D = S − ẏ (∇v·S)/(∇v·ẏ).
    std::vector<double> gradient(n);
    const auto rate = rates_at_end(solver, tolerance);
    system_.slip_rate_gradient(0, returned.end.data(), gradient.data());
    double along = 0;
    for (int i = 0; i < n; ++i) along += gradient[i] * rate[i];
    returned.derivative.resize(columns, columns);
    for (int c = 0; c < columns; ++c) {
      double cross = 0;
      for (int i = 0; i < n; ++i) cross += gradient[i] * S[i * columns + c];
      for (int r = 0; r < columns; ++r)
        returned.derivative(r, c) = S[differential_[r] * columns + c] - rate[differential_[r]] * cross / along;
    }
    if (!returned.derivative.allFinite())
      returned.outcome = {Ending::not_finite, "in the derivative of the return map"};
  }
  return returned;
}

}  // namespace rosin::analysis::cycles
