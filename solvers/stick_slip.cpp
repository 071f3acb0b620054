/// Location of stick, slip and reversal, and the choice of what follows.
#include "solvers/stick_slip.hpp"

#include <cmath>

namespace rosin::solvers {

namespace {
constexpr double rest = 1e-11;  ///< slip rates below this part of the reference speed are rounding noise at a switch
}

StickSlip::StickSlip(SwitchingSystem& system, double tolerance)
    : system_(system), collocation_(system, tolerance), work_(system.size()) {}

/// Positive while the present mode lasts.
double StickSlip::indicator(double t, const double* y) const {
  if (system_.direction() == 0) return system_.holding_limit(t) - std::abs(system_.holding_force(t, y));
  return system_.direction() * system_.slip_rate(t, y);
}

/// The balance of forces at rest: stick if the contact can hold, else slip along the force that it cannot hold.
double StickSlip::mode_at_rest(double t, const double* y, double direction) const {
  const double hold = system_.holding_force(t, y);
  if (direction == 0) return hold > 0 ? 1 : -1;  // stick has just reached its limit
  return std::abs(hold) <= system_.holding_limit(t) ? 0 : hold > 0 ? 1 : -1;
}

bool StickSlip::start(double t, std::span<const double> y) {
  work_.assign(y.begin(), y.end());
  const double u = system_.slip_rate(t, work_.data());
  armed_ = std::abs(u) > rest * system_.reference_speed();
  system_.set_direction(1);
  upcoming_ = armed_ ? (u > 0 ? 1 : -1) : mode_at_rest(t, work_.data(), 1);
  system_.set_direction(upcoming_);
  switched_ = false;
  return collocation_.start(t, y);
}

Outcome StickSlip::step(double t_limit, Switch& switched) {
  switched = Switch::none;
  if (switched_) {
    std::vector<double> y = collocation_.state();
    system_.stop(y.data());
    system_.set_direction(upcoming_);
    armed_ = switched_ = false;
    if (!collocation_.start(collocation_.time(), y)) return {Ending::not_finite, "after a switch"};
  }
  const double small = rest * system_.reference_speed();
  const Outcome outcome = collocation_.step(t_limit);
  if (!outcome.complete()) return outcome;
  // The first node at which the mode has ended, if any.
  const double t0 = collocation_.time_before(), h = collocation_.time() - t0;
  double low = 0, high = -1, high_value = 0;
  double low_value = indicator(t0, collocation_.state_before().data());
  const bool sticking = system_.direction() == 0;
  for (int i = 0; i < Collocation::stages; ++i) {
    collocation_.stage(i, work_.data());
    const double value = indicator(collocation_.stage_time(i), work_.data());
    const double theta = (collocation_.stage_time(i) - t0) / h;
    if (!sticking && !armed_) {
      // Slip that has only just begun: rounding must not end it.
      if (value > small) armed_ = true;
      if (value > -small) {
        low = theta, low_value = value;
        continue;
      }
    }
    if (value < 0) {
      high = theta, high_value = value;
      break;
    }
    low = theta, low_value = value;
  }
  if (high < 0) return {};
  const auto located = collocation_.locate([&](double t, const double* y) { return indicator(t, y); }, low, high,
                                           std::max(low_value, 0.0), high_value);
  if (!located || !collocation_.shorten(*located)) return {Ending::not_finite, "while locating a switch"};
  const double was = system_.direction();
  upcoming_ = mode_at_rest(collocation_.time(), collocation_.state().data(), was);
  switched_ = true;
  switched = was == 0 ? Switch::slip : upcoming_ == 0 ? Switch::stick : upcoming_ == was ? Switch::none : Switch::reversal;
  return {};
}

}  // namespace rosin::solvers
