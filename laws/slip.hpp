/// Rate-and-state friction, slip law: the state evolves with slip alone, so that contacts do not heal at rest.
#pragma once
#include "laws/rate_and_state.hpp"

namespace rosin::laws {

template <class Real = double>
struct Slip {
  static constexpr Card card{.name = "slip",
                             .title = "Rate-and-state friction, slip law",
                             .formula = R"(\mu = a\,\mathrm{asinh}\Bigl(\frac{v}{2v_0}e^{E}\Bigr),\quad
E = \frac{1}{a}\Bigl(\mu_0 + b\ln\frac{v_0\theta}{L}\Bigr),\quad
\lambda\dot\theta = -\frac{|v|\theta}{L}\ln\frac{|v|\theta}{L})",
                             .source = "Ruina (1983); asinh form after Rice, Lapusta & Ranjith (2001)",
                             .limits = "weakens without bound for b > a; no healing at rest, against experiment"};

  Real mu0 = 0.6, a = 0.010, b = 0.015, L = 10e-6, v0 = 1e-6;
  static constexpr auto parameters = one_state_parameters<Slip>();

  struct State {
    WithLog<Real> theta;
  };
  static constexpr auto states =
      table(field(&State::theta, "theta", "s", any_age, "state, an age in steady sliding", Scale::log));

  // E = E₁ + (b/a) ln θ, θ in seconds: what does not change is divided and taken the logarithm of once.
  Real per_a = 1.0 / a, b_by_a = b / a, E_1 = (mu0 + b * log(v0 / L)) / a - log(2.0 * v0);
  Real exponent(State s) const { return E_1 + b_by_a * log(s.theta); }

  Real friction(Sliding<Real> at, State s) const { return a * asinh_exp(at.slip_rate, exponent(s)); }
  Real slip_rate(Real mu, Sliding<Real>, State s) const { return sinh_exp(Real(mu * per_a), exponent(s)); }
  State rate(Sliding<Real> at, State s) const { return {-xlogx(Real(abs(at.slip_rate) * s.theta / L))}; }
  State steady(Sliding<Real> at) const { return {L / abs(at.slip_rate)}; }
};

}  // namespace rosin::laws
