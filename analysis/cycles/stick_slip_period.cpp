/// Stick and slip followed for a period, and what rounding makes of slip that just comes to rest.
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

Outcome comes_to_rest_or_not(double share) {
  return {Ending::tolerance_not_met,
          fmt::format("at {:.1e} of the highest slip rate, which is rounding, slip comes to rest or not", share)};
}

namespace {
/// Where slip that was faster than the drive comes down to rest, or turns up again just above it.
struct Bottom {
  double highest;           ///< slip rate of this slip, m/s
  double dip;               ///< how far slip stayed above rest, or would have gone below it had it not stuck
  double deceleration = 0;  ///< m/s², where it came to rest
};
class Bottoms {
 public:
  Bottoms(const Model& model, const SliderSystem& system) : model_(model), system_(system), rate_(system.size()) {}

  /// What the last step, at whose end slip goes at ±u, has come to, if to a bottom.
  std::optional<Bottom> after(const solvers::stick_slip::StickSlip& solver, solvers::stick_slip::Switch switched,
                              double u) {
    const double V = model_.drive.speed.level(), lowest = std::min(solver.lowest(), slip_);
    Bottom bottom{highest_, lowest};
    slip_ = u;
    highest_ = system_.mode() == ContactMode::stick || switched != solvers::stick_slip::Switch::none
                   ? 0
                   : std::max(highest_, u);
    if (!(bottom.highest > V)) return std::nullopt;
    if (switched == solvers::stick_slip::Switch::none) return 2 * lowest < u ? std::optional(bottom) : std::nullopt;
    if (switched == solvers::stick_slip::Switch::slip) return bottom;  // at rest for no time
    if (switched != solvers::stick_slip::Switch::stick) return std::nullopt;
    const auto& s = model_.slider;
    system_.evaluate(solver.time(), solver.stepper().state().data(), rate_.data());
    bottom.deceleration = std::abs(rate_[system_.slip_rate_index()]) / s.mass;
    // The spring, loaded by the drive, would have turned it.
    bottom.dip = 0.5 * bottom.deceleration * bottom.deceleration * s.mass / (s.stiffness * V);
    return bottom;
  }

 private:
  const Model& model_;
  const SliderSystem& system_;
  double highest_ = 0, slip_ = 0;  ///< of this slip: slip rates so far, and at the end of the last step
  std::vector<double> rate_;
};

/// Stick and slip, step by step, until a period is complete or something else is certain.
class PeriodSearch {
 public:
  PeriodSearch(const Model&, double tolerance, double stick_threshold, int slips, Onset, long most_steps);
  StickSlipPeriod from(const std::vector<double>* onset);

 private:
  bool step();
  void record();
  bool needs_no_more();
  void look_for_bottom();
  bool onset_is_known();
  void note_reversals();
  bool completes_period();
  void finish();
  double slip_for(double digits, double displacement) const;
  double swing_here();
  double fastest_at_rest(const std::vector<double>& y) const;
  double friction_known(const std::vector<double>& y) const;

  const Model& model_;
  double tolerance_;
  int slips_;  ///< that the period has yet to have
  Onset kind_;
  long most_steps_;
  StickSlipPeriod result_;
  SliderSystem system_;
  const motion::SliderSwings swings_of_slider_;
  solvers::stick_slip::StickSlip solver_;
  Recorder recorder_;
  Bottoms bottoms_;

  const oscillators::Slider& s_ = model_.slider;
  const double V_ = model_.drive.speed.level();
  const steady::Stability sliding_ = steady::stability(model_);
  const double frequency_ = std::sqrt(s_.stiffness / s_.mass), swing_ = oscillators::swing_time(model_);
  const double resists_ = std::max(oscillators::resistance(model_), std::sqrt(s_.stiffness* s_.mass));
  double longest_slip_ = 0;  ///< s
  double noise_ = 0;         ///< slip rate that last digits of the spring's force make
  /// In the plane of displacement and slip rate paths do not cross: what has made a turn without coming to rest stays
  /// within it.
  const bool plane_ = system_.rigid() && !oscillators::remembers(model_);

  solvers::stick_slip::Switch switched_ = solvers::stick_slip::Switch::none;  ///< at the end of the last step
  double u_ = 0, u_before_ = 0;  ///< slip rates at the ends of the last two
  double swing_in_step_ = 0;     ///< s, for the last step
  double stride_ = resolved;     ///< the longest step, in swings
  bool began_ = false, fast_ = false, reverses_ = false;
  double slipped_ = 0, quiet_ = 0;  ///< s, since stick, and in which slip has gone at the drive's speed
  double swings_ = 0;               ///< that slip has gone on for
  int turns_ = 0;
  double period_ = 0, stuck_ = 0, fastest_ = V_, lowest_x_ = infinity, highest_x_ = -infinity;
  double doubt_ = 0,
         lowest_dip_ = infinity;  ///< s, of when slip came to rest; and how hard it did, of its highest rate

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
      bottoms_(model, system_),
      rates_(system_.size()),
      slopes_(system_.size() * system_.size()) {}

/// Slip rate that so many digits of the spring's force make.
double PeriodSearch::slip_for(double digits, double displacement) const {
  return digits * s_.stiffness * std::abs(displacement) / resists_;
}

/// Slip in the plane creeps where friction rises more steeply than a swing needs to turn, and takes so much longer: the
/// last of the slopes is that of the slip rate's own row, in the slip rate.
double PeriodSearch::swing_here() {
  if (!plane_ || system_.mode() == ContactMode::stick) return swing_;
  system_.linearise(0, solver_.state().data(), rates_.data(), slopes_.data());
  return std::max(swing_, -slopes_.back() / s_.stiffness);
}

/// What part of their sizes states change by at rest, 1/s.
double PeriodSearch::fastest_at_rest(const std::vector<double>& y) const {
  std::vector<double> rate(system_.size()), mass(system_.size()), size(system_.size());
  system_.evaluate(0, y.data(), rate.data());
  system_.mass(0, mass.data());
  system_.scale(y.data(), size.data());
  double fastest = 0;
  for (int i = system_.first_state(); i < system_.size(); ++i)
    fastest = std::max(fastest, std::abs(rate[i]) / (mass[i] * size[i]));
  return fastest;
}

/// To which friction is known at a reversal. Stiff states keep an error of the size that steps estimate, the tolerance
/// to the power 2/3 (see Collocation), and there, where what drives them turns, none is damped.
double PeriodSearch::friction_known(const std::vector<double>& y) const {
  std::vector<double> size(system_.size());
  system_.scale(y.data(), size.data());
  const double here = system_.friction_coefficient(0, y.data());
  auto beside = y;
  double sum = 0;
  for (int i = system_.first_state(); i < system_.size(); ++i) {
    beside[i] += std::pow(tolerance_, 2.0 / 3) * size[i];
    sum += std::abs(system_.friction_coefficient(0, beside.data()) - here);
    beside[i] = y[i];
  }
  return sum;
}

/// False where that ends the search, with the reason.
bool PeriodSearch::step() {
  constexpr double strengthened = 1e4;  // the most that rest may add to what the contact holds at first
  if (solver_.stepper().count().steps > most_steps_) {
    result_.outcome = {Ending::budget_spent, fmt::format("no period of stick and slip within {} steps", most_steps_)};
    return false;
  }
  swing_in_step_ = swing_here();
  solver_.bound_slip_step(stride_ * swing_in_step_);
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
    recorder_.linger(stop->later);
    period_ += stop->later;
  }
  if (system_.mode() == ContactMode::stick) stuck_ += solver_.stepper().length();
  lowest_x_ = std::min(lowest_x_, solver_.state()[0]), highest_x_ = std::max(highest_x_, solver_.state()[0]);
  fastest_ = std::max(fastest_, std::abs(u_));
}

/// True once slip will not come to rest, or has come to steady sliding.
bool PeriodSearch::needs_no_more() {
  constexpr double settled = 1e-5;                 // of the drive speed: amplitudes below it decay onto stable sliding
  constexpr double many = 200, quiet_enough = 20;  // swings
  constexpr int enough_turns = 2;
  fast_ = fast_ || u_ > V_;
  turns_ = switched_ != solvers::stick_slip::Switch::none ? 0 : turns_ + (u_before_ < V_ && u_ >= V_);
  // Slip that hardly changes, as where it waits for heat in depth, is no swing; where sliding is stable it is followed
  // in longer and longer steps.
  constexpr double hardly = 1e-3, longer = 1.1;
  const bool waits = sliding_.stable && std::abs(u_ - u_before_) < hardly * std::abs(u_);
  stride_ = waits && switched_ == solvers::stick_slip::Switch::none ? longer * stride_ : resolved;
  if (plane_ && turns_ > enough_turns) return true;
  const double away = std::hypot(u_ - V_, frequency_ * (solver_.state()[0] - sliding_.steady.displacement));
  quiet_ = std::abs(u_ - V_) < settled * V_ + noise_ ? quiet_ + solver_.stepper().length() : 0;
  const bool slips_on = system_.mode() != ContactMode::stick && switched_ != solvers::stick_slip::Switch::stick;
  swings_ = slips_on ? swings_ + solver_.stepper().length() / swing_in_step_ : 0;
  result_.settles = sliding_.stable && (away < settled * V_ + noise_ || quiet_ > quiet_enough * swing_);
  // Without memory slip that has gone on for so long has found its own cycle.
  return result_.settles || (swings_ > many && !oscillators::remembers(model_));
}

/// Slip that comes to rest, or misses that: how closely, and how well the time is known at which it does.
void PeriodSearch::look_for_bottom() {
  if (fast_ && switched_ == solvers::stick_slip::Switch::none)
    result_.closest = std::min(result_.closest, solver_.lowest() / V_);
  const auto bottom = bottoms_.after(solver_, switched_, std::abs(u_));
  if (!bottom || !began_) return;
  if (const auto& stop = solver_.rest_by_energy()) {
    result_.landing += stop->known;
    doubt_ = stop->known;
    return;
  }
  // The time at which slip comes to rest hangs on the last digits of the slip rate.
  if (bottom->deceleration > 0) result_.landing += std::max(tolerance_, 1e-15) * bottom->highest / bottom->deceleration;
  if (oscillators::overdamped(model_)) return;
  // What the highest slip rate and the spring's force have lost in rounding, unless damping made slip forget it, is
  // missing where it just comes to rest, and makes the moment at which it does doubtful: by the time in which the
  // spring makes up for it. States that change at rest keep that.
  constexpr double known = 5e-17, grazing = 100, half_digit = 0.5 * std::numeric_limits<double>::epsilon();
  const double lost = known * bottom->highest + slip_for(half_digit, solver_.state()[0]);
  result_.grazes |= bottom->dip < grazing * tolerance_ * bottom->highest;
  lowest_dip_ = std::min(lowest_dip_, bottom->dip / bottom->highest);
  if (switched_ != solvers::stick_slip::Switch::none)
    doubt_ = std::sqrt(2 * s_.mass / (s_.stiffness * V_)) *
             (bottom->dip > lost ? lost / std::sqrt(bottom->dip) : std::sqrt(lost));
}

/// Where stick gives way: false, with the reason, if rounding has left nothing known of it.
bool PeriodSearch::onset_is_known() {
  if (switched_ != solvers::stick_slip::Switch::slip || !(doubt_ > 0)) return true;
  result_.landing += doubt_;
  result_.friction = std::max(result_.friction, doubt_ * s_.stiffness * V_ / model_.drive.normal_load.level());
  result_.rounding += doubt_ * fastest_at_rest(solver_.stepper().state());
  doubt_ = 0;
  if (!(result_.rounding > 0.1)) return true;
  result_.outcome = comes_to_rest_or_not(lowest_dip_);
  return false;
}

void PeriodSearch::note_reversals() {
  reverses_ = reverses_ || (began_ && switched_ == solvers::stick_slip::Switch::reversal);
  if (switched_ == solvers::stick_slip::Switch::reversal && solver_.upcoming() == ContactMode::forward) {
    result_.reversed = solver_.state();
    result_.friction = std::max(result_.friction, friction_known(solver_.state()));
  }
  if (turns_ > 1 || switched_ == solvers::stick_slip::Switch::stick) result_.reversed.clear();
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
  // The mean slip rate is V. Slip that did not pass it, such as rounding makes at its onset, is no period yet.
  if (fastest_ == V_) return false;
  fastest_ = V_;
  return --slips_ == 0;
}

void PeriodSearch::finish() {
  auto& metrics = result_.metrics;
  metrics = recorder_.finish(period_);
  metrics.stick_fraction = stuck_ / period_;
  // Stick is rest; the end of a located slip is rest but for rounding.
  if (std::abs(metrics.slip_rate_min) < 1e-10 * V_) {
    if (reverses_) result_.turns_back = std::max(-metrics.slip_rate_min, 0.0);
    metrics.slip_rate_min = 0;
  }
  result_.orbit = std::move(recorder_.orbit);
  result_.onset = solver_.state();
  result_.onset_displacement = result_.onset[0];
  // Slip begins where the spring is loaded beyond the last digits of its force.
  const double digits = 1e-14 * std::max(std::abs(lowest_x_), std::abs(highest_x_));
  result_.closure = result_.landing / period_ + digits / (highest_x_ - lowest_x_) + result_.rounding;
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
  constexpr double last_digits = 8 * std::numeric_limits<double>::epsilon();
  noise_ = slip_for(last_digits, sliding_.steady.displacement);
  solver_.rewind_at_switches();  // a slip may be far shorter than the last digit of the stick before it
  // Friction that falls with the way of slip alone lets slip end just at rest, but for those digits. Without memory a
  // turn that is not held begins another as wide, or does not, which decides between cycle and none.
  constexpr double touch = 10, of_digits = 0.1, most = 3e-13;
  solver_.rest_below(touch * std::max(tolerance_, 1e-15) * V_ + std::min(of_digits * noise_, most * V_),
                     oscillators::remembers(model_));
  while (slipped_ < longest_slip_ && step() && !needs_no_more()) {
    look_for_bottom();
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
