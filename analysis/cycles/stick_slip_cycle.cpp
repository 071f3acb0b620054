/// The periodic motion with stick and slip, or with slip alone, refined to the requested tolerance.
#include "analysis/cycles/stick_slip_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "analysis/cycles/balanced_swing.hpp"
#include "analysis/cycles/dry_cycle.hpp"
#include "analysis/cycles/multipliers.hpp"
#include "analysis/cycles/onset_map.hpp"
#include "analysis/cycles/refinement.hpp"
#include "analysis/cycles/return_map.hpp"
#include "analysis/motion/exact_run.hpp"
#include "analysis/steady/curve.hpp"
#include "analysis/steady/stability.hpp"
#include "oscillators/time_scales.hpp"

namespace rosin::analysis::cycles {

using oscillators::SliderSystem;

namespace {

/// True where friction never falls with slip rate, not even from rest. Two motions then never diverge, and the only
/// periodic ones are steady sliding and free oscillations about it, which attract no neighbours.
bool never_weakens(const Model& model) {
  const auto& law = *model.law;
  const double N = model.drive.normal_load.level();
  double limit = static_limit_of_curve(model);
  if (oscillators::remembers(model)) {
    // Static friction recovers at a stop or during rest, or never.
    const auto spent = law.after_stop(law.steady({model.drive.speed.level(), N}));
    for (const double rate : law.rate({0, N}, spent))
      if (rate != 0) return false;
    limit = law.static_limit(N, spent);
  }
  constexpr double nearly_rest = 1e-14, rounding = 1e-12;
  return !steady::weakens_somewhere(law, N) && limit <= law.steady_friction({nearly_rest, N}).friction * (1 + rounding);
}

/// The kind of period that is searched for.
enum class Kind {
  from_stick,
  reversing,      ///< slip reverses in each period, and never sticks
  without_stick,  ///< slip without memory, which may reverse but does not stick for long
};

/// The search for a periodic motion, and its refinement to the requested tolerance.
class StickSlipSearch {
 public:
  StickSlipSearch(const Model& model, const CycleOptions& options)
      : model_(model), options_(options), sharpening_(options.tolerance, 0.2 * options.tolerance) {}
  Cycle find();

 private:
  StickSlipPeriod period_now() const;
  StickSlipPeriod period_from_stick(double tolerance) const;
  StickSlipPeriod period_without_stick(double tolerance) const;
  StickSlipPeriod refined();
  void restart_with_tolerance(double share);
  std::vector<std::complex<double>> multipliers_of(const std::vector<double>& onset, int slips) const;
  OnsetMap onset_map(int slips) const;
  void set_multipliers(Multipliers);
  void update_attraction(const StickSlipPeriod&);
  bool is_neutral();
  bool reversing_period_attracts();
  Outcome why_none(const StickSlipPeriod&) const;
  void compare(const StickSlipPeriod& fine);
  double add_friction_error(const StickSlipPeriod& fine, Metrics& error) const;
  void conclude();

  const Model& model_;
  const CycleOptions& options_;
  Sharpening sharpening_;
  const double V_ = model_.drive.speed.level();
  const double relative_friction_ = std::min(1.0, friction_over_swing(model_));
  const steady::Stability sliding_ = steady::stability(model_);
  const double loose_ = sharpening_.tolerance();
  Kind kind_ = Kind::from_stick;
  std::vector<double> reversed_;  ///< unknowns at the reversal into the drive's direction, if each period has one
  StickSlipPeriod coarse_;
  double attraction_ = 1;                          ///< share of a disturbance of the reversal that decays in a period
  std::vector<std::complex<double>> multipliers_;  ///< multipliers of the last period, where slip reverses
  std::vector<double> onset_;                      ///< onset of slip on the cycle
  int slips_ = 1;
  bool used_newton_ = false;
  std::string worst_;
  Cycle cycle_;
};

StickSlipPeriod StickSlipSearch::period_now() const {
  const double tolerance = sharpening_.tolerance();
  switch (kind_) {
    case Kind::reversing:
      return OnsetMap(model_, tolerance, options_.stick_threshold, Onset::reversed).cycle(&reversed_);
    case Kind::without_stick:
      return period_without_stick(tolerance);
    case Kind::from_stick:
      break;
  }
  return period_from_stick(tolerance);
}

StickSlipPeriod StickSlipSearch::period_from_stick(double tolerance) const {
  // A stop is missed where the error of the solution exceeds the amount by which slip would pass below rest.
  auto period = OnsetMap(model_, tolerance, options_.stick_threshold, Onset::held).cycle();
  constexpr double grazing = 1e-3, surely = 1e-6, sharp = 1e-14;
  const bool missed = !period.found && period.outcome.complete() && period.lowest_slip < grazing;
  // Weak friction hardly enters the error estimate of a step, so that a step may pass over a short rest.
  const bool passed_over =
      missed && !period.reversed.empty() && !oscillators::remembers(model_) && relative_friction_ < 1;
  const double closely = passed_over ? std::max(relative_friction_ * std::min(tolerance, surely), sharp)
                         : period.grazes || (missed && period.reversed.empty()) ? sharp
                                                                                : tolerance;
  if (!(tolerance > closely)) return period;
  auto tighter = OnsetMap(model_, closely, options_.stick_threshold, Onset::held).cycle();
  constexpr double another = 0.1;
  if (period.found && tighter.found && std::abs(tighter.metrics.period / period.metrics.period - 1) > another)
    tighter.outcome = {Ending::tolerance_not_met,
                       fmt::format("by {:.1e} of the drive's speed slip comes to rest or not, and a period has one "
                                   "slip or another number of them",
                                   period.lowest_slip)};
  return tighter;
}

StickSlipPeriod StickSlipSearch::period_without_stick(double tolerance) const {
  const auto balanced = balanced_swing(model_, tolerance);
  if (!balanced.swing) {
    StickSlipPeriod none;
    none.outcome = balanced.outcome;
    return none;
  }
  auto period = slip_return(model_, *balanced.swing, tolerance, options_.stick_threshold, true);
  period.onset_displacement = sliding_.steady.displacement + *balanced.swing;
  return period;
}

/// The period at the current tolerance.
StickSlipPeriod StickSlipSearch::refined() {
  if (!coarse_.found) return coarse_;
  StickSlipPeriod fine = period_now();
  // The transient of many periods from rest need not be repeated: the last onset is a start.
  if (kind_ == Kind::from_stick && fine.outcome.ending == Ending::budget_spent)
    fine = OnsetMap(model_, sharpening_.tolerance(), options_.stick_threshold, Onset::held, coarse_.slips)
               .cycle(&coarse_.onset);
  return sharpening_.loosen(fine.outcome) ? period_now() : fine;
}

/// Restarts with `share` of the first tolerance. Weak attraction magnifies the error of the friction work at every
/// tolerance alike, and weak friction hardly enters the error estimate of a step.
void StickSlipSearch::restart_with_tolerance(double share) {
  constexpr double weakest = 1e-8;
  sharpening_ = Sharpening(options_.tolerance, loose_ * std::clamp(share, weakest, 1.0));
  coarse_ = period_now();
}

std::vector<std::complex<double>> StickSlipSearch::multipliers_of(const std::vector<double>& onset, int slips) const {
  return onset_map(slips).multipliers(onset);
}

OnsetMap StickSlipSearch::onset_map(int slips) const {
  const Onset kind = kind_ == Kind::reversing ? Onset::reversed : Onset::held;
  return {model_, 1e-10, options_.stick_threshold, kind, slips};
}

void StickSlipSearch::set_multipliers(Multipliers known) {
  cycle_.multipliers = std::move(known.values);
  cycle_.multiplier_errors = std::move(known.errors);
  cycle_.multipliers_left_out = std::move(known.left_out);
}

void StickSlipSearch::update_attraction(const StickSlipPeriod& period) {
  multipliers_ = multipliers_of(period.onset, period.slips);
  if (!multipliers_.empty()) attraction_ = 1 - std::abs(multipliers_.front());
}

/// True if friction changes the amplitude by rounding error only (neutral oscillation). The multiplier counts only if
/// the reversals are long, or friction negligible: steps may pass over friction in short reversals.
bool StickSlipSearch::is_neutral() {
  constexpr double rounding = 1e-9, too_weak = 1e-9, clearly = 1e-3;
  if (!coarse_.found) return false;
  update_attraction(coarse_);
  return std::abs(attraction_) < rounding &&
         (relative_friction_ < too_weak || coarse_.metrics.slip_rate_min < -clearly * V_);
}

/// Searches for a period in which slip reverses, at a tolerance that resolves its attraction. False if such
/// oscillations are neutral.
bool StickSlipSearch::reversing_period_attracts() {
  kind_ = Kind::reversing;
  reversed_ = coarse_.reversed;
  coarse_ = period_now();
  bool neutral = is_neutral();
  // At a loose tolerance a neutral oscillation and one that only just reverses, which attracts, look alike.
  if (coarse_.found && !(neutral && relative_friction_ == 1)) {
    const double share = neutral ? relative_friction_ : attraction_ * relative_friction_;
    restart_with_tolerance(share);
    neutral = is_neutral();
    if (const double tighter = attraction_ * relative_friction_; coarse_.found && !neutral && tighter < share)
      restart_with_tolerance(tighter);
  }
  return !neutral;
}

Outcome StickSlipSearch::why_none(const StickSlipPeriod& period) const {
  constexpr double rounding = 1e-13, grazing = 1e-5;
  if (kind_ != Kind::without_stick && period.lowest_slip < rounding) return grazing_outcome(period.lowest_slip);
  if (oscillators::remembers(model_) && !period.settles &&
      (period.lowest_slip < grazing || !(sliding_.stable || sliding_.marginal)))
    return {Ending::budget_spent,
            "slip started from stick has come neither to rest again nor to steady sliding, nor back to where it began"};
  return {Ending::none_exists, "slip started from stick neither sticks again nor keeps an amplitude"};
}

/// Adds the error of friction where slip has just come to rest, or reverses, to `error`. \returns the relative one.
double StickSlipSearch::add_friction_error(const StickSlipPeriod& fine, Metrics& error) const {
  error.friction_min += fine.friction_error;
  if (kind_ == Kind::reversing) error.friction_max += fine.friction_error;
  const double level = std::max(std::abs(fine.metrics.friction_min), std::abs(fine.metrics.friction_max));
  double doubtful = fine.friction_error;
  if (fine.reversal_slip_rate > 0 && fine.reversal_slip_rate < error.slip_rate_max) {
    // Within its error the slip rate is zero there: the contact may also stick, with friction of either sign, while the
    // drive loads the spring by the error of the slip rate.
    const auto& slider = model_.slider;
    const double rest = 2 * std::sqrt(2 * error.slip_rate_max * slider.mass / (slider.stiffness * V_));
    doubtful += 2 * level;
    error.friction_min += 2 * level;
    error.friction_mean += 2 * level * rest / fine.metrics.period;
    error.stick_fraction += rest / fine.metrics.period;
  }
  return doubtful / level;
}

/// Compares a refinement with the one before, and keeps it if its error is the smallest so far.
void StickSlipSearch::compare(const StickSlipPeriod& fine) {
  // Kinks of a tabulated law lie anywhere within a step, and near-neutral reversing motion takes nearly the same steps
  // at other tolerances. The difference of two tolerances then understates the error.
  const bool kinks = std::ranges::any_of(model_.law->parameters(), [](const auto& p) { return p.is_list; });
  const double caution = kinks || kind_ == Kind::reversing ? 10 : 1;
  constexpr double rounding = 1e-15;  // relative rounding error of the reversal's displacement
  if (kind_ == Kind::reversing) update_attraction(fine);
  const double closure = fine.closure + rounding / std::max(std::abs(attraction_), rounding);
  Metrics error;
  double reached = estimate_errors(coarse_.metrics, fine.metrics, sharpening_.tolerance(), closure, V_, false, error,
                                   worst_, caution);
  if (const double part = add_friction_error(fine, error); part > reached) reached = part, worst_ = "friction_min";
  const Outcome outcome = sharpening_.judge(reached, worst_);
  if (!sharpening_.supersedes(cycle_, fine.metrics, error, reached)) return;
  cycle_.metrics = fine.metrics;
  cycle_.error = error;
  cycle_.orbit = fine.orbit;
  cycle_.section_displacement = fine.onset_displacement;
  cycle_.outcome = outcome;
  if (kind_ != Kind::without_stick) onset_ = fine.onset, slips_ = fine.slips, used_newton_ = fine.used_newton;
}

/// Sets the multipliers of the period, and the stability that follows from them.
void StickSlipSearch::conclude() {
  if (kind_ == Kind::without_stick) {
    const double swing = cycle_.section_displacement - sliding_.steady.displacement;
    const auto multiplier = [&](double relative_distance) {
      const double slope = slope_of_swing(model_, swing, options_.stick_threshold, relative_distance);
      return std::vector<std::complex<double>>{slope < 0 ? std::min(1 + slope, std::nextafter(1.0, 0.0)) : 1 + slope};
    };
    set_multipliers(known_multipliers(multiplier(3e-4), multiplier(1e-4)));
    // An oscillation about steady sliding no larger than its error is rounding error.
    if (cycle_.metrics.slip_rate_max - V_ <= cycle_.error.slip_rate_max) {
      const double part = cycle_.metrics.slip_rate_max / V_ - 1;
      cycle_.metrics = {};
      cycle_.orbit.clear();
      cycle_.outcome = {
          Ending::tolerance_not_met,
          fmt::format("slip oscillates about steady sliding by {:.1e} of the drive speed, or by rounding", part)};
      return;
    }
  } else {
    const OnsetMap map = onset_map(slips_);
    auto fine = kind_ == Kind::reversing ? std::move(multipliers_) : map.multipliers(onset_);
    if (options_.multipliers) {
      // Neighbours at three times the distance: a third of the rounding error, nine times the error of curvature.
      const auto coarse = fine.empty() ? fine : map.multipliers(onset_, 3);
      if (coarse.empty())
        cycle_.multipliers_left_out = "multipliers left out: neighbouring periods do not return";
      else
        set_multipliers(known_multipliers(coarse, std::move(fine)));
    } else {
      cycle_.multipliers = std::move(fine);
    }
    if (oscillators::remembers(model_)) cycle_.section_state = SliderSystem(model_).observe(0, onset_.data()).state;
  }
  if (cycle_.multipliers.empty()) return;
  const double largest = std::abs(cycle_.multipliers.front());
  cycle_.stable = largest < 1;
  if (constexpr double certainly = 1.01; used_newton_ && largest > certainly)
    cycle_.outcome = {
        Ending::budget_spent,
        fmt::format("stick and slip do not come to repeat themselves: the period that would repels (largest "
                    "multiplier {:.3g})",
                    largest)};
}

Cycle StickSlipSearch::find() {
  coarse_ = period_now();
  const auto dies_out = [&] { return !coarse_.found && coarse_.outcome.complete(); };
  if (dies_out() && oscillators::remembers(model_) && !coarse_.reversed.empty() && !reversing_period_attracts()) {
    cycle_.outcome = {Ending::none_exists,
                      "friction changes oscillations in which slip reverses by no more than rounding"};
    return cycle_;
  }
  if (dies_out() && !oscillators::remembers(model_) && !sliding_.stable && !sliding_.marginal) {
    kind_ = Kind::without_stick;
    coarse_ = period_now();
    if (coarse_.found) {
      const double swing = coarse_.onset_displacement - sliding_.steady.displacement;
      restart_with_tolerance(-slope_of_swing(model_, swing, options_.stick_threshold));
    }
  }
  while (sharpening_.next()) {
    StickSlipPeriod fine = refined();
    cycle_.cost.steps += fine.steps + coarse_.steps;
    cycle_.cost.evaluations += fine.evaluations + coarse_.evaluations;
    ++cycle_.cost.cycles;
    const bool known = cycle_.metrics.period > 0;
    if (!fine.outcome.complete() && !(known && fine.outcome.ending == Ending::budget_spent)) {
      cycle_.outcome = fine.outcome;
      return cycle_;
    }
    if (!fine.found && known) break;  // the last refinement stays, with its error
    if (!fine.found) {
      cycle_.outcome = why_none(fine);
      return cycle_;
    }
    compare(fine);
    if (cycle_.outcome.complete()) {
      state_with_caution(cycle_.error, cycle_.metrics, options_.tolerance, V_);
      break;
    }
    coarse_ = std::move(fine);
  }
  conclude();
  return cycle_;
}

}  // namespace

Cycle find_stick_slip_cycle(const Model& model, const CycleOptions& options) {
  if (never_weakens(model)) {
    Cycle none;
    none.outcome = {Ending::none_exists, "friction nowhere falls with slip rate: nothing feeds an oscillation"};
    return none;
  }
  const auto dry = motion::dry_oscillator(model);
  if (const auto* oscillator = std::get_if<solvers::stick_slip::DryOscillator>(&dry))
    if (auto exact = find_dry_cycle(*oscillator, options)) return *std::move(exact);
  return StickSlipSearch(model, options).find();
}

}  // namespace rosin::analysis::cycles
