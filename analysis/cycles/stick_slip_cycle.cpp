/// The period of stick and slip, or of slip without stick, that repeats itself, refined until its errors are met.
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

/// True where friction never falls with slip rate, not even from rest: then two motions never part, and none repeats
/// itself but steady sliding (or free oscillation about it, which nothing attracts).
bool never_weakens(const Model& model) {
  const auto& law = *model.law;
  const double N = model.drive.normal_load.level();
  double limit = static_limit_of_curve(model);
  if (oscillators::remembers(model)) {
    // What slip has taken comes back at a stop or at rest, or never.
    const auto spent = law.after_stop(law.steady({model.drive.speed.level(), N}));
    for (const double rate : law.rate({0, N}, spent))
      if (rate != 0) return false;
    limit = law.static_limit(N, spent);
  }
  constexpr double nearly_rest = 1e-14, rounding = 1e-12;
  return !steady::weakens_somewhere(law, N) && limit <= law.steady_friction({nearly_rest, N}).friction * (1 + rounding);
}

/// What a period is looked for as.
enum class Kind {
  from_stick,
  reversing,      ///< slip reverses in each period, and never sticks
  without_stick,  ///< slip without memory, which may reverse but does not stick for long
};

/// The search for a period that repeats itself, and its refinement until the error asked for is met.
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
  void ask_for(double share);
  std::vector<std::complex<double>> multipliers_of(const std::vector<double>& onset, int slips) const;
  OnsetMap onset_map(int slips) const;
  void state(Multipliers);
  void look_at_attraction(const StickSlipPeriod&);
  bool swings_freely();
  bool attracts_reversals();
  Outcome why_none(const StickSlipPeriod&) const;
  void compare(const StickSlipPeriod& fine);
  double doubt_friction(const StickSlipPeriod& fine, Metrics& error) const;
  void conclude();

  const Model& model_;
  const CycleOptions& options_;
  Sharpening sharpening_;
  const double V_ = model_.drive.speed.level();
  const double friction_felt_ = std::min(1.0, friction_over_swing(model_));
  const steady::Stability sliding_ = steady::stability(model_);
  const double loose_ = sharpening_.tolerance();
  Kind kind_ = Kind::from_stick;
  std::vector<double> reversed_;  ///< where slip turns to go along the drive, if it does in each period
  StickSlipPeriod coarse_;
  double attraction_ = 1;                          ///< the part of where slip reverses that a period forgets
  std::vector<std::complex<double>> multipliers_;  ///< of the last period, where slip reverses
  std::vector<double> onset_;                      ///< of the period that the cycle is
  int slips_ = 1;
  bool turned_ = false;
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
  // Slip that only just comes to rest is missed by a solution that is not better than the miss.
  auto period = OnsetMap(model_, tolerance, options_.stick_threshold, Onset::held).cycle();
  constexpr double grazing = 1e-3, surely = 1e-6, sharp = 1e-14;
  const bool missed = !period.found && period.outcome.complete() && period.closest < grazing;
  // Where friction is weak, steps that follow the motion take little notice of it, nor of a short rest.
  const bool passed_over = missed && !period.reversed.empty() && !oscillators::remembers(model_) && friction_felt_ < 1;
  const double closely = passed_over ? std::max(friction_felt_ * std::min(tolerance, surely), sharp)
                         : period.grazes || (missed && period.reversed.empty()) ? sharp
                                                                                : tolerance;
  if (!(tolerance > closely)) return period;
  auto closer = OnsetMap(model_, closely, options_.stick_threshold, Onset::held).cycle();
  constexpr double another = 0.1;
  if (period.found && closer.found && std::abs(closer.metrics.period / period.metrics.period - 1) > another)
    closer.outcome = {Ending::tolerance_not_met,
                      fmt::format("by {:.1e} of the drive's speed slip comes to rest or not, and a period has one "
                                  "slip or another number of them",
                                  period.closest)};
  return closer;
}

StickSlipPeriod StickSlipSearch::period_without_stick(double tolerance) const {
  const auto balanced = balanced_swing(model_, tolerance);
  if (!balanced.swing) {
    StickSlipPeriod none;
    none.outcome = balanced.outcome;
    return none;
  }
  auto period = slip_passage(model_, *balanced.swing, tolerance, options_.stick_threshold, true);
  period.onset_displacement = sliding_.steady.displacement + *balanced.swing;
  return period;
}

/// The period at the next tolerance.
StickSlipPeriod StickSlipSearch::refined() {
  if (!coarse_.found) return coarse_;
  StickSlipPeriod fine = period_now();
  // Many periods from rest, each at no small cost, need not be gone through again.
  if (kind_ == Kind::from_stick && fine.outcome.ending == Ending::budget_spent)
    fine = OnsetMap(model_, sharpening_.tolerance(), options_.stick_threshold, Onset::held, coarse_.slips)
               .cycle(&coarse_.onset);
  return sharpening_.ease(fine.outcome) ? period_now() : fine;
}

/// Begins again with a part of the tolerance. Weak attraction magnifies what steps err in the work of friction, at
/// every tolerance alike; and where friction is weak, steps that follow the motion take little notice of it.
void StickSlipSearch::ask_for(double share) {
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

void StickSlipSearch::state(Multipliers known) {
  cycle_.multipliers = std::move(known.values);
  cycle_.multiplier_errors = std::move(known.errors);
  cycle_.multipliers_left_out = std::move(known.left_out);
}

void StickSlipSearch::look_at_attraction(const StickSlipPeriod& period) {
  multipliers_ = multipliers_of(period.onset, period.slips);
  if (!multipliers_.empty()) attraction_ = 1 - std::abs(multipliers_.front());
}

/// True if friction changes the swings by rounding only. Steps may pass over short reversals, and so tell nothing of
/// friction that is felt there.
bool StickSlipSearch::swings_freely() {
  constexpr double rounding = 1e-9, hardly_felt = 1e-9, clearly = 1e-3;
  if (!coarse_.found) return false;
  look_at_attraction(coarse_);
  return std::abs(attraction_) < rounding &&
         (friction_felt_ < hardly_felt || coarse_.metrics.slip_rate_min < -clearly * V_);
}

/// Looks for a period in which slip reverses, closely enough for what it forgets. False if friction leaves such swings
/// as they are.
bool StickSlipSearch::attracts_reversals() {
  kind_ = Kind::reversing;
  reversed_ = coarse_.reversed;
  coarse_ = period_now();
  bool freely = swings_freely();
  // Steps that take no notice of friction may have swings free, or may have them only just reverse, which attracts.
  if (coarse_.found && !(freely && friction_felt_ == 1)) {
    const double share = freely ? friction_felt_ : attraction_ * friction_felt_;
    ask_for(share);
    freely = swings_freely();
    if (const double closer = attraction_ * friction_felt_; coarse_.found && !freely && closer < share) ask_for(closer);
  }
  return !freely;
}

Outcome StickSlipSearch::why_none(const StickSlipPeriod& period) const {
  constexpr double rounding = 1e-13, by_a_hair = 1e-5;
  if (kind_ != Kind::without_stick && period.closest < rounding) return comes_to_rest_or_not(period.closest);
  if (oscillators::remembers(model_) && !period.settles &&
      (period.closest < by_a_hair || !(sliding_.stable || sliding_.marginal)))
    return {Ending::budget_spent,
            "slip started from stick has come neither to rest again nor to steady sliding, nor back to where it began"};
  return {Ending::none_exists, "slip started from stick neither sticks again nor keeps an amplitude"};
}

/// Adds to the error what is open where slip has just come to rest, or reverses. \returns that of friction, over its
/// level.
double StickSlipSearch::doubt_friction(const StickSlipPeriod& fine, Metrics& error) const {
  error.friction_min += fine.friction;
  if (kind_ == Kind::reversing) error.friction_max += fine.friction;
  const double level = std::max(std::abs(fine.metrics.friction_min), std::abs(fine.metrics.friction_max));
  double doubtful = fine.friction;
  if (fine.turns_back > 0 && fine.turns_back < error.slip_rate_max) {
    // It may as well rest, under friction of either sign, for as long as the spring takes to make up for the doubt.
    const auto& slider = model_.slider;
    const double rest = 2 * std::sqrt(2 * error.slip_rate_max * slider.mass / (slider.stiffness * V_));
    doubtful += 2 * level;
    error.friction_min += 2 * level;
    error.friction_mean += 2 * level * rest / fine.metrics.period;
    error.stick_fraction += rest / fine.metrics.period;
  }
  return doubtful / level;
}

/// Judges a refinement by the one before, and keeps it if it is the best so far.
void StickSlipSearch::compare(const StickSlipPeriod& fine) {
  // Slip that passes the kinks of a table meets them anywhere within its steps; where friction is weak, and only
  // reverses, all but the same steps are taken at other tolerances.
  const bool kinks = std::ranges::any_of(model_.law->parameters(), [](const auto& p) { return p.is_list; });
  const double caution = kinks || kind_ == Kind::reversing ? 10 : 1;
  constexpr double last_digits = 1e-15;  // of what a period forgets of where slip reverses
  if (kind_ == Kind::reversing) look_at_attraction(fine);
  const double closure = fine.closure + last_digits / std::max(std::abs(attraction_), last_digits);
  Metrics error;
  double reached = estimate_errors(coarse_.metrics, fine.metrics, sharpening_.tolerance(), closure, V_, false, error,
                                   worst_, caution);
  if (const double part = doubt_friction(fine, error); part > reached) reached = part, worst_ = "friction_min";
  const Outcome outcome = sharpening_.judge(reached, worst_);
  if (!sharpening_.supersedes(cycle_, fine.metrics, error, reached)) return;
  cycle_.metrics = fine.metrics;
  cycle_.error = error;
  cycle_.orbit = fine.orbit;
  cycle_.section_displacement = fine.onset_displacement;
  cycle_.outcome = outcome;
  if (kind_ != Kind::without_stick) onset_ = fine.onset, slips_ = fine.slips, turned_ = fine.turned;
}

/// Multipliers of the period that was found, and what they make of it.
void StickSlipSearch::conclude() {
  if (kind_ == Kind::without_stick) {
    const double swing = cycle_.section_displacement - sliding_.steady.displacement;
    const auto multiplier = [&](double beside) {
      const double slope = slope_of_swing(model_, swing, options_.stick_threshold, beside);
      return std::vector<std::complex<double>>{slope < 0 ? std::min(1 + slope, std::nextafter(1.0, 0.0)) : 1 + slope};
    };
    state(known_multipliers(multiplier(3e-4), multiplier(1e-4)));
    // A swing about steady sliding that is no larger than its error is rounding, where friction hardly moves the
    // slider.
    if (cycle_.metrics.slip_rate_max - V_ <= cycle_.error.slip_rate_max) {
      const double part = cycle_.metrics.slip_rate_max / V_ - 1;
      cycle_.metrics = {};
      cycle_.orbit.clear();
      cycle_.outcome = {
          Ending::tolerance_not_met,
          fmt::format("slip swings about steady sliding by {:.1e} of the drive speed, or by rounding", part)};
      return;
    }
  } else {
    const OnsetMap map = onset_map(slips_);
    auto fine = kind_ == Kind::reversing ? std::move(multipliers_) : map.multipliers(onset_);
    if (options_.multipliers) {
      // Neighbours at three times the distance, whose differences are that much less rounded and nine times as bent.
      const auto coarse = fine.empty() ? fine : map.multipliers(onset_, 3);
      if (coarse.empty())
        cycle_.multipliers_left_out = "multipliers left out: neighbouring periods do not return";
      else
        state(known_multipliers(coarse, std::move(fine)));
    } else {
      cycle_.multipliers = std::move(fine);
    }
    if (oscillators::remembers(model_)) cycle_.section_state = SliderSystem(model_).observe(0, onset_.data()).state;
  }
  if (cycle_.multipliers.empty()) return;
  const double largest = std::abs(cycle_.multipliers.front());
  cycle_.stable = largest < 1;
  if (constexpr double certainly = 1.01; turned_ && largest > certainly)
    cycle_.outcome = {
        Ending::budget_spent,
        fmt::format("stick and slip do not come to repeat themselves: the period that would repels (largest "
                    "multiplier {:.3g})",
                    largest)};
}

Cycle StickSlipSearch::find() {
  coarse_ = period_now();
  const auto dies_out = [&] { return !coarse_.found && coarse_.outcome.complete(); };
  if (dies_out() && oscillators::remembers(model_) && !coarse_.reversed.empty() && !attracts_reversals()) {
    cycle_.outcome = {Ending::none_exists, "friction changes swings in which slip reverses by no more than rounding"};
    return cycle_;
  }
  if (dies_out() && !oscillators::remembers(model_) && !sliding_.stable && !sliding_.marginal) {
    kind_ = Kind::without_stick;
    coarse_ = period_now();
    if (coarse_.found) {
      const double swing = coarse_.onset_displacement - sliding_.steady.displacement;
      ask_for(-slope_of_swing(model_, swing, options_.stick_threshold));
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
    if (!fine.found && known) break;  // what was found before stays, as it was known
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
