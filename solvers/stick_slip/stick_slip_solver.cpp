/// Location of stick, slip and reversal, and the choice of what follows.
#include "solvers/stick_slip/stick_slip_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/maths.hpp"

namespace rosin::solvers::stick_slip {

namespace {
constexpr double rest = 1e-11;     ///< slip rates below this part of the reference speed are rounding noise at a switch
constexpr double doubtful = 1e-4;  ///< or below this one may be rest: no solution is worse
constexpr double last_digits = 4 * std::numeric_limits<double>::epsilon();  ///< below which part no energy tells more
}  // namespace

void StickSlip::rest_in_doubt(bool even_if_not_held) {
  rest_below(10 * tolerance_ * system_.reference_speed(), even_if_not_held);
  work_in_doubt_ = tolerance_;
}

std::string name(Switch what) { return what == Switch::stick ? "stick" : what == Switch::slip ? "slip" : "reversal"; }

StickSlip::StickSlip(SwitchingSystem& system, double tolerance)
    : system_(system),
      collocation_(system, tolerance),
      tolerance_(tolerance),
      work_(system.size()),
      jacobian_(system.size() * system.size()),
      mass_(system.size()) {}

/// Time in which slip that slows down halves. Friction may turn over within a small part of the reference speed just
/// before rest, which a step from far above would not see.
double StickSlip::landing_time() {
  const int n = system_.size();
  const double u = system_.slip_rate(time(), state().data());
  if (!(std::abs(u) > 1e-8 * system_.reference_speed())) return infinity;
  system_.linearise(time(), state().data(), work_.data(), jacobian_.data());
  system_.mass(time(), mass_.data());
  double rate = 0;  // of the slip rate; the unknown that it is follows from its value
  for (int i = 0; i < n; ++i) {
    if (state()[i] != u || mass_[i] == 0) continue;
    constexpr double rounding = 1e-14;
    if (std::abs(work_[i]) >= rounding * size_of_terms(&jacobian_[i * n], state().data(), n))
      rate = work_[i] / mass_[i];
    else if (collocation_.length() > 0)  // of forces that balance but for their last digits the step before tells
      rate = (u - collocation_.state_before()[i]) / collocation_.length();
  }
  // A drive's time must still advance, and a step be a part of it that counts.
  const double clock = (system_.autonomous() ? 1e-28 : 1e-12) * std::abs(time());
  return u * rate < 0 ? std::max(0.5 * std::abs(u / rate), clock) : infinity;
}

/// Positive while the present mode lasts.
double StickSlip::indicator(double t, const double* y) const {
  if (system_.direction() == 0) return system_.holding_limit(t, y) - std::abs(system_.holding_force(t, y));
  return system_.direction() * system_.slip_rate(t, y);
}

/// The balance of forces at rest: stick if the contact can hold, else slip along the force that it cannot hold. Slip
/// that loses nothing comes back to the limit that it began at, and is held but for last digits.
double StickSlip::mode_at_rest(double t, const double* y, double direction) const {
  const double hold = system_.holding_force(t, y);
  if (direction == 0) return hold > 0 ? 1 : -1;  // stick has just reached its limit
  const double doubt = direction * hold < 0 ? system_.holding_digits(t, y) : 0;
  return std::abs(hold) <= system_.holding_limit(t, y) + doubt ? 0 : hold > 0 ? 1 : -1;
}

/// True if a stop in y leaves the contact more than rounding short of its limit.
bool StickSlip::holds(double t, std::vector<double> y) const {
  system_.stop(y.data());
  constexpr double certainly = 1 - 1e-6;
  return std::abs(system_.holding_force(t, y.data())) < certainly * system_.holding_limit(t, y.data());
}

/// Of the present mode. What states forget at rest decides when the contact gives way, and one step may take them
/// through all of it, the same at every tolerance: the first is to resolve it.
bool StickSlip::begin(double t, std::span<const double> y) {
  collocation_.resolve_starts(system_.direction() == 0);
  return collocation_.start(t, y);
}

/// At rest, in the mode that now begins.
void StickSlip::leave_rest(const double* y) {
  work_done_ = {};
  swing_before_.reset();
  if (system_.direction() != 0 && system_.swings_freely()) swing_before_ = system_.swing(y);
}

/// With that of the last step.
StickSlip::Work StickSlip::work_so_far() {
  Work work = work_done_;
  for (int i = 0; i < steps::Collocation::stages; ++i) {
    collocation_.stage(i, work_.data());
    const double weight = steps::RadauTableau::get().b[i] * collocation_.length();
    const double power = weight * system_.swing_power(collocation_.stage_time(i), work_.data());
    work.sum += power, work.size += std::abs(power);
  }
  return work;
}

/// The swing that friction turns by itself, so that slip does no more than touch rest.
double StickSlip::turning_swing(double t, const double* y) const {
  return std::abs(system_.swing_power(t, y) / (2 * system_.velocity_at_rest()));
}

/// True if slip that is lowest in y comes to rest there by the energy that is left: the swing that it has at rest is
/// then wider than where friction alone turns it.
bool StickSlip::rests(const Work& work, double t, const double* y) const {
  const double turn = turning_swing(t, y);
  return *swing_before_ * *swing_before_ + work.sum + work_in_doubt_ * work.size > turn * turn;
}

/// Puts the slider where by the energy it comes to rest: short of steady sliding, to which the spring turns it.
void StickSlip::put_at_rest(const Work& work) {
  constexpr double digit = std::numeric_limits<double>::epsilon(), digits = 4 * digit, least = 1e-15;
  const double before = *swing_before_ * *swing_before_, square = before + work.sum;
  if (!(square > 0)) return;
  const double seen = system_.swing(behind_switch_.data()), V = system_.velocity_at_rest();
  double swing = -system_.direction() * std::sqrt(square);
  if (constexpr double alike = 0.1; std::abs(seen + swing) < alike * std::abs(swing)) swing = -swing;
  system_.set_swing(swing, behind_switch_.data());
  const double error = std::max(tolerance_, least) * work.size + digits * before;
  // Slip that does no more than touch rest ends at the place where friction turns it: of how near it has come to that
  // the last digits of its swing tell, and of the place itself then not even the energy.
  const double turn = turning_swing(collocation_.time(), collocation_.state().data()),
               beyond = std::sqrt(square) - turn;
  const double drive = system_.swing_of_drive(),
               place = std::hypot(beyond, std::sqrt(digit) * drive) - std::abs(beyond);
  const double known = error / (2 * std::abs(swing)) + turn / std::abs(swing) * place;
  rest_ = {.later = (swing - seen) / V, .known = known / std::abs(V)};
}

bool StickSlip::start_slip(double t, std::span<const double> y, double direction) {
  armed_ = switched_ = false;
  upcoming_ = direction;
  system_.set_direction(direction);
  std::vector<double> released(y.begin(), y.end());
  system_.release(t, released.data());
  leave_rest(released.data());
  return begin(t, released);
}

bool StickSlip::start(double t, std::span<const double> y) {
  work_.assign(y.begin(), y.end());
  const double u = system_.slip_rate(t, work_.data());
  armed_ = std::abs(u) > rest * system_.reference_speed();
  system_.set_direction(1);
  upcoming_ = armed_ ? (u > 0 ? 1 : -1) : mode_at_rest(t, work_.data(), 1);
  system_.set_direction(upcoming_);
  switched_ = false;
  swing_before_.reset();
  if (!armed_) leave_rest(work_.data());
  return begin(t, y);
}

Outcome StickSlip::step(double t_limit, Switch& switched) {
  switched = Switch::none;
  const bool had_begun = !switched_ && collocation_.length() > 0;
  if (switched_) {
    const bool stuck = system_.direction() == 0;
    system_.set_direction(upcoming_);
    armed_ = switched_ = false;
    if (stuck) system_.release(collocation_.time(), behind_switch_.data());
    leave_rest(behind_switch_.data());
    double now = rewinds_ ? 0 : collocation_.time();
    if (rest_ && !rewinds_ && now + rest_->later < t_limit) now += rest_->later;
    if (!begin(now, behind_switch_)) return {Ending::not_finite, "after a switch"};
  }
  rest_.reset();
  const double small = rest * system_.reference_speed();
  collocation_.bound_step(system_.direction() == 0 ? infinity : std::min(longest_slip_step_, landing_time()));
  const Outcome outcome = collocation_.step(t_limit);
  if (!outcome.complete()) return outcome;
  // The first node at which the mode has ended, if any.
  double low = 0, high = -1, high_value = 0;
  std::array<double, steps::Collocation::stages + 1> values;
  double low_value = values[0] = indicator(collocation_.time_before(), collocation_.state_before().data());
  const bool sticking = system_.direction() == 0, had_left = sticking ? had_begun : armed_;
  lowest_ = infinity;
  for (int i = 0; i < steps::Collocation::stages; ++i) {
    collocation_.stage(i, work_.data());
    const double value = values[i + 1] = indicator(collocation_.stage_time(i), work_.data());
    const double theta = collocation_.node(i);
    if (!sticking && !armed_) {
      // Slip that has only just begun: rounding must not end it.
      if (value > small) armed_ = true;
      if (value > -small) {
        low = theta, low_value = value;
        continue;
      }
    }
    if (!sticking) lowest_ = std::min(lowest_, value);
    if (value < 0) {
      high = theta, high_value = value;
      break;
    }
    low = theta, low_value = value;
  }
  std::optional<double> touched;
  if (high < 0 && (sticking || armed_)) {
    // The mode may end and begin again between two nodes and not show at either: look at the lowest point between.
    constexpr int fine = 32;
    const auto between = [&](double theta) { return steps::RadauTableau::get().interpolate(values, theta); };
    double lowest = 0;
    for (int i = 1; i < fine; ++i)
      if (between(double(i) / fine) < between(lowest)) lowest = double(i) / fine;
    // In the first part too, where slip still slows down, and in steps so short that slip hardly changes in them.
    constexpr double beside = 1e-3 / fine, low_beside_highest = 0.05;
    const bool sinks_at_first = had_left && between(beside) < between(0),
               rises_at_last = between(1 - beside) < between(1);
    const double value_there = between(lowest), highest = *std::max_element(values.begin(), values.end());
    const bool is_low = value_there < low_beside_highest * highest ||
                        (!sticking && rises_at_last && value_there < doubtful * system_.reference_speed());
    if ((lowest > 0 || sinks_at_first) && is_low) {
      double left = std::max(0.0, lowest - 1.0 / fine), right = lowest + 1.0 / fine;
      for (int i = 0; i < 40; ++i) {  // ternary search
        const double a = left + (right - left) / 3, b = right - (right - left) / 3;
        if (between(a) < between(b))
          right = b;
        else
          left = a;
      }
      const double theta = 0.5 * (left + right);
      if (!collocation_.solve_at(theta, work_.data())) return {Ending::not_finite, "while looking for a switch"};
      const double value = indicator(collocation_.time_at(theta), work_.data());
      if (!sticking) lowest_ = std::min(lowest_, value);
      if (!sticking && value >= 0) {
        if (!swing_before_) {
          if (value < touch_ && (touch_rests_ || holds(collocation_.time_at(theta), work_))) touched = theta;
        } else if (value < doubtful * system_.reference_speed()) {
          const std::vector<double> there = work_;
          const bool by_rounding = touch_rests_ && value < last_digits * system_.reference_speed();
          if (by_rounding || rests(work_so_far(), collocation_.time_at(theta), there.data())) touched = theta;
        }
      }
      if (value < 0) {
        high = theta, high_value = value, low = 0, low_value = values[0];
        for (int i = 0; i < steps::Collocation::stages; ++i)
          if (collocation_.node(i) < theta) low = collocation_.node(i), low_value = values[i + 1];
      }
    }
  }
  if (high < 0 && !touched) {
    if (swing_before_) work_done_ = work_so_far();
    return {};
  }
  const auto located = touched ? touched
                               : collocation_.locate([&](double t, const double* y) { return indicator(t, y); }, low,
                                                     high, std::max(low_value, 0.0), high_value);
  if (!located || !collocation_.shorten(*located)) return {Ending::not_finite, "while locating a switch"};
  const double was = system_.direction();
  behind_switch_ = collocation_.state();
  was == 0 ? system_.hold(behind_switch_.data()) : system_.stop(behind_switch_.data());
  if (swing_before_) put_at_rest(work_so_far());
  upcoming_ = mode_at_rest(collocation_.time(), behind_switch_.data(), was);
  switched_ = true;
  switched = was == 0           ? Switch::slip
             : upcoming_ == 0   ? Switch::stick
             : upcoming_ != was ? Switch::reversal
             : touched          ? Switch::slip
                                : Switch::none;
  return {};
}

}  // namespace rosin::solvers::stick_slip
