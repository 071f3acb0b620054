/// Rate-and-state friction with flash heating: above a slip rate, contacts melt or weaken before they are renewed.
#pragma once
#include <fmt/format.h>

#include "laws/rate_and_state.hpp"

namespace rosin::laws {

template <class Real = double>
struct FlashHeating {
  static constexpr Card card{
      .name = "flash-heating",
      .title = "Rate-and-state friction with flash heating",
      .formula = R"(\mu = a\,\mathrm{asinh}\Bigl(\frac{v}{2v_0}e^{\psi/a}\Bigr),\quad
\lambda\dot\psi = -\frac{|v|}{L}\bigl(\psi - \psi_\mathrm{ss}(v)\bigr),\quad
\psi_\mathrm{ss} = a\ln\Bigl(\frac{2v_0}{|v|}\sinh\frac{\mu_\mathrm{ss}}{a}\Bigr),\quad
\mu_\mathrm{ss} = \mu_w + \frac{\mu_\mathrm{LV}(v) - \mu_w}{[1 + (v/v_w)^8]^{1/8}},\quad
\mu_\mathrm{LV} \approx \mu_0 + (a - b)\ln\frac{|v|}{v_0})",
      .source = "Rice (2006); Beeler, Tullis & Goldsby (2008); Noda, Dunham & Rice (2009), eqs 5-8",
      .limits = "the temperature of the surroundings is taken as constant: v_w and mu_w do not change with it"};

  Real mu0 = 0.7, a = 0.016, b = 0.02, L = 20e-6, v0 = 1e-6, mu_w = 0.13, v_w = 0.17;
  static constexpr auto parameters = std::tuple_cat(
      one_state_parameters<FlashHeating>(),
      table(
          field(&FlashHeating::mu_w, "mu_w", "1", {0, 5}, "friction of weakened contacts, reached far above v_w"),
          field(&FlashHeating::v_w, "v_w", "m/s", {1e-6, 1e4}, "slip rate above which contacts weaken by their heat")));

  struct State {
    Real psi;
  };
  static constexpr auto states =
      table(field(&State::psi, "psi", "1", {-100, 100}, "state, mu0 in steady sliding at v0"));

  Real log_2v0 = log(2.0 * v0);

  Real friction(Sliding<Real> at, State s) const { return a * asinh_exp(at.slip_rate, Real(s.psi / a - log_2v0)); }
  Real slip_rate(Real mu, Sliding<Real>, State s) const { return sinh_exp(Real(mu / a), Real(s.psi / a - log_2v0)); }
  State rate(Sliding<Real> at, State s) const { return {abs(at.slip_rate) / L * (steady(at).psi - s.psi)}; }
  State steady(Sliding<Real> at) const {
    // Beyond these no digit changes, while powers and logarithms leave the range of numbers.
    constexpr double nearly_rest = 1e-300, beyond = 1e30;
    const Real v = max(abs(at.slip_rate), Real(nearly_rest)), log_v = log(v / v0);
    const Real slow = a * asinh_exp(v, Real((mu0 - b * log_v) / a - log_2v0));  // the curve of the slip law
    const Real x = min(Real(v / v_w), Real(beyond)), x2 = x * x, x4 = x2 * x2;
    const Real weakened = sqrt(sqrt(sqrt(1.0 + x4 * x4)));
    const Real mu = mu_w + (slow - mu_w) / weakened;
    return {a * (log_two_sinh(max(Real(mu / a), Real(nearly_rest))) - log_v)};
  }
  State size() const { return {10.0 * a}; }
};

}  // namespace rosin::laws
