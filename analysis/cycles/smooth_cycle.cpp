/// The cycle of a smooth law: search, then refinement to the requested tolerance.
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
  double closure;  ///< last change of the section point, in scales
  std::vector<CyclePoint> orbit;
  Outcome outcome;
  Metrics passed_over = {};               ///< errors from oscillations that steps passed over
  std::vector<double> return_times = {};  ///< s, durations of the returns before a neutral oscillation
};
/// Change of the metrics by oscillations of the unknowns with amplitudes `ringing`. The loop area changes as if the
/// oscillation were slow.
Metrics metrics_changed_by_ringing(const std::vector<double>& ringing, const SliderSystem& system,
                                   const Metrics& metrics) {
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
/// The part of an error that decays in a return. For a slow swing the error counts in the work of friction; for a
/// neutral oscillation errors do not grow.
double attraction(const FixedPoint& point, const ReturnMap& map) {
  if (point.free) return 1;
  if (point.swing) {
    // Weak friction hardly enters the error estimate of a step.
    constexpr double least_notice = 1e-6;
    const double turnover = point.swing->balance->turnover;
    return std::min(1.0, -point.swing->slope / turnover) * std::clamp(turnover, least_notice, 1.0);
  }
  return std::min(1.0, 1 - spectral_radius(point, map));
}

/// Metrics of the return from `point`, without moving it.
Refined record(ReturnMap& map, const FixedPoint& point, double tolerance, const CycleOptions& options,
               bool keep_orbit) {
  Recorder recorder(map.system(), tolerance, options.stick_threshold, keep_orbit);
  const auto returned =
      map.follow(point.y, tolerance, point.returns, true, Derivative::none, &recorder, dip_of(point.amplitude));
  const Metrics metrics = recorder.finish(returned.duration);
  return {metrics, infinity, std::move(recorder.orbit), returned.outcome,
          returned.ringing.empty() ? Metrics{} : metrics_changed_by_ringing(returned.ringing, map.system(), metrics)};
}
Refined refine(ReturnMap& map, FixedPoint& point, double tolerance, const CycleOptions& options, bool keep_orbit) {
  Refined result{{}, infinity, {}, {}};
  const VectorXd scale = map.scale();
  const MatrixXd I = MatrixXd::Identity(scale.size(), scale.size());
  const auto factorised = [&] {
    return MatrixXd(scale.cwiseInverse().asDiagonal() * (I - point.derivative) * scale.asDiagonal()).partialPivLu();
  };
  auto lu = factorised();
  bool newton_converges = true;  // false where the derivative is all rounding error, as after slips at 10¹⁰ V
  bool renew = false;
  double before = infinity, at_renewal = infinity;
  std::vector<double> last_end;  // end of the last return
  for (int iteration = 0; iteration < 12; ++iteration) {
    const auto returned = map.follow(point.y, tolerance, point.returns, true,
                                     renew ? Derivative::of_steps : Derivative::none, nullptr, dip_of(point.amplitude));
    if (renew && returned.outcome.complete()) {
      FixedPoint renewed = point;
      renewed.derivative = returned.derivative;
      renew = false;
      constexpr double as_before = 0.1;
      const double attracts = 1 - spectral_radius(point, map);
      if (1 - spectral_radius(renewed, map) > as_before * attracts) {  // a smaller distance from 1 is rounding error
        point.derivative = returned.derivative;
        lu = factorised();
        result.closure = infinity;
      }
    }
    const double change = returned.outcome.complete() ? map.distance(returned.end, point.y) : infinity;
    // A growth within 100 tolerances is the scatter of the steps, and no sign of a wrong derivative.
    constexpr double diverging = 10, noise = 100;
    if (newton_converges && change > diverging * std::max(before, noise * std::max(tolerance, 1e-14))) {
      point.y = last_end;
      newton_converges = false;
      result.closure = infinity;
      continue;
    }
    if (!returned.outcome.complete()) {
      result.outcome = returned.outcome;
      return result;
    }
    VectorXd step = map.difference(returned.end, point.y);
    if (newton_converges) step = scale.asDiagonal() * lu.solve(scale.cwiseInverse().asDiagonal() * step);
    // Plain returns approach the fixed point only by the part of the distance that decays in each.
    const double length = map.length(step) / (newton_converges ? 1 : std::max(attraction(point, map), 1e-14));
    if (!std::isfinite(length)) break;
    if (length > 0.5 * result.closure) {
      // The derivative belongs to the first point; where slip only just reverses it varies strongly.
      constexpr double enough =
          1e-3;  // of the requested tolerance: friction about a reversal is that much more sensitive
      const bool wrong = length > std::max(enough * options.tolerance, noise * tolerance);
      if (newton_converges && wrong && !point.by_differences && length < 0.5 * at_renewal) {
        renew = true;
        at_renewal = length;
        continue;
      }
      // The step has stopped shrinking: rounding error, of a few times its length.
      result.closure = std::max(result.closure, 3 * length);
      break;
    }
    point.y = map.moved(point.y, step, 1);
    last_end = returned.end;
    before = change;
    result.closure = length;
    if (length < 0.1 * tolerance * std::min(1.0, point.amplitude)) break;
  }
  const double closure = result.closure;
  result = record(map, point, tolerance, options, keep_orbit);
  result.closure = closure;
  return result;
}

/// The same for a swing, whose amplitude friction changes by little in a period.
Refined refine_swing(ReturnMap& map, FixedPoint& point, double tolerance, const CycleOptions& options,
                     bool keep_orbit) {
  const auto off = balance_closely(map, *point.swing, tolerance);
  if (!off) return {{}, infinity, {}, {Ending::budget_spent, "oscillations beside the balanced one do not return"}};
  point.y = point.swing->balance->y;
  Refined result = record(map, point, tolerance, options, keep_orbit);
  result.closure = *off;
  return result;
}

/// The same for a nearly neutral oscillation, whose amplitude the start has set.
Refined refine_free(ReturnMap& map, FixedPoint& point, double tolerance, const CycleOptions& options, bool keep_orbit) {
  auto y = point.free->start;
  std::vector<double> return_times;
  for (int k = 0; k < point.free->returns; ++k) {
    const auto returned = map.follow(y, tolerance, 1, k > 0, Derivative::none, nullptr, dip_of(point.amplitude));
    if (!returned.outcome.complete()) return {{}, infinity, {}, returned.outcome};
    y = returned.end;
    return_times.push_back(returned.duration);
  }
  const auto swing = slow_swing_from(map, y, tolerance);
  if (!swing) return {{}, infinity, {}, {Ending::budget_spent, "the oscillation does not return within one period"}};
  point.y = swing->y;
  Refined result = record(map, point, tolerance, options, keep_orbit);
  result.closure = 0;
  result.return_times = std::move(return_times);
  return result;
}

/// The largest difference in duration between returns before such an oscillation at two tolerances, over their total
/// time. From a start on the verge of slip, errors of the steps may decide whether it slips or heals. 0 if the returns
/// are the same.
double differing_transients(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double same = 1e-2;
  double largest = 0, time = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    largest = std::max(largest, std::abs(a[k] - b[k]));
    time += std::max(a[k], b[k]);
  }
  return largest > same * time ? largest / time : 0;
}

/// Rounding error of the slip rate (m/s) of an overdamped slider on a contact spring: rounding error of the forces over
/// the damping.
double slip_rate_rounding(const SliderSystem& system) {
  const auto& model = system.model();
  const auto& s = model.slider;
  if (system.rigid() || !(s.damping > std::sqrt(s.stiffness * s.mass))) return 0;
  constexpr double digits = 4 * std::numeric_limits<double>::epsilon();
  return digits * (std::abs(steady::steady_sliding(model).friction_force) + std::abs(model.drive.force.level())) /
         s.damping;
}

/// Rounding error of the unknowns at y, in scales.
double rounding_of_unknowns(const ReturnMap& map, const std::vector<double>& y) {
  double largest = 0;
  for (std::size_t k = 0; k < map.differential().size(); ++k)
    largest = std::max(largest, std::abs(y[map.differential()[k]]) / map.scale()[k]);
  return std::numeric_limits<double>::epsilon() * largest;
}

/// Change of the metrics at a distance `off` (in scales) from the cycle, along the eigenvector that decays slowest.
Metrics metric_change_off_cycle(ReturnMap& map, const FixedPoint& point, const Metrics& there, double off,
                                double tolerance, const CycleOptions& options) {
  const VectorXd scale = map.scale();
  const auto pairs = eigenpairs(scale.cwiseInverse().asDiagonal() * point.derivative * scale.asDiagonal(), true);
  Eigen::Index slowest = 0;
  pairs.values.cwiseAbs().maxCoeff(&slowest);
  const VectorXd slowest_direction = pairs.vectors.col(slowest).real().normalized();
  const double distance = std::max(off, 1e-6);
  FixedPoint neighbour = point;
  neighbour.y = map.moved(point.y, scale.asDiagonal() * slowest_direction, distance);
  const auto seen = record(map, neighbour, tolerance, options, false);
  Metrics change;
  for (const auto& metric : metric_names())
    change.*metric.member = seen.outcome.complete()
                                ? std::abs(seen.metrics.*metric.member - there.*metric.member) * off / distance
                                : infinity;
  return change;
}

/// True if the period has fewer returns than the search took it for; `point` then has that number. Returns that differ
/// in the search may prove to be the same on the cycle. `closure`: distance of `point` from the cycle, in scales.
bool reduce_to_fewer_returns(ReturnMap& map, FixedPoint& point, double tolerance, double closure) {
  constexpr double steps = 100, largest = 1e-2;  // scatter of the steps between returns, in tolerances
  const double size = map.distance(point.y, map.system().steady(0));
  const double same = std::min(std::max(10 * closure, steps * tolerance * size), largest * size);
  for (int fewer = 1; 2 * fewer <= point.returns; ++fewer) {
    if (point.returns % fewer != 0) continue;
    const auto returned =
        map.follow(point.y, tolerance, fewer, true, !point.by_differences ? Derivative::of_steps : Derivative::none,
                   nullptr, dip_of(point.amplitude));
    if (!returned.outcome.complete()) continue;
    FixedPoint candidate = point;
    candidate.returns = fewer;
    if (point.by_differences)
      candidate.derivative.setZero();  // bounded by the derivative over all returns
    else
      candidate.derivative = returned.derivative;
    // A contraction by 1/2 has a fixed point within twice the distance by which it moves a point.
    const bool contracts = !point.by_differences && spectral_radius(candidate, map) < 0.5;
    if (map.distance(returned.end, point.y) > (contracts ? largest * size : same)) continue;
    point = std::move(candidate);
    return true;
  }
  return false;
}

/// Multipliers of the cycle at the point, whose period has the relative error `known_to`. For a slow swing the first
/// follows from the work of friction.
Multipliers multipliers_of_cycle(ReturnMap& map, const FixedPoint& point, double known_to) {
  constexpr double well_known = 1e-3;  // with a larger error a closed orbit nearby may be another one
  if (!(known_to < well_known))
    return {{}, {}, fmt::format("multipliers left out: the period is known to {:.1g} of itself only", known_to)};
  if (point.free) return {{}, {}, "multipliers left out: friction leaves the oscillation as its start made it"};
  auto known = cycle_multipliers(map, point.y, point.returns, point.amplitude, !point.swing);
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
  // Period of the leading oscillation of steady sliding; its e-folding time where it does not oscillate.
  const auto leading = steady::stability(model).eigenvalues.front();
  const double period_about_steady =
      2 * std::numbers::pi / std::max(std::abs(leading.imag()), std::abs(leading.real()));
  ReturnMap map(model);
  if (map.differential().size() < 2) {
    cycle.outcome = {Ending::none_exists, "one unknown alone evolves, and that cannot oscillate (no mass, no memory)"};
    return cycle;
  }
  auto search = search_cycle(map, leading.real() * period_about_steady, options);
  cycle.cost = map.cost();
  if (!search.point) {
    cycle.outcome = search.outcome, cycle.exponent = search.exponent;
    return cycle;
  }
  FixedPoint& point = *search.point;
  const double V = map.drive_speed();
  // Small or weakly attracting cycles magnify relative errors by 1/A and 1/(1 − ρ).
  const double magnified = std::min(1.0, point.amplitude) * attraction(point, map);
  const double digits = slip_rate_rounding(map.system());  // the contact's slip rate follows from friction
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
  // Every tolerance is tested: returns that differ at one may agree at a tighter one, which resolves the onset of slip.
  bool fewer = false;
  const auto period_is_shorter = [&](const Refined& known) {
    constexpr double well_known = 1e-3;  // of the size
    if (!known.outcome.complete() || known.closure > well_known * map.distance(point.y, map.system().steady(0)) ||
        !reduce_to_fewer_returns(map, point, sharpening.tolerance(), known.closure))
      return false;
    return fewer = true;
  };
  if (period_is_shorter(coarse)) coarse = refined(false);
  std::string worst;
  while (sharpening.next()) {
    Refined fine = refined(true);
    if (coarse.outcome.complete() && sharpening.loosen(fine.outcome)) fine = refined(true);
    if (period_is_shorter(fine)) {
      sharpening = Sharpening(options.tolerance, 100 * sharpening.tolerance());
      coarse = refined(false);
      continue;
    }
    if (!coarse.outcome.complete() || !fine.outcome.complete()) {
      const bool known =
          cycle.metrics.period > 0 && fine.outcome.ending == Ending::budget_spent;  // the last refinement stays
      if (!known) cycle.outcome = coarse.outcome.complete() ? fine.outcome : coarse.outcome;
      break;
    }
    const double lowest = fine.metrics.slip_rate_min;
    bool stick_is_ill_conditioned = false;
    for (const double e : {options.stick_threshold, 0.01, 0.5})
      if (std::abs(std::abs(lowest) - e * V) < 1e-4 * e * V) stick_is_ill_conditioned = true;
    Metrics error;
    // Rounding error of every return adds up over the returns in which it decays. Metrics are relative to the size of
    // the motion, which may be small compared with the scales.
    const double rounding = std::max(1e-14, rounding_of_unknowns(map, point.y));
    const double forgetting = rounding / (point.swing ? 1 : std::max(attraction(point, map), 1e-14));
    const double size = map.distance(point.y, map.system().steady(0));
    const double closure = (fine.closure + forgetting) * std::max(1.0, std::min(1.0, point.amplitude) / size) +
                           differing_transients(coarse.return_times, fine.return_times);
    double reached = estimate_errors(coarse.metrics, fine.metrics, sharpening.tolerance(), closure, V,
                                     stick_is_ill_conditioned, error, worst);
    const auto add_errors = [&](const Metrics& errors) {
      for (const auto& metric : metric_names()) {
        error.*metric.member += errors.*metric.member;
        if (is_stick(metric) && stick_is_ill_conditioned) continue;
        const double ratio = error.*metric.member / size_of(metric, fine.metrics, V);
        if (ratio > reached) reached = ratio, worst = metric.name;
      }
    };
    add_errors(fine.passed_over);
    constexpr double weak = 1e-2;
    if (!point.swing && !point.free && !point.by_differences && attraction(point, map) < weak)
      // Two tolerances may differ by rounding error only, to which metrics may be more sensitive than the point.
      add_errors(metric_change_off_cycle(map, point, fine.metrics, closure, sharpening.tolerance(), options));
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
  // The search accepts attracting motion only. The derivative is unknown for fewer returns than the differences were
  // taken over, and for a neutral oscillation.
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
