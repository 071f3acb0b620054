/// Static friction that grows with the logarithm of the time at rest, and a constant coefficient in motion.
#pragma once
#include <numbers>

#include "laws/static_and_dynamic.hpp"

namespace rosin::laws {

template <class Real = double>
struct StaticGrowth {
  static constexpr Card card{
      .name = "static-growth",
      .title = "Static friction growing with the logarithm of time at rest",
      .formula = R"(|F| \le N\Bigl[\mu_{s0} + \beta\log_{10}\Bigl(1 + \frac{t}{t_c}\Bigr)\Bigr] \text{ at } v = 0,\quad
F = \mu_d N\,\mathrm{sgn}\,v \text{ otherwise},\quad t \text{ the time since the last stop})",
      .source = "Dieterich (1972), eq 1, with the cut-off time of Dieterich (1978)",
      .limits = "grows without end at rest; no dependence on speed in motion"};

  Real mu_s0 = 0.4, beta = 0.015, t_c = 1, mu_d = 0.3;
  static constexpr auto parameters =
      table(field(&StaticGrowth::mu_s0, "mu_s0", "1", {0, 10}, "static coefficient just after a stop"),
            field(&StaticGrowth::beta, "beta", "1", {0, 1}, "growth per decade of time at rest"),
            field(&StaticGrowth::t_c, "t_c", "s", {1e-12, 1e12}, "time at rest below which little grows"),
            field(&StaticGrowth::mu_d, "mu_d", "1", {0, 10}, "dynamic coefficient, in motion"));

  struct State {
    Real t;
  };
  static constexpr auto states = table(field(&State::t, "t", "s", {0, 1e300}, "time at rest since the last stop"));

  static void check(const StaticGrowth<double>& law) { require_static_above_dynamic("mu_s0", law.mu_s0, law.mu_d); }

  Real beta_e = beta / std::numbers::ln10;  ///< per e-fold
  Real friction(Sliding<Real>, State) const { return mu_d; }
  Real static_limit(Sliding<Real>, State s) const { return mu_s0 + beta_e * log1p(s.t / t_c); }
  State rate(Sliding<Real> at, State s) const { return {time_at_rest_rate(at.slip_rate, s.t, t_c)}; }
  State steady(Sliding<Real>) const { return {Real(0.0)}; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State after_stop(State) const { return {Real(0.0)}; }
  State size() const { return {t_c}; }
};

}  // namespace rosin::laws
