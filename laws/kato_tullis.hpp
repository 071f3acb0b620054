/// Rate-and-state friction, composite law: slip evolves the state at speed, and it heals only where slip is slow.
#pragma once
#include "laws/rate_and_state.hpp"

namespace rosin::laws {

template <class Real = double>
struct KatoTullis {
  static constexpr Card card{.name = "kato-tullis",
                             .title = "Rate-and-state friction, composite law of Kato and Tullis",
                             .formula = R"(\mu = a\,\mathrm{asinh}\Bigl(\frac{v}{2v_0}e^{E}\Bigr),\quad
E = \frac{1}{a}\Bigl(\mu_0 + b\ln\frac{v_0\theta}{L}\Bigr),\quad
\lambda\dot\theta = e^{-|v|/v_c} - \frac{|v|\theta}{L}\ln\frac{|v|\theta}{L})",
                             .source = "Kato & Tullis (2001); asinh form after Rice, Lapusta & Ranjith (2001)",
                             .limits = "weakens without bound for b > a; contacts age without bound at rest"};

  Real mu0 = 0.6, a = 0.010, b = 0.015, L = 10e-6, v0 = 1e-6, v_c = 1e-8;
  static constexpr auto parameters = std::tuple_cat(
      one_state_parameters<KatoTullis>(),
      table(field(&KatoTullis::v_c, "v_c", "m/s", {1e-14, 10}, "slip rate above which contacts do not heal")));

  struct State {
    WithLog<Real> theta;
  };
  static constexpr auto states =
      table(field(&State::theta, "theta", "s", any_age, "mean age of the contacts", Scale::log));

  // E = E₁ + (b/a) ln θ, θ in seconds: what does not change is divided and taken the logarithm of once.
  Real b_by_a = b / a, E_1 = (mu0 + b * log(v0 / L)) / a - log(2.0 * v0);
  Real exponent(State s) const { return E_1 + b_by_a * log(s.theta); }

  Real friction(Sliding<Real> at, State s) const { return a * asinh_exp(at.slip_rate, exponent(s)); }
  Real slip_rate(Real mu, Sliding<Real>, State s) const { return sinh_exp(Real(mu / a), exponent(s)); }
  State rate(Sliding<Real> at, State s) const {
    const Real v = abs(at.slip_rate);
    return {exp(-v / v_c) - xlogx(Real(v * s.theta / L))};
  }
  /// θ = x L/v with x ln x = y, y = e^{−v/v_c} between 0 and 1.
  State steady(Sliding<Real> at) const {
    const Real v = abs(at.slip_rate), y = exp(-v / v_c);
    // Newton's method on a convex function, from within 0.08 of the root: four steps reach rounding, two more its
    // derivatives to third order.
    Real x = 1.0 + 0.763 * y;
    for (int i = 0; i < 6; ++i) x = (x + y) / (1.0 + log(x));
    return {x * L / v};
  }
};

}  // namespace rosin::laws
