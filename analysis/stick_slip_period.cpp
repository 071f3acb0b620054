/// Stick and slip followed for a period, and what rounding makes of slip that just comes to rest.
#include "analysis/stick_slip_period.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "analysis/return_map.hpp"
#include "analysis/stability.hpp"
#include "solvers/stick_slip.hpp"

namespace rosin::analysis {

using oscillators::SliderSystem;

namespace {
/// Damping of the slider and of steady friction that rises with the slip rate together, N s/m.
double resistance(const Model& model) {
  const double N = model.drive.normal_load.level(), V = model.drive.speed.level();
  return model.slider.damping + N * std::max(model.law->steady_friction({V, N}).slope, 0.0);
}
bool overdamped(const Model& model) {
  return resistance(model) > 2 * std::sqrt(model.slider.mass * model.slider.stiffness);
}
}  // namespace

double swing_time(const Model& model) {
  const auto& s = model.slider;
  return overdamped(model) ? resistance(model) / s.stiffness : 2 * std::numbers::pi * std::sqrt(s.mass / s.stiffness);
}

bool remembers(const Model& model) { return model.law->has_states() && model.lambda > 0; }

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
  std::optional<Bottom> after(const solvers::StickSlip& solver, solvers::Switch switched, double u) {
    const double V = model_.drive.speed.level(), lowest = std::min(solver.lowest(), slip_);
    Bottom bottom{highest_, lowest};
    slip_ = u;
    highest_ = system_.direction() == 0 || switched != solvers::Switch::none ? 0 : std::max(highest_, u);
    if (!(bottom.highest > V)) return std::nullopt;
    if (switched == solvers::Switch::none) return 2 * lowest < u ? std::optional(bottom) : std::nullopt;
    if (switched == solvers::Switch::slip) return bottom;  // at rest for no time
    if (switched != solvers::Switch::stick) return std::nullopt;
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
}  // namespace

StickSlipPeriod stick_slip_period(const Model& model, double tolerance, double stick_threshold,
                                  const std::vector<double>* onset, int slips, Onset kind, long most_steps) {
  StickSlipPeriod result;
  SliderSystem system(model);
  solvers::StickSlip solver(system, tolerance);
  const double V = model.drive.speed.level();
  const auto& s = model.slider;
  const auto rest = model.law->rest(model.drive.normal_load.level());
  if (!(onset ? solver.start_slip(0, *onset, 1) : solver.start(0, system.loaded_at_rest(rest, 0.5)))) {
    result.outcome = {Ending::not_finite, "at the start"};
    return result;
  }
  const double natural = 2 * std::numbers::pi * std::sqrt(s.mass / s.stiffness);
  const double longest_slip = 300 * natural + 10 * std::abs(system.loaded_at_rest(rest, 1)[0]) / V;
  constexpr double strengthened = 1e4;  // the most that rest may add to what the contact holds at first
  solver.rewind_at_switches();          // a slip may be far shorter than the last digit of the stick before it
  const auto sliding = stability(model);
  const double frequency = std::sqrt(s.stiffness / s.mass), swing = swing_time(model);
  constexpr double settled = 1e-5;  // of the drive speed: amplitudes below it decay onto stable sliding
  constexpr double last_digits = 8 * std::numeric_limits<double>::epsilon();
  // Slip rate that so many digits of the spring's force make.
  const double resists = std::max(resistance(model), std::sqrt(s.stiffness * s.mass));
  const auto of_spring = [&](double digits, double x) { return digits * s.stiffness * std::abs(x) / resists; };
  const double noise = of_spring(last_digits, sliding.steady.displacement);
  // Friction that falls with the way of slip alone lets slip end just at rest, but for those digits.
  constexpr double touch = 10, of_digits = 0.1, most = 3e-13;
  // Without memory a turn that is not held begins another as wide, or does not, which decides between cycle and none.
  solver.rest_below(touch * std::max(tolerance, 1e-15) * V + std::min(of_digits * noise, most * V), remembers(model));
  const bool damped = overdamped(model);
  constexpr double many = 200, quiet_enough = 20;  // swings
  double doubt = 0, lowest_dip = infinity;  // s, of when slip came to rest; and how hard it did, of its highest rate
  double quiet = 0;                         // s, in which slip has gone at the drive's speed
  double swings = 0;                        // that slip has gone on for
  // In the plane of displacement and slip rate paths do not cross: what has made a turn without coming to rest stays
  // within it.
  const bool plane = system.rigid() && !remembers(model);
  constexpr int enough_turns = 2;
  double slip_rate_before = 0;
  int turns = 0;
  Recorder recorder(system, tolerance, stick_threshold, true);
  bool began = onset != nullptr, fast = false, reverses = false;
  double slipped = 0, period = 0, stuck = 0, fastest = V, lowest_x = infinity, highest_x = -infinity;
  Bottoms bottoms(model, system);
  // Slip that hardly changes, as where it waits for heat in depth, is no swing; where sliding is stable it is followed
  // in longer and longer steps.
  constexpr double resolved = 0.1, hardly = 1e-3, longer = 1.1;
  double stride = resolved;  // swings
  // What part of their sizes states change by at rest, 1/s.
  const auto fastest_at_rest = [&](const std::vector<double>& y) {
    std::vector<double> rate(system.size()), mass(system.size()), size(system.size());
    system.evaluate(0, y.data(), rate.data());
    system.mass(0, mass.data());
    system.scale(y.data(), size.data());
    double fastest = 0;
    for (int i = system.first_state(); i < system.size(); ++i)
      fastest = std::max(fastest, std::abs(rate[i]) / (mass[i] * size[i]));
    return fastest;
  };
  // Stiff states keep an error of the size that steps estimate, the tolerance to the power 2/3 (see Collocation), and
  // at a reversal, where what drives them turns, none is damped.
  const auto friction_known = [&](const std::vector<double>& y) {
    std::vector<double> size(system.size());
    system.scale(y.data(), size.data());
    const double here = system.friction_coefficient(0, y.data());
    auto beside = y;
    double sum = 0;
    for (int i = system.first_state(); i < system.size(); ++i) {
      beside[i] += std::pow(tolerance, 2.0 / 3) * size[i];
      sum += std::abs(system.friction_coefficient(0, beside.data()) - here);
      beside[i] = y[i];
    }
    return sum;
  };
  // Slip in the plane creeps where friction rises more steeply than a swing needs to turn, and takes so much longer:
  // the last of the slopes is that of the slip rate's own row, in the slip rate.
  std::vector<double> rates(system.size()), slopes(system.size() * system.size());
  const auto swing_at = [&](const std::vector<double>& y) {
    system.linearise(0, y.data(), rates.data(), slopes.data());
    return std::max(swing, -slopes.back() / s.stiffness);
  };
  while (slipped < longest_slip) {
    if (solver.stepper().count().steps > most_steps) {
      result.outcome = {Ending::budget_spent, fmt::format("no period of stick and slip within {} steps", most_steps)};
      break;
    }
    const double swing_here = plane && system.direction() != 0 ? swing_at(solver.state()) : swing;
    solver.bound_slip_step(stride * swing_here);
    solvers::Switch switched;
    const double limit = (solver.upcoming() == 0 ? strengthened : 1) * longest_slip;
    const Outcome outcome = solver.step(limit, switched);
    if (!outcome.complete()) {
      result.outcome = outcome;
      break;
    }
    if (solver.time() >= limit && solver.upcoming() == 0) {
      result.outcome = {Ending::budget_spent, fmt::format("the contact sticks for more than {:.3g} s", limit)};
      break;
    }
    const auto& stop = solver.rest_by_energy();
    slipped = system.direction() == 0 ? 0 : slipped + solver.stepper().length();
    if (began) {
      recorder.step(solver.stepper());
      period += solver.stepper().length();
      if (stop) {
        recorder.linger(stop->later);
        period += stop->later;
      }
      if (system.direction() == 0) stuck += solver.stepper().length();
      lowest_x = std::min(lowest_x, solver.state()[0]), highest_x = std::max(highest_x, solver.state()[0]);
    }
    const double u = system.slip_rate(solver.time(), solver.state().data());
    fast = fast || u > V;
    turns = switched != solvers::Switch::none ? 0 : turns + (slip_rate_before < V && u >= V);
    const bool waits = sliding.stable && std::abs(u - slip_rate_before) < hardly * std::abs(u);
    stride = waits && switched == solvers::Switch::none ? longer * stride : resolved;
    slip_rate_before = u;
    if (plane && turns > enough_turns) break;
    const double away = std::hypot(u - V, frequency * (solver.state()[0] - sliding.steady.displacement));
    quiet = std::abs(u - V) < settled * V + noise ? quiet + solver.stepper().length() : 0;
    const bool slips_on = system.direction() != 0 && switched != solvers::Switch::stick;
    swings = slips_on ? swings + solver.stepper().length() / swing_here : 0;
    result.settles = sliding.stable && (away < settled * V + noise || quiet > quiet_enough * swing);
    if (result.settles) break;
    // Without memory slip that has gone on for so long has found its own cycle.
    if (swings > many && !remembers(model)) break;
    if (fast && switched == solvers::Switch::none) result.closest = std::min(result.closest, solver.lowest() / V);
    if (began) fastest = std::max(fastest, std::abs(u));
    if (const auto bottom = bottoms.after(solver, switched, std::abs(u)); bottom && began) {
      // The time at which slip comes to rest hangs on the last digits of the slip rate.
      if (stop) {
        result.landing += stop->known;
        doubt = stop->known;
      } else if (bottom->deceleration > 0) {
        result.landing += std::max(tolerance, 1e-15) * bottom->highest / bottom->deceleration;
      }
      if (!damped && !stop) {
        // What the highest slip rate and the spring's force have lost in rounding, unless damping made slip forget it,
        // is missing where it just comes to rest, and makes the moment at which it does doubtful: by the time in which
        // the spring makes up for it. States that change at rest keep that.
        constexpr double known = 5e-17, grazing = 100, half_digit = 0.5 * std::numeric_limits<double>::epsilon();
        const double lost = known * bottom->highest + of_spring(half_digit, solver.state()[0]);
        result.grazes |= bottom->dip < grazing * tolerance * bottom->highest;
        lowest_dip = std::min(lowest_dip, bottom->dip / bottom->highest);
        if (switched != solvers::Switch::none)
          doubt = std::sqrt(2 * s.mass / (s.stiffness * V)) *
                  (bottom->dip > lost ? lost / std::sqrt(bottom->dip) : std::sqrt(lost));
      }
    }
    if (switched == solvers::Switch::slip && doubt > 0) {
      result.landing += doubt;
      result.friction = std::max(result.friction, doubt * s.stiffness * V / model.drive.normal_load.level());
      result.rounding += doubt * fastest_at_rest(solver.stepper().state());
      doubt = 0;
      if (result.rounding > 0.1) {
        result.outcome = comes_to_rest_or_not(lowest_dip);
        break;
      }
    }
    reverses = reverses || (began && switched == solvers::Switch::reversal);
    const bool turns_along = switched == solvers::Switch::reversal && solver.upcoming() > 0;
    if (turns_along) {
      result.reversed = solver.state();
      result.friction = std::max(result.friction, friction_known(solver.state()));
    }
    if (turns > 1 || switched == solvers::Switch::stick) result.reversed.clear();
    if (switched != solvers::Switch::slip && !(turns_along && kind == Onset::reversed)) continue;
    if (solver.upcoming() < 0) continue;
    // The mean slip rate is V. Slip that did not pass it, such as rounding makes at its onset, is no period yet.
    if (began && fastest == V) continue;
    if (began && --slips > 0) {
      fastest = V;
      continue;
    }
    if (began) {
      result.metrics = recorder.finish(period);
      result.metrics.stick_fraction = stuck / period;
      // Stick is rest; the end of a located slip is rest but for rounding.
      if (std::abs(result.metrics.slip_rate_min) < 1e-10 * V) {
        if (reverses) result.turns_back = std::max(-result.metrics.slip_rate_min, 0.0);
        result.metrics.slip_rate_min = 0;
      }
      result.orbit = std::move(recorder.orbit);
      result.onset = solver.state();
      result.onset_displacement = result.onset[0];
      // Slip begins where the spring is loaded beyond the last digits of its force.
      const double digits = 1e-14 * std::max(std::abs(lowest_x), std::abs(highest_x));
      result.closure = result.landing / period + digits / (highest_x - lowest_x) + result.rounding;
      result.found = true;
      break;
    }
    began = true;
  }
  result.steps = solver.stepper().count().steps;
  result.evaluations = solver.stepper().count().evaluations;
  return result;
}

}  // namespace rosin::analysis
