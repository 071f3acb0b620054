/// Rate-and-state friction with two slip states: friction relaxes over a short and over a long slip.
#pragma once
#include "laws/rate_and_state.hpp"

namespace rosin::laws {

template <class Real = double>
struct TwoStateSlip {
  static constexpr Card card{.name = "two-state-slip",
                             .title = "Rate-and-state friction with two states, slip law",
                             .formula = R"(\mu = a\,\mathrm{asinh}\Bigl(\frac{v}{2v_0}e^{E}\Bigr),\quad
E = \frac{1}{a}\Bigl(\mu_0 + \sum_{i=1}^{2} b_i\ln\frac{v_0\theta_i}{L_i}\Bigr),\quad
\lambda\dot\theta_i = -\frac{|v|\theta_i}{L_i}\ln\frac{|v|\theta_i}{L_i})",
                             .source = "Ruina (1983); Gu, Rice, Ruina & Tse (1984)",
                             .limits = "weakens without bound for b1 + b2 > a; no healing at rest, against experiment"};

  Real mu0 = 0.6, a = 0.010, b1 = 0.009, L1 = 2e-6, b2 = 0.006, L2 = 40e-6, v0 = 1e-6;
  static constexpr auto parameters = two_state_parameters<TwoStateSlip>();

  struct State {
    WithLog<Real> theta1, theta2;
  };
  static constexpr auto states =
      table(field(&State::theta1, "theta1", "s", any_age, "state that evolves over L1", Scale::log),
            field(&State::theta2, "theta2", "s", any_age, "state that evolves over L2", Scale::log));

  // E = E₁ + (b₁ ln θ₁ + b₂ ln θ₂)/a, θ in seconds: what does not change is divided and taken the logarithm of once.
  Real per_a = 1.0 / a, b1_by_a = b1 / a, b2_by_a = b2 / a;
  Real E_1 = (mu0 + b1 * log(v0 / L1) + b2 * log(v0 / L2)) / a - log(2.0 * v0);
  Real exponent(State s) const { return E_1 + b1_by_a * log(s.theta1) + b2_by_a * log(s.theta2); }

  Real friction(Sliding<Real> at, State s) const { return a * asinh_exp(at.slip_rate, exponent(s)); }
  Real slip_rate(Real mu, Sliding<Real>, State s) const { return sinh_exp(Real(mu * per_a), exponent(s)); }
  State rate(Sliding<Real> at, State s) const {
    const Real speed = abs(at.slip_rate);
    return {-xlogx(Real(speed * s.theta1 / L1)), -xlogx(Real(speed * s.theta2 / L2))};
  }
  State steady(Sliding<Real> at) const { return {L1 / abs(at.slip_rate), L2 / abs(at.slip_rate)}; }
};

}  // namespace rosin::laws
