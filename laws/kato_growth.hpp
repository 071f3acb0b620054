/// Static friction that grows with the time at rest towards a limit, and a constant coefficient in motion.
#pragma once
#include "laws/static_and_dynamic.hpp"

namespace rosin::laws {

template <class Real = double>
struct KatoGrowth {
  static constexpr Card card{
      .name = "kato-growth",
      .title = "Static friction growing with time at rest towards a limit",
      .formula = R"(|F| \le N\bigl[\mu_\infty - (\mu_\infty - \mu_0)\,e^{-\gamma t^m}\bigr] \text{ at } v = 0,\quad
F = \mu_d N\,\mathrm{sgn}\,v \text{ otherwise},\quad t \text{ the time since the last stop})",
      .source = "Kato, Sato & Matsubayashi (1972)",
      .limits = "gamma carries the unit s^-m: change it with m; no dependence on speed in motion"};

  Real mu_0 = 0.35, mu_inf = 0.45, gamma = 0.1, m = 0.5, mu_d = 0.3;
  static constexpr auto parameters =
      table(field(&KatoGrowth::mu_0, "mu_0", "1", {0, 10}, "static coefficient just after a stop"),
            field(&KatoGrowth::mu_inf, "mu_inf", "1", {0, 10}, "static coefficient after long rest"),
            field(&KatoGrowth::gamma, "gamma", "1", {1e-12, 1e12}, "growth after 1 s at rest (per s^m)"),
            field(&KatoGrowth::m, "m", "1", {0.05, 2}, "exponent of the time at rest"),
            field(&KatoGrowth::mu_d, "mu_d", "1", {0, 10}, "dynamic coefficient, in motion"));

  struct State {
    Real t;
  };
  static constexpr auto states = table(field(&State::t, "t", "s", {0, 1e300}, "time at rest since the last stop"));

  static void check(const KatoGrowth<double>& law) {
    require_static_above_dynamic("mu_0", law.mu_0, law.mu_d);
    require_static_above_dynamic("mu_inf", law.mu_inf, law.mu_d);
  }

  Real t_c = min(Real(exp(-log(gamma) / m)), Real(1.0));  ///< time at rest at which γ t^m = 1, at most 1 s
  Real friction(Sliding<Real>, State) const { return mu_d; }
  Real static_limit(Sliding<Real>, State s) const { return mu_inf - (mu_inf - mu_0) * exp(-gamma * power(s.t, m)); }
  State rate(Sliding<Real> at, State s) const { return {time_at_rest_rate(at.slip_rate, s.t, t_c)}; }
  State steady(Sliding<Real>) const { return {Real(0.0)}; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State after_stop(State) const { return {Real(0.0)}; }
  State size() const { return {t_c}; }
};

}  // namespace rosin::laws
