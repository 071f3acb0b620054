/// The cycle that the search found, refined until its metrics are known.
#include "analysis/cycles/smooth_cycle.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/cycles/cycle_search.hpp"
#include "analysis/cycles/multipliers.hpp"
#include "analysis/cycles/refinement.hpp"
#include "analysis/cycles/return_map.hpp"
#include "analysis/steady/stability.hpp"
#include "core/eigenpairs.hpp"

namespace rosin::analysis::cycles {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using oscillators::SliderSystem;

namespace {

/// Metrics of the cycle through `point` at one tolerance; moves the point onto the cycle.
struct Refined {
  Metrics metrics;
  double closure;  ///< remaining change of the section point, in scales
  std::vector<CyclePoint> orbit;
  Outcome outcome;
  Metrics passed_over = {};      ///< what oscillations that steps passed over would change
  std::vector<double> led = {};  ///< s, how long each passage took that led to a swing which friction leaves alone
};
/// What oscillations of the unknowns, so large, change of metrics; of the loop only as a slow one would.
Metrics changed_by(const std::vector<double>& ringing, const SliderSystem& system, const Metrics& metrics) {
  Metrics change;
  double friction = 0, slip_rate = 0;
  if (system.carries_friction()) friction = ringing[system.first_state() - 1];
  if (const int u = system.slip_rate_index(); u >= 0) slip_rate = ringing[u];
  change.slip_rate_min = change.slip_rate_max = slip_rate;
  change.friction_min = change.friction_max = friction;
  change.loop_area = (metrics.friction_max - metrics.friction_min) * slip_rate +
                     (metrics.slip_rate_max - metrics.slip_rate_min) * friction;
  change.loop_area_normalised = change.loop_area / (metrics.slip_rate_max * metrics.friction_max);
  return change;
}
/// The part of an error that a passage forgets; of a swing that friction changes by little in a turn, of an error of
/// the work that friction does. A swing that it leaves alone adds none.
double attraction(const FixedPoint& point, const ReturnMap& map) {
  if (point.free) return 1;
  if (point.swing) {
    // Steps that follow the motion take little notice of friction that hardly moves it.
    constexpr double least_notice = 1e-6;
    const double turnover = point.swing->balance->turnover;
    return std::min(1.0, -point.swing->slope / turnover) * std::clamp(turnover, least_notice, 1.0);
  }
  return std::min(1.0, 1 - spectral_radius(point, map));
}

/// Of the passage from `point` as it is.
Refined record(ReturnMap& map, const FixedPoint& point, double tolerance, const CycleOptions& options,
               bool keep_orbit) {
  Recorder recorder(map.system(), tolerance, options.stick_threshold, keep_orbit);
  const auto passage =
      map.follow(point.y, tolerance, point.turns, true, Derivative::none, &recorder, dip_of(point.amplitude));
  const Metrics metrics = recorder.finish(passage.duration);
  return {metrics, infinity, std::move(recorder.orbit), passage.outcome,
          passage.ringing.empty() ? Metrics{} : changed_by(passage.ringing, map.system(), metrics)};
}
Refined refine(ReturnMap& map, FixedPoint& point, double tolerance, const CycleOptions& options, bool keep_orbit) {
  Refined result{{}, infinity, {}, {}};
  const VectorXd scale = map.scale();
  const MatrixXd I = MatrixXd::Identity(scale.size(), scale.size());
  const auto factorised = [&] {
    return MatrixXd(scale.cwiseInverse().asDiagonal() * (I - point.derivative) * scale.asDiagonal()).partialPivLu();
  };
  auto lu = factorised();
  bool leads = true;  // the derivative does; that of slips at 10¹⁰ V may be all rounding
  bool renew = false;
  double before = infinity, at_renewal = infinity;
  std::vector<double> onward;  // where the last passage ended
  for (int iteration = 0; iteration < 12; ++iteration) {
    const auto passage = map.follow(point.y, tolerance, point.turns, true,
                                    renew ? Derivative::of_steps : Derivative::none, nullptr, dip_of(point.amplitude));
    if (renew && passage.outcome.complete()) {
      FixedPoint renewed = point;
      renewed.derivative = passage.derivative;
      renew = false;
      constexpr double as_before = 0.1;
      const double attracts = 1 - spectral_radius(point, map);
      if (1 - spectral_radius(renewed, map) > as_before * attracts) {  // else rounding
        point.derivative = passage.derivative;
        lu = factorised();
        result.closure = infinity;
      }
    }
    const double change = passage.outcome.complete() ? map.distance(passage.end, point.y) : infinity;
    // What the steps of one passage differ by from those of another is no sign of a wrong derivative.
    constexpr double astray = 10, noise = 100;
    if (leads && change > astray * std::max(before, noise * std::max(tolerance, 1e-14))) {
      point.y = onward;
      leads = false;
      result.closure = infinity;
      continue;
    }
    if (!passage.outcome.complete()) {
      result.outcome = passage.outcome;
      return result;
    }
    VectorXd step = map.difference(passage.end, point.y);
    if (leads) step = scale.asDiagonal() * lu.solve(scale.cwiseInverse().asDiagonal() * step);
    // What is not led there comes nearer by the part that a passage forgets.
    const double length = map.length(step) / (leads ? 1 : std::max(attraction(point, map), 1e-14));
    if (!std::isfinite(length)) break;
    if (length > 0.5 * result.closure) {
      // The derivative is that of the point that was first found, and where slip only just reverses it changes soon.
      constexpr double enough = 1e-3;  // of what is asked: friction about a reversal is that much more sensitive
      const bool wrong = length > std::max(enough * options.tolerance, noise * tolerance);
      if (leads && wrong && !point.by_differences && length < 0.5 * at_renewal) {
        renew = true;
        at_renewal = length;
        continue;
      }
      // Rounding reached: as large as this, or a few times it.
      result.closure = std::max(result.closure, 3 * length);
      break;
    }
    point.y = map.moved(point.y, step, 1);
    onward = passage.end;
    before = change;
    result.closure = length;
    if (length < 0.1 * tolerance * std::min(1.0, point.amplitude)) break;
  }
  const double closure = result.closure;
  result = record(map, point, tolerance, options, keep_orbit);
  result.closure = closure;
  return result;
}

/// The same of a swing that friction changes by little in a turn.
Refined refine_swing(ReturnMap& map, FixedPoint& point, double tolerance, const CycleOptions& options,
                     bool keep_orbit) {
  const auto off = balance_closely(map, *point.swing, tolerance);
  if (!off) return {{}, infinity, {}, {Ending::budget_spent, "swings beside the balanced one do not come round"}};
  point.y = point.swing->balance->y;
  Refined result = record(map, point, tolerance, options, keep_orbit);
  result.closure = *off;
  return result;
}

/// The same of a swing that friction all but leaves alone: it is what the start made it.
Refined refine_free(ReturnMap& map, FixedPoint& point, double tolerance, const CycleOptions& options, bool keep_orbit) {
  auto y = point.free->start;
  std::vector<double> led;
  for (int k = 0; k < point.free->passages; ++k) {
    const auto passage = map.follow(y, tolerance, 1, k > 0, Derivative::none, nullptr, dip_of(point.amplitude));
    if (!passage.outcome.complete()) return {{}, infinity, {}, passage.outcome};
    y = passage.end;
    led.push_back(passage.duration);
  }
  const auto swing = slow_swing_from(map, y, tolerance);
  if (!swing) return {{}, infinity, {}, {Ending::budget_spent, "the swing does not come round in one turn"}};
  point.y = swing->y;
  Refined result = record(map, point, tolerance, options, keep_orbit);
  result.closure = 0;
  result.led = std::move(led);
  return result;
}

/// The largest difference between the passages that led to such a swing at two tolerances, as part of their time: where
/// a start is about to slip, errors of steps may decide whether it does or heals. Nought if they are the same ones.
double led_astray(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double same = 1e-2;
  double largest = 0, time = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    largest = std::max(largest, std::abs(a[k] - b[k]));
    time += std::max(a[k], b[k]);
  }
  return largest > same * time ? largest / time : 0;
}

/// What the last digits of the forces leave of the slip rate of a slider on a contact spring, where damping and not
/// inertia balances them, m/s.
double slip_rate_digits(const SliderSystem& system) {
  const auto& model = system.model();
  const auto& s = model.slider;
  if (system.rigid() || !(s.damping > std::sqrt(s.stiffness * s.mass))) return 0;
  constexpr double digits = 4 * std::numeric_limits<double>::epsilon();
  return digits * (std::abs(steady::steady_sliding(model).friction_force) + std::abs(model.drive.force.level())) /
         s.damping;
}

/// The last digits of the unknowns at y, in scales.
double last_digits(const ReturnMap& map, const std::vector<double>& y) {
  double largest = 0;
  for (std::size_t k = 0; k < map.differential().size(); ++k)
    largest = std::max(largest, std::abs(y[map.differential()[k]]) / map.scale()[k]);
  return std::numeric_limits<double>::epsilon() * largest;
}

/// What metrics change by as the point leaves the cycle by `off`, in scales, along the way that is forgotten last.
Metrics off_the_cycle(ReturnMap& map, const FixedPoint& point, const Metrics& there, double off, double tolerance,
                      const CycleOptions& options) {
  const VectorXd scale = map.scale();
  const auto pairs = eigenpairs(scale.cwiseInverse().asDiagonal() * point.derivative * scale.asDiagonal(), true);
  Eigen::Index slowest = 0;
  pairs.values.cwiseAbs().maxCoeff(&slowest);
  const VectorXd way = pairs.vectors.col(slowest).real().normalized();
  const double far = std::max(off, 1e-6);
  FixedPoint beside = point;
  beside.y = map.moved(point.y, scale.asDiagonal() * way, far);
  const auto seen = record(map, beside, tolerance, options, false);
  Metrics change;
  for (const auto& metric : metric_names())
    change.*metric.member =
        seen.outcome.complete() ? std::abs(seen.metrics.*metric.member - there.*metric.member) * off / far : infinity;
  return change;
}

/// Several turns that were taken together, because each seemed to differ from the next, may prove to be one and the
/// same. True if so; `point` is known to be on the cycle within `closure`, in scales.
bool fewer_turns_do(ReturnMap& map, FixedPoint& point, double tolerance, double closure) {
  constexpr double steps = 100, largest = 1e-2;  // what the steps of one passage differ by from those of another
  const double size = map.distance(point.y, map.system().steady(0));
  const double same = std::min(std::max(10 * closure, steps * tolerance * size), largest * size);
  for (int fewer = 1; 2 * fewer <= point.turns; ++fewer) {
    if (point.turns % fewer != 0) continue;
    const auto passage =
        map.follow(point.y, tolerance, fewer, true, !point.by_differences ? Derivative::of_steps : Derivative::none,
                   nullptr, dip_of(point.amplitude));
    if (!passage.outcome.complete()) continue;
    FixedPoint candidate = point;
    candidate.turns = fewer;
    if (point.by_differences)
      candidate.derivative.setZero();  // bounded by that of all turns, which forget what they began with
    else
      candidate.derivative = passage.derivative;
    // What contracts has a fixed point within twice the distance by which it moves a point.
    const bool contracts = !point.by_differences && spectral_radius(candidate, map) < 0.5;
    if (map.distance(passage.end, point.y) > (contracts ? largest * size : same)) continue;
    point = std::move(candidate);
    return true;
  }
  return false;
}

/// Of the cycle at the point, whose period is known to a part; of a swing that friction hardly changes in a turn, by
/// the work of friction.
Multipliers multipliers_of_cycle(ReturnMap& map, const FixedPoint& point, double known_to) {
  constexpr double well_known = 1e-3;  // else an orbit that closes nearby is another one
  if (!(known_to < well_known))
    return {{}, {}, fmt::format("multipliers left out: the period is known to {:.1g} of itself only", known_to)};
  if (point.free) return {{}, {}, "multipliers left out: friction leaves the swing as its start made it"};
  auto known = cycle_multipliers(map, point.y, point.turns, point.amplitude, !point.swing);
  if (!point.swing) return known;
  const auto& [slope, error] = std::pair(point.swing->slope, point.swing->slope_error);
  if (known.values.empty()) known.values.emplace_back(), known.errors.emplace_back();
  known.values.front() = std::min(1 + slope, std::nextafter(1.0, 0.0));
  known.errors.front() = error + std::numeric_limits<double>::epsilon();
  return known;
}

}  // namespace

Cycle find_smooth_cycle(const Model& model, const CycleOptions& options) {
  Cycle cycle;
  // Growth in one turn of the leading oscillation; of one e-folding time where it does not oscillate.
  const auto leading = steady::stability(model).eigenvalues.front();
  const double turn = 2 * std::numbers::pi / std::max(std::abs(leading.imag()), std::abs(leading.real()));
  ReturnMap map(model);
  if (map.differential().size() < 2) {
    cycle.outcome = {Ending::none_exists, "one unknown alone evolves, and that cannot oscillate (no mass, no memory)"};
    return cycle;
  }
  auto search = search_cycle(map, leading.real() * turn, options);
  cycle.cost = map.cost();
  if (!search.point) {
    cycle.outcome = search.outcome;
    return cycle;
  }
  FixedPoint& point = *search.point;
  const double V = map.drive_speed();
  // Small or weakly attracting cycles magnify errors by 1/A and 1/(1 − ρ).
  const double magnified = std::min(1.0, point.amplitude) * attraction(point, map);
  const double digits = slip_rate_digits(map.system());  // that of the contact follows from friction
  Sharpening sharpening(options.tolerance, 0.2 * options.tolerance * magnified);
  const auto refined = [&](bool keep_orbit) {
    const auto how = point.free ? refine_free : point.swing ? refine_swing : refine;
    return how(map, point, sharpening.tolerance(), options, keep_orbit);
  };
  Refined coarse = refined(false);
  for (int looser = 0; looser < 2 && coarse.outcome.ending == Ending::budget_spent; ++looser) {
    sharpening = Sharpening(options.tolerance, 100 * sharpening.tolerance());
    coarse = refined(false);
  }
  // Asked at each tolerance: turns that differ at one may be the same at a closer one, where slip begins as it must.
  bool fewer = false;
  const auto took_too_many = [&](const Refined& known) {
    constexpr double tells = 1e-3;  // of the size
    if (!known.outcome.complete() || known.closure > tells * map.distance(point.y, map.system().steady(0)) ||
        !fewer_turns_do(map, point, sharpening.tolerance(), known.closure))
      return false;
    return fewer = true;
  };
  if (took_too_many(coarse)) coarse = refined(false);
  std::string worst;
  while (sharpening.next()) {
    Refined fine = refined(true);
    if (coarse.outcome.complete() && sharpening.ease(fine.outcome)) fine = refined(true);
    if (took_too_many(fine)) {
      sharpening = Sharpening(options.tolerance, 100 * sharpening.tolerance());
      coarse = refined(false);
      continue;
    }
    if (!coarse.outcome.complete() || !fine.outcome.complete()) {
      const bool known = cycle.metrics.period > 0 && fine.outcome.ending == Ending::budget_spent;  // as it was before
      if (!known) cycle.outcome = coarse.outcome.complete() ? fine.outcome : coarse.outcome;
      break;
    }
    const double lowest = fine.metrics.slip_rate_min;
    bool stick_is_ill_conditioned = false;
    for (const double e : {options.stick_threshold, 0.01, 0.5})
      if (std::abs(std::abs(lowest) - e * V) < 1e-4 * e * V) stick_is_ill_conditioned = true;
    Metrics error;
    // Rounding in one passage returns with every one that the cycle takes to forget it. Metrics are those of a motion
    // that may be small beside the scales.
    const double rounding = std::max(1e-14, last_digits(map, point.y));
    const double forgetting = rounding / (point.swing ? 1 : std::max(attraction(point, map), 1e-14));
    const double size = map.distance(point.y, map.system().steady(0));
    const double closure = (fine.closure + forgetting) * std::max(1.0, std::min(1.0, point.amplitude) / size) +
                           led_astray(coarse.led, fine.led);
    double reached = estimate_errors(coarse.metrics, fine.metrics, sharpening.tolerance(), closure, V,
                                     stick_is_ill_conditioned, error, worst);
    const auto beside = [&](const Metrics& errors) {
      for (const auto& metric : metric_names()) {
        error.*metric.member += errors.*metric.member;
        if (is_stick(metric) && stick_is_ill_conditioned) continue;
        const double ratio = error.*metric.member / size_of(metric, fine.metrics, V);
        if (ratio > reached) reached = ratio, worst = metric.name;
      }
    };
    beside(fine.passed_over);
    constexpr double weak = 1e-2;
    if (!point.swing && !point.free && !point.by_differences && attraction(point, map) < weak)
      // Rounding may be all that two tolerances differ by, and metrics more sensitive to it than the point is.
      beside(off_the_cycle(map, point, fine.metrics, closure, sharpening.tolerance(), options));
    error.slip_rate_min += digits, error.slip_rate_max += digits;
    const Outcome outcome = sharpening.judge(reached, worst);
    if (sharpening.supersedes(cycle, fine.metrics, error, reached)) {
      cycle.ill_conditioned_stick = stick_is_ill_conditioned;
      cycle.metrics = fine.metrics;
      cycle.error = error;
      cycle.orbit = fine.orbit;
      cycle.outcome = outcome;
    }
    if (cycle.outcome.complete()) {
      state_with_caution(cycle.error, cycle.metrics, options.tolerance, V);
      break;
    }
    coarse = std::move(fine);
  }
  if (options.multipliers) {
    auto known = multipliers_of_cycle(map, point, cycle.error.period / cycle.metrics.period);
    cycle.multipliers = std::move(known.values);
    cycle.multiplier_errors = std::move(known.errors);
    cycle.multipliers_left_out = std::move(known.left_out);
  }
  if (point.free) cycle.growth = point.free->growth;
  // The search goes on until the motion attracts; of fewer turns than differences were taken over, and of a swing that
  // friction leaves alone, its derivative tells nothing.
  const bool unknown = (fewer && point.by_differences) || point.bounded || point.free;
  cycle.stable =
      cycle.multipliers.empty() ? unknown || spectral_radius(point, map) < 1 : std::abs(cycle.multipliers.front()) < 1;
  const auto at_section = map.system().observe(0, point.y.data());
  cycle.section_displacement = at_section.displacement;
  cycle.section_state = at_section.state;
  cycle.cost = map.cost();
  return cycle;
}

}  // namespace rosin::analysis::cycles
