/// Slip weakening of earthquake rupture: friction falls over a distance of slip, once and for all.
#pragma once
#include "laws/static_and_dynamic.hpp"

namespace rosin::laws {

template <class Real = double>
struct SlipWeakening {
  static constexpr Card card{
      .name = "slip-weakening",
      .title = "Linear slip weakening",
      .formula = R"(\mu = \mu_d + (\mu_s - \mu_d)\max\Bigl(0,\, 1 - \frac{s}{d_c}\Bigr),\quad \lambda\dot s = |v|)",
      .source = "Ida (1972); Andrews (1976)",
      .limits = "one rupture: friction does not recover, so that no second stick is as strong as the first"};

  Real mu_s = 0.4, mu_d = 0.3, d_c = 1e-5;
  static constexpr auto parameters = table(
      field(&SlipWeakening::mu_s, "mu_s", "1", {0, 10}, "coefficient before slip, the largest that holds at rest"),
      field(&SlipWeakening::mu_d, "mu_d", "1", {0, 10}, "coefficient after a slip of d_c"),
      field(&SlipWeakening::d_c, "d_c", "m", {1e-12, 1e3}, "slip over which friction falls"));

  struct State {
    Real s;
  };
  static constexpr auto states =
      table(field(&State::s, "s", "m", {0, 1e6}, "slip so far, either way; beyond d_c it counts up to 2 d_c only"));

  static void check(const SlipWeakening<double>& law) { require_static_above_dynamic("mu_s", law.mu_s, law.mu_d); }

  Real friction(Sliding<Real>, State state) const { return linear_weakening(mu_s, mu_d, state.s, d_c); }
  Real static_limit(Sliding<Real> at, State state) const { return friction(at, state); }
  State rate(Sliding<Real> at, State state) const { return {counted_slip_rate(at.slip_rate, state.s, d_c)}; }
  State steady(Sliding<Real>) const { return {2.0 * d_c}; }
  Real kink(State state) const { return 1.0 - state.s / d_c; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State size() const { return {d_c}; }
};

}  // namespace rosin::laws
