/// Friction that falls over a distance of slip and is whole again after every stop: Rabinowicz's critical distance.
#pragma once
#include "laws/static_and_dynamic.hpp"

namespace rosin::laws {

template <class Real = double>
struct SlipDistance {
  static constexpr Card card{
      .name = "slip-distance",
      .title = "Friction falling over a distance of slip",
      .formula =
          R"(\mu = \mu_d + (\mu_s - \mu_d)\max\Bigl(0,\, 1 - \frac{s}{d_c}\Bigr),\quad \lambda\dot s = |v|,\quad s = 0 \text{ after each stop})",
      .source = "Rabinowicz (1951, 1958), linear form",
      .limits = "no dependence on slip rate; a stop of any length restores the static coefficient"};

  Real mu_s = 0.4, mu_d = 0.3, d_c = 1e-5;
  static constexpr auto parameters =
      table(field(&SlipDistance::mu_s, "mu_s", "1", {0, 10}, "coefficient before slip, the largest that holds at rest"),
            field(&SlipDistance::mu_d, "mu_d", "1", {0, 10}, "coefficient after a slip of d_c"),
            field(&SlipDistance::d_c, "d_c", "m", {1e-12, 1e3}, "slip over which friction falls"));

  struct State {
    Real s;
  };
  static constexpr auto states =
      table(field(&State::s, "s", "m", {0, 1e6}, "slip since the last stop; beyond d_c it counts up to 2 d_c only"));

  static void check(const SlipDistance<double>& law) { require_static_above_dynamic("mu_s", law.mu_s, law.mu_d); }

  Real friction(Sliding<Real>, State state) const { return linear_weakening(mu_s, mu_d, state.s, d_c); }
  Real static_limit(Sliding<Real> at, State state) const { return friction(at, state); }
  State rate(Sliding<Real> at, State state) const { return {counted_slip_rate(at.slip_rate, state.s, d_c)}; }
  State steady(Sliding<Real>) const { return {2.0 * d_c}; }
  Real kink(State state) const { return 1.0 - state.s / d_c; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State after_stop(State) const { return {Real(0.0)}; }
  State size() const { return {d_c}; }
};

}  // namespace rosin::laws
