/// Static friction that is lower the faster the force on the contact has risen, and a constant coefficient in motion.
#pragma once
#include "laws/static_and_dynamic.hpp"

namespace rosin::laws {

template <class Real = double>
struct LoadingRate {
  static constexpr Card card{
      .name = "loading-rate",
      .title = "Static friction falling with the rate of loading",
      .formula = R"(|F| \le \mu_s N \text{ at } v = 0,\quad \mu_s = \mu_\mathrm{fast} +
\frac{\mu_\mathrm{slow} - \mu_\mathrm{fast}}{1 + \Theta/\Theta_0},\quad \Theta = \frac{\mu_s}{t},\quad
F = \mu_d N\,\mathrm{sgn}\,v \text{ otherwise},\quad t \text{ the time since the last stop})",
      .source = "Richardson & Nolle (1976): static friction depends on the rate of loading, not on time at rest itself",
      .limits = "the rate is the mean since the last stop; no dependence on speed in motion"};

  Real mu_slow = 0.5, mu_fast = 0.35, theta0 = 0.1, mu_d = 0.3;
  static constexpr auto parameters = table(
      field(&LoadingRate::mu_slow, "mu_slow", "1", {1e-6, 10}, "static coefficient under slow loading"),
      field(&LoadingRate::mu_fast, "mu_fast", "1", {1e-6, 10}, "static coefficient under fast loading"),
      field(&LoadingRate::theta0, "theta0", "1/s", {1e-12, 1e12}, "rate of loading, in units of N, between the two"),
      field(&LoadingRate::mu_d, "mu_d", "1", {0, 10}, "dynamic coefficient, in motion"));

  struct State {
    Real t;
  };
  static constexpr auto states = table(field(&State::t, "t", "s", {0, 1e300}, "time at rest since the last stop"));

  static void check(const LoadingRate<double>& law) {
    require_static_above_dynamic("mu_fast", law.mu_fast, law.mu_d);
    require_static_above_dynamic("mu_slow", law.mu_slow, law.mu_d);
  }

  Real friction(Sliding<Real>, State) const { return mu_d; }
  /// The positive root of μ² + (T − μ_fast) μ − μ_slow T = 0, T = Θ₀ t.
  Real static_limit(Sliding<Real>, State s) const {
    const Real T = theta0 * s.t, half = 0.5 * (T - mu_fast), product = mu_slow * T;
    const Real root = sqrt(half * half + product);
    return select(half > Real(0.0), Real(product / (abs(half) + root)), Real(root - half));
  }
  State rate(Sliding<Real> at, State s) const { return {time_at_rest_rate(at.slip_rate, s.t, Real(1.0 / theta0))}; }
  State steady(Sliding<Real>) const { return {Real(0.0)}; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State after_stop(State) const { return {Real(0.0)}; }
  State size() const { return {1.0 / theta0}; }
};

}  // namespace rosin::laws
