/// Rate-and-state friction of Nagata, Nakatani and Yoshida: ageing contacts that shear stress weakens as it rises.
#pragma once
#include <fmt/format.h>

#include "laws/rate_and_state.hpp"

namespace rosin::laws {

/// The paper's evolution, θ̇ = 1 − vθ/L − (c/b) θ μ̇, holds a rate of friction. Its integral does not: with
/// φ = θ e^{c(μ−μ₀)/b} it is φ̇ = φ (1/θ − v/L), and μ = μ₀ + a ln(v/v₀) + b ln(v₀θ/L) is solved for μ at given v and φ:
/// (1 + c)(μ − μ₀) = a ln(v/v₀) + b ln(v₀φ/L), made odd and smooth through v = 0 by asinh as in the other laws.
template <class Real = double>
struct Nagata {
  static constexpr Card card{
      .name = "nagata",
      .title = "Rate-and-state friction with stress weakening, law of Nagata et al.",
      .formula = R"(\mu = \frac{a}{1+c}\,\mathrm{asinh}\Bigl(\frac{v}{2v_0}e^{E}\Bigr),\quad
E = \frac{1}{a}\Bigl[(1+c)\mu_0 + b\ln\frac{v_0\varphi}{L}\Bigr],\quad
\lambda\dot\varphi = e^{c(|\mu|-\mu_0)/b} - \frac{|v|\varphi}{L};\quad
\varphi = \theta e^{c(\mu-\mu_0)/b} \text{ makes it } \dot\theta = 1 - \frac{v\theta}{L} - \frac{c}{b}\theta\dot\mu)",
      .source = "Nagata, Nakatani & Yoshida (2012); asinh form as in Rice, Lapusta & Ranjith (2001)",
      .limits = "weakens without bound for b > a; contacts age without bound at rest"};

  Real mu0 = 0.6, a = 0.05, b = 0.055, L = 10e-6, v0 = 1e-6, c = 2;
  static constexpr auto parameters = std::tuple_cat(
      table(field(&Nagata::mu0, "mu0", "1", {0, 5}, "friction at the reference slip rate"),
            field(&Nagata::a, "a", "1", {1e-4, 0.5}, "direct effect at constant strength; a/(1 + c) shows in a step"),
            field(&Nagata::b, "b", "1", {1e-4, 0.5}, "evolution effect; steady weakening when b > a"),
            field(&Nagata::L, "L", "m", {1e-10, 1}, "slip that renews the contacts"),
            field(&Nagata::v0, "v0", "m/s", {1e-14, 10}, "reference slip rate"),
            field(&Nagata::c, "c", "1", {0, 10}, "weakening by a rise of stress; 0: the ageing law")));

  struct State {
    WithLog<Real> phi;
  };
  static constexpr auto states = table(
      field(&State::phi, "phi", "s", any_age, "age of the contacts without the part that stress took", Scale::log));

  static void check(const Nagata<double>& law) {
    constexpr double largest = 10;  // beyond, φ leaves the range of numbers within the decades of slip rate
    if (law.c * law.a > largest * law.b)
      throw InputError(
          fmt::format("law.c a/b = {:.3g} is above {}: stress would weaken contacts by more than can be "
                      "computed; lower c or a, or raise b",
                      law.c * law.a / law.b, largest));
  }

  Real a_shown = a / (1.0 + c), c_by_b = c / b;
  Real b_by_a = b / a, E_1 = ((1.0 + c) * mu0 + b * log(v0 / L)) / a - log(2.0 * v0);
  Real exponent(State s) const { return E_1 + b_by_a * log(s.phi); }

  Real friction(Sliding<Real> at, State s) const { return a_shown * asinh_exp(at.slip_rate, exponent(s)); }
  Real slip_rate(Real mu, Sliding<Real>, State s) const { return sinh_exp(Real(mu / a_shown), exponent(s)); }
  State rate(Sliding<Real> at, State s) const {
    const Real v = abs(at.slip_rate), mu = friction(Sliding<Real>{v, at.normal_load}, s);
    return {exp(c_by_b * (mu - mu0)) - v * s.phi / L};
  }
  /// At θ = L/v, p = μ/a solves e^p − e^{−(1+2c)p} = 2e^w with w = ln(v/2v₀) + [μ₀ + b ln(v₀/v)]/a.
  State steady(Sliding<Real> at) const {
    const Real v = abs(at.slip_rate), w = log(v / (2.0 * v0)) + (mu0 - b * log(v / v0)) / a;
    const Real k = 2.0 * (1.0 + c), whole = w + std::numbers::ln2;
    // Newton's method on the logarithm, concave, from the root's lower bound asinh(e^w)/(1 + c) upwards.
    Real p = asinh_exp(Real(1.0), w) / (1.0 + c);
    for (int i = 0; i < 7; ++i) {
      const Real rest = exp(-k * p), lost = -expm1(-k * p);
      p = p - (p + log(lost) - whole) / (1.0 + k * rest / lost);
    }
    return {L / v * exp(c_by_b * (a * p - mu0))};
  }
};

}  // namespace rosin::laws
