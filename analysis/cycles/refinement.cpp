/// Errors from differences, rounding error and tolerances.
#include "analysis/cycles/refinement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/motion/stated_error.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::cycles {

double estimate_errors(const Metrics& coarse, const Metrics& fine, double tolerance, double closure, double V,
                       bool stick_is_ill_conditioned, Metrics& error, std::string& worst, double caution) {
  // In a period the slider slips as far as the drive moves. A mismatch beyond the errors of the steps means that the
  // motion has not closed, and bounds the accuracy of every metric.
  const double mean_size = size_of(find_metric("slip_rate_mean"), fine, V);
  const double explained =
      3 * caution * std::abs(coarse.slip_rate_mean - fine.slip_rate_mean) / mean_size + 3 * tolerance;
  const double unclosed = std::abs(fine.slip_rate_mean - V) / mean_size;
  if (unclosed > explained + closure + 5e-14) closure = 3 * unclosed;
  double largest = 0;
  for (const auto& metric : metric_names()) {
    const double size = size_of(metric, fine, V), value = fine.*metric.member;
    // The loop integral scatters with the division of its steps; three times its difference proved too small.
    double e = caution * (is_loop(metric) ? 6 : 3) * std::abs(coarse.*metric.member - value);
    // The error of the lowest slip rate is relative to that rate, unless slip reverses. In near-stick it is 100
    // tolerances, because the rate changes e-fold with friction through the direct effect.
    constexpr double slow = 1e-3;
    const bool sticks = std::abs(value) < slow * V;
    const double times = sticks ? 100 : 10, stick_closure = sticks && closure > tolerance ? times * closure : closure;
    if (value != 0)
      e += metric.member == &Metrics::slip_rate_min && value > 0 ? (times * tolerance + 5e-14 + stick_closure) * value
                                                                 : (3 * tolerance + 5e-14 + closure) * size;
    // Reverse slip below 1e-14 of the highest slip rate is rounding error.
    constexpr double digits = 1e-14;
    if (metric.member == &Metrics::slip_rate_min && value < 0 && -value < digits * fine.slip_rate_max)
      e += 2 * std::abs(value);
    // Divided steps are each summed to a small part of the tolerance.
    if (value != 0 && metric.member == &Metrics::loop_area)
      e += 0.3 * std::max(tolerance, 1e-13) * fine.slip_rate_max * fine.friction_max;
    if (value != 0 && metric.member == &Metrics::loop_area_normalised) e += 0.3 * std::max(tolerance, 1e-13);
    error.*metric.member = e;
    if (is_stick(metric) && stick_is_ill_conditioned) continue;
    const double ratio = std::isfinite(e / size) ? e / size : infinity;
    if (ratio > largest) largest = ratio, worst = metric.name;
  }
  return largest;
}

void state_with_caution(Metrics& error, const Metrics& metrics, double requested, double V) {
  for (const auto& metric : metric_names())
    error.*metric.member = motion::with_caution(error.*metric.member, size_of(metric, metrics, V), requested);
}

bool Sharpening::next() {
  constexpr int most = 4;
  const bool exhausted = attempts_ > 0 && tolerance_ <= solvers::steps::Collocation::least_tolerance;
  if (attempts_ == most || exhausted) return false;
  ++attempts_;
  before_ = tolerance_;
  tolerance_ = std::max(factor_ * tolerance_, solvers::steps::Collocation::least_tolerance);
  return true;
}

bool Sharpening::loosen(const Outcome& outcome) {
  if (outcome.ending != Ending::budget_spent || loosened_) return false;
  tolerance_ = std::sqrt(before_ * tolerance_);
  return loosened_ = true;
}

Outcome Sharpening::judge(double reached, const std::string& worst) {
  if (reached <= requested_) return {};
  // Errors of moderately stiff unknowns go with the tolerance to the power 2/3.
  factor_ = std::clamp(0.3 * std::pow(requested_ / reached, 1.5), 1e-4, 0.01);
  return {Ending::tolerance_not_met, fmt::format("{} is known to {:.1e} only", worst, reached)};
}

bool Sharpening::supersedes(const Cycle& known, const Metrics& metrics, const Metrics& error, double reached) {
  const bool agree = std::ranges::all_of(metric_names(), [&](const MetricName& metric) {
    const double difference = std::abs(known.metrics.*metric.member - metrics.*metric.member);
    return (is_stick(metric) && known.ill_conditioned_stick) ||
           difference <= known.error.*metric.member + error.*metric.member;
  });
  if (reached > least_reached_ && agree) return false;
  least_reached_ = reached;
  return true;
}

}  // namespace rosin::analysis::cycles
