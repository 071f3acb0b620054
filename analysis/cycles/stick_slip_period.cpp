/// One period of stick and slip, with the effect of rounding error on slip that just comes to rest.
#include "analysis/cycles/stick_slip_period.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "analysis/cycles/return_map.hpp"
#include "analysis/motion/slider_swings.hpp"
#include "analysis/steady/stability.hpp"
#include "oscillators/time_scales.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace rosin::analysis::cycles {

using oscillators::SliderSystem;

Outcome grazing_outcome(double share) {
  return {Ending::tolerance_not_met,
          fmt::format("at {:.1e} of the highest slip rate, which is rounding, slip comes to rest or not", share)};
}

namespace {
/// A minimum of the slip rate, at rest or above it, after slip that was faster than the drive.
struct SlipMinimum {
  double highest;  ///< highest slip rate of this slip, m/s
  double dip;  ///< distance of the minimum from zero slip rate, m/s; at a stop, below zero had the contact not stuck
  double deceleration = 0;  ///< m/s², where it came to rest
};
class SlipMinima {
 public:
  SlipMinima(const Model& model, const SliderSystem& system) : model_(model), system_(system), rate_(system.size()) {}

  /// The minimum of the slip rate in the last step, if it has one; ±u is the slip rate at its end.
  std::optional<SlipMinimum> after(const solvers::stick_slip::StickSlip& solver, solvers::stick_slip::Switch switched,
                                   double u) {
    const double V = model_.drive.speed.level(), lowest = std::min(solver.lowest(), slip_);
    SlipMinimum minimum{highest_, lowest};
    slip_ = u;
    highest_ = system_.mode() == ContactMode::stick || switched != solvers::stick_slip::Switch::none
                   ? 0
                   : std::max(highest_, u);
    if (!(minimum.highest > V)) return std::nullopt;
    if (switched == solvers::stick_slip::Switch::none) return 2 * lowest < u ? std::optional(minimum) : std::nullopt;
    if (switched == solvers::stick_slip::Switch::slip) return minimum;  // at rest for no time
    if (switched != solvers::stick_slip::Switch::stick) return std::nullopt;
    const auto& s = model_.slider;
    system_.evaluate(solver.time(), solver.stepper().state().data(), rate_.data());
    minimum.deceleration = std::abs(rate_[system_.slip_rate_index()]) / s.mass;
    // Without stick the drive's loading of the spring would have reversed the acceleration here.
    minimum.dip = 0.5 * minimum.deceleration * minimum.deceleration * s.mass / (s.stiffness * V);
    return minimum;
  }

 private:
  const Model& model_;
  const SliderSystem& system_;
  double highest_ = 0, slip_ = 0;  ///< highest slip rate of this slip so far, and slip rate at the end of the last step
  std::vector<double> rate_;
};

/// Stick and slip, step by step, until a period is complete or known not to exist.
class PeriodSearch {
 public:
  PeriodSearch(const Model&, double tolerance, double stick_threshold, int slips, Onset, long most_steps);
  StickSlipPeriod from(const std::vector<double>* onset);

 private:
  bool step();
  void record();
  bool is_decided();
  void note_slip_minimum();
  bool onset_is_known();
  void note_reversals();
  bool completes_period();
  void finish();
  double slip_rate_of_rounding(double digits, double displacement) const;
  double local_swing_time();
  double fastest_state_rate(const std::vector<double>& y) const;
  double friction_error(const std::vector<double>& y) const;

  const Model& model_;
  double tolerance_;
  int slips_;  ///< slips still to come in this period
  Onset kind_;
  long most_steps_;
  StickSlipPeriod result_;
  SliderSystem system_;
  const motion::SliderSwings swings_of_slider_;
  solvers::stick_slip::StickSlip solver_;
  Recorder recorder_;
  SlipMinima minima_;

  const oscillators::Slider& s_ = model_.slider;
  const double V_ = model_.drive.speed.level();
  const steady::Stability sliding_ = steady::stability(model_);
  const double frequency_ = std::sqrt(s_.stiffness / s_.mass), swing_time_ = oscillators::swing_time(model_);
  const double resistance_ = std::max(oscillators::resistance(model_), std::sqrt(s_.stiffness* s_.mass));
  double longest_slip_ = 0;        ///< s
  double rounding_slip_rate_ = 0;  ///< slip rate from rounding error of the spring force, m/s
  /// Without memory the state is (displacement, slip rate), and trajectories in a plane do not cross: motion that has
  /// gone round once without coming to rest stays within that loop.
  const bool plane_ = system_.rigid() && !oscillators::remembers(model_);

  solvers::stick_slip::Switch switched_ = solvers::stick_slip::Switch::none;  ///< at the end of the last step
  double u_ = 0, u_before_ = 0;     ///< slip rates at the ends of the last two steps
  double swing_time_in_step_ = 0;   ///< s, at the last step
  double longest_step_ = resolved;  ///< in swing times
  bool began_ = false, fast_ = false, reverses_ = false;
  double slipped_ = 0, steady_time_ = 0;  ///< duration of slip since stick, and of slip at the drive speed, s
  double slip_in_swings_ = 0;             ///< duration of this slip in swing times
  int upward_crossings_ = 0;
  double period_ = 0, stick_time_ = 0, fastest_ = V_, lowest_x_ = infinity, highest_x_ = -infinity;
  double onset_time_error_ = 0,
         lowest_dip_ = infinity;  ///< error of the last stop's time, s; smallest dip over the highest slip rate

  static constexpr double resolved = 0.1;
  std::vector<double> rates_, slopes_;  ///< scratch
};

PeriodSearch::PeriodSearch(const Model& model, double tolerance, double stick_threshold, int slips, Onset kind,
                           long most_steps)
    : model_(model),
      tolerance_(tolerance),
      slips_(slips),
      kind_(kind),
      most_steps_(most_steps),
      system_(model),
      swings_of_slider_(system_),
      solver_(system_, tolerance, swings_of_slider_.present()),
      recorder_(system_, tolerance, stick_threshold, true),
      minima_(model, system_),
      rates_(system_.size()),
      slopes_(system_.size() * system_.size()) {}

/// Slip rate from a relative error `digits` of the spring force.
double PeriodSearch::slip_rate_of_rounding(double digits, double displacement) const {
  return digits * s_.stiffness * std::abs(displacement) / resistance_;
}

/// The swing time, or the longer time of creep where friction rises so steeply with the slip rate that the slider is
/// overdamped there. The last entry of the Jacobian is ∂(m u̇)/∂u.
double PeriodSearch::local_swing_time() {
  if (!plane_ || system_.mode() == ContactMode::stick) return swing_time_;
  system_.linearise(0, solver_.state().data(), rates_.data(), slopes_.data());
  return std::max(swing_time_, -slopes_.back() / s_.stiffness);
}

/// Fastest relative rate of the states at rest, 1/s.
double PeriodSearch::fastest_state_rate(const std::vector<double>& y) const {
  std::vector<double> rate(system_.size()), mass(system_.size()), size(system_.size());
  system_.evaluate(0, y.data(), rate.data());
  system_.mass(0, mass.data());
  system_.scale(y.data(), size.data());
  double fastest = 0;
  for (int i = system_.first_state(); i < system_.size(); ++i)
    fastest = std::max(fastest, std::abs(rate[i]) / (mass[i] * size[i]));
  return fastest;
}

/// Error of the friction coefficient at a reversal. The error of stiff states is the tolerance to the power 2/3 of
/// their size (see Collocation), and at a reversal, where the slip rate that drives them changes sign, it is not yet
/// damped.
double PeriodSearch::friction_error(const std::vector<double>& y) const {
  std::vector<double> size(system_.size());
  system_.scale(y.data(), size.data());
  const double here = system_.friction_coefficient(0, y.data());
  auto neighbour = y;
  double sum = 0;
  for (int i = system_.first_state(); i < system_.size(); ++i) {
    neighbour[i] += std::pow(tolerance_, 2.0 / 3) * size[i];
    sum += std::abs(system_.friction_coefficient(0, neighbour.data()) - here);
    neighbour[i] = y[i];
  }
  return sum;
}

/// Takes one step. False where the search ends with it; the outcome gives the reason.
bool PeriodSearch::step() {
  constexpr double strengthened = 1e4;  // static friction after rest over the first, at most
  if (solver_.stepper().count().steps > most_steps_) {
    result_.outcome = {Ending::budget_spent, fmt::format("no period of stick and slip within {} steps", most_steps_)};
    return false;
  }
  swing_time_in_step_ = local_swing_time();
  solver_.bound_slip_step(longest_step_ * swing_time_in_step_);
  const double limit = (solver_.upcoming() == ContactMode::stick ? strengthened : 1) * longest_slip_;
  if (const Outcome outcome = solver_.step(limit, switched_); !outcome.complete()) {
    result_.outcome = outcome;
    return false;
  }
  if (solver_.time() >= limit && solver_.upcoming() == ContactMode::stick) {
    result_.outcome = {Ending::budget_spent, fmt::format("the contact sticks for more than {:.3g} s", limit)};
    return false;
  }
  slipped_ = system_.mode() == ContactMode::stick ? 0 : slipped_ + solver_.stepper().length();
  u_before_ = u_;
  u_ = system_.slip_rate(solver_.time(), solver_.state().data());
  if (began_) record();
  return true;
}

void PeriodSearch::record() {
  recorder_.step(solver_.stepper());
  period_ += solver_.stepper().length();
  if (const auto& stop = solver_.rest_by_energy()) {
    recorder_.add_rest(stop->later);
    period_ += stop->later;
  }
  if (system_.mode() == ContactMode::stick) stick_time_ += solver_.stepper().length();
  lowest_x_ = std::min(lowest_x_, solver_.state()[0]), highest_x_ = std::max(highest_x_, solver_.state()[0]);
  fastest_ = std::max(fastest_, std::abs(u_));
}

/// True once slip is known never to rest, or has come to steady sliding.
bool PeriodSearch::is_decided() {
  constexpr double settled = 1e-5;                // of the drive speed: amplitudes below it decay onto stable sliding
  constexpr double many = 200, long_enough = 20;  // swings
  constexpr int enough_crossings = 2;
  fast_ = fast_ || u_ > V_;
  upward_crossings_ =
      switched_ != solvers::stick_slip::Switch::none ? 0 : upward_crossings_ + (u_before_ < V_ && u_ >= V_);
  // Slip whose rate hardly changes, as while heat spreads in depth, is no oscillation; where sliding is stable the
  // steps grow by 1.1 each.
  constexpr double hardly = 1e-3, longer = 1.1;
  const bool waits = sliding_.stable && std::abs(u_ - u_before_) < hardly * std::abs(u_);
  longest_step_ = waits && switched_ == solvers::stick_slip::Switch::none ? longer * longest_step_ : resolved;
  if (plane_ && upward_crossings_ > enough_crossings) return true;
  const double distance = std::hypot(u_ - V_, frequency_ * (solver_.state()[0] - sliding_.steady.displacement));
  steady_time_ = std::abs(u_ - V_) < settled * V_ + rounding_slip_rate_ ? steady_time_ + solver_.stepper().length() : 0;
  const bool slips_on = system_.mode() != ContactMode::stick && switched_ != solvers::stick_slip::Switch::stick;
  slip_in_swings_ = slips_on ? slip_in_swings_ + solver_.stepper().length() / swing_time_in_step_ : 0;
  result_.settles =
      sliding_.stable && (distance < settled * V_ + rounding_slip_rate_ || steady_time_ > long_enough * swing_time_);
  // Without memory, slip over 200 swing times has settled on a cycle of its own.
  return result_.settles || (slip_in_swings_ > many && !oscillators::remembers(model_));
}

/// Records how closely slip comes to rest, and the error of the time at which it does.
void PeriodSearch::note_slip_minimum() {
  if (fast_ && switched_ == solvers::stick_slip::Switch::none)
    result_.lowest_slip = std::min(result_.lowest_slip, solver_.lowest() / V_);
  const auto minimum = minima_.after(solver_, switched_, std::abs(u_));
  if (!minimum || !began_) return;
  if (const auto& stop = solver_.rest_by_energy()) {
    result_.stop_time_error += stop->known;
    onset_time_error_ = stop->known;
    return;
  }
  // The time of the stop has the error of the slip rate over the deceleration.
  if (minimum->deceleration > 0)
    result_.stop_time_error += std::max(tolerance_, 1e-15) * minimum->highest / minimum->deceleration;
  if (oscillators::overdamped(model_)) return;
  // Rounding of the highest slip rate (5·10⁻¹⁷ of it) and of the spring force leaves the lowest slip rate uncertain by
  // `lost`. If slip only just comes to rest, the time of the stop is uncertain by √(2 m lost/(k V)), the time in which
  // the drive supplies that much; states that evolve at rest inherit it.
  constexpr double known = 5e-17, grazing = 100, half_digit = 0.5 * std::numeric_limits<double>::epsilon();
  const double lost = known * minimum->highest + slip_rate_of_rounding(half_digit, solver_.state()[0]);
  result_.grazes |= minimum->dip < grazing * tolerance_ * minimum->highest;
  lowest_dip_ = std::min(lowest_dip_, minimum->dip / minimum->highest);
  if (switched_ != solvers::stick_slip::Switch::none)
    onset_time_error_ = std::sqrt(2 * s_.mass / (s_.stiffness * V_)) *
                        (minimum->dip > lost ? lost / std::sqrt(minimum->dip) : std::sqrt(lost));
}

/// Carries the error of the stop's time over to the next onset of slip. False, with the reason, if rounding error
/// leaves the states there undetermined.
bool PeriodSearch::onset_is_known() {
  if (switched_ != solvers::stick_slip::Switch::slip || !(onset_time_error_ > 0)) return true;
  result_.stop_time_error += onset_time_error_;
  result_.friction_error =
      std::max(result_.friction_error, onset_time_error_ * s_.stiffness * V_ / model_.drive.normal_load.level());
  result_.rounding += onset_time_error_ * fastest_state_rate(solver_.stepper().state());
  onset_time_error_ = 0;
  if (!(result_.rounding > 0.1)) return true;
  result_.outcome = grazing_outcome(lowest_dip_);
  return false;
}

void PeriodSearch::note_reversals() {
  reverses_ = reverses_ || (began_ && switched_ == solvers::stick_slip::Switch::reversal);
  if (switched_ == solvers::stick_slip::Switch::reversal && solver_.upcoming() == ContactMode::forward) {
    result_.reversed = solver_.state();
    result_.friction_error = std::max(result_.friction_error, friction_error(solver_.state()));
  }
  if (upward_crossings_ > 1 || switched_ == solvers::stick_slip::Switch::stick) result_.reversed.clear();
}

/// True at an onset along the drive that ends the last slip of a period. The first onset begins one.
bool PeriodSearch::completes_period() {
  const bool onset = switched_ == solvers::stick_slip::Switch::slip ||
                     (switched_ == solvers::stick_slip::Switch::reversal && kind_ == Onset::reversed);
  if (!onset || !(solver_.upcoming() == ContactMode::forward)) return false;
  if (!began_) {
    began_ = true;
    return false;
  }
  // The mean slip rate is V. Slip that stays below V, such as rounding error at the onset makes, completes no period.
  if (fastest_ == V_) return false;
  fastest_ = V_;
  return --slips_ == 0;
}

void PeriodSearch::finish() {
  auto& metrics = result_.metrics;
  metrics = recorder_.finish(period_);
  metrics.stick_fraction = stick_time_ / period_;
  // Stick is rest; the located end of slip is rest to within rounding error.
  if (std::abs(metrics.slip_rate_min) < 1e-10 * V_) {
    if (reverses_) result_.reversal_slip_rate = std::max(-metrics.slip_rate_min, 0.0);
    metrics.slip_rate_min = 0;
  }
  result_.orbit = std::move(recorder_.orbit);
  result_.onset = solver_.state();
  result_.onset_displacement = result_.onset[0];
  // The displacement at the onset is known to rounding error of the spring force.
  const double digits = 1e-14 * std::max(std::abs(lowest_x_), std::abs(highest_x_));
  result_.closure = result_.stop_time_error / period_ + digits / (highest_x_ - lowest_x_) + result_.rounding;
  result_.found = true;
}

StickSlipPeriod PeriodSearch::from(const std::vector<double>* onset) {
  const auto rest = model_.law->rest(model_.drive.normal_load.level());
  if (!(onset ? solver_.start_slip(0, *onset, ContactMode::forward)
              : solver_.start(0, system_.loaded_at_rest(rest, 0.5)))) {
    result_.outcome = {Ending::not_finite, "at the start"};
    return std::move(result_);
  }
  began_ = onset != nullptr;
  const double natural = 2 * std::numbers::pi * std::sqrt(s_.mass / s_.stiffness);
  longest_slip_ = 300 * natural + 10 * std::abs(system_.loaded_at_rest(rest, 1)[0]) / V_;
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  rounding_slip_rate_ = slip_rate_of_rounding(rounding, sliding_.steady.displacement);
  solver_.rewind_at_switches();  // slip may be far shorter than the rounding error of the time of stick before it
  // Friction that falls with slip distance alone lets slip end just at rest, to within rounding error of the slip rate.
  // Without memory the choice between stick and another oscillation as wide decides between a cycle and none.
  constexpr double touch = 10, of_digits = 0.1, most = 3e-13;
  solver_.rest_below(touch * std::max(tolerance_, 1e-15) * V_ + std::min(of_digits * rounding_slip_rate_, most * V_),
                     oscillators::remembers(model_));
  while (slipped_ < longest_slip_ && step() && !is_decided()) {
    note_slip_minimum();
    if (!onset_is_known()) break;
    note_reversals();
    if (completes_period()) {
      finish();
      break;
    }
  }
  result_.steps = solver_.stepper().count().steps;
  result_.evaluations = solver_.stepper().count().evaluations;
  return std::move(result_);
}

}  // namespace

StickSlipPeriod stick_slip_period(const Model& model, double tolerance, double stick_threshold,
                                  const std::vector<double>* onset, int slips, Onset kind, long most_steps) {
  return PeriodSearch(model, tolerance, stick_threshold, slips, kind, most_steps).from(onset);
}

}  // namespace rosin::analysis::cycles
