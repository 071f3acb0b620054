/// Spinodal rate-and-state friction: healing saturates, so that the steady curve has an N shape.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Spinodal {
  static constexpr Card card{
      .name = "spinodal",
      .title = "Spinodal rate-and-state friction",
      .formula = R"(\mu = a\,\mathrm{asinh}\Bigl(\frac{v}{2v_0}e^{E}\Bigr),\quad
E = \frac{1}{a}\Bigl[\mu_0 + b\ln\Bigl(c + \frac{\psi}{\psi_*}\Bigr)\Bigr],\quad
\lambda\dot\psi = \frac{1-\psi}{t_\mathrm{heal}} - \frac{|v|\psi}{L},\quad \psi_* = \frac{L}{L + v_0 t_\mathrm{heal}})",
      .source = "Putelat, Dawes & Willis (2011); Woodhouse, Putelat & McKay (2015), eqs 2.10-2.13 and Table 1",
      .limits = "slow sliding, below the speed at which flash heating sets in"};

  Real mu0 = 0.369, a = 0.0349, b = 0.0489, L = 0.9e-6, v0 = 1e-6, c = 1e-3, t_heal = 90;

  static constexpr auto parameters =
      table(field(&Spinodal::mu0, "mu0", "1", {0, 5}, "friction at the reference slip rate (where c is negligible)"),
            field(&Spinodal::a, "a", "1", {1e-4, 0.5}, "direct effect"),
            field(&Spinodal::b, "b", "1", {0, 0.5}, "evolution effect; weakening somewhere needs b > a"),
            field(&Spinodal::L, "L", "m", {1e-10, 1}, "slip that renews the contacts"),
            field(&Spinodal::v0, "v0", "m/s", {1e-14, 10}, "reference slip rate"),
            field(&Spinodal::c, "c", "1", {1e-12, 1}, "cut-off of the state at high slip rate"),
            field(&Spinodal::t_heal, "t_heal", "s", {1e-6, 1e12}, "healing time of contacts at rest"));

  struct State {
    Real psi;
  };
  static constexpr auto states =
      table(field(&State::psi, "psi", "1", {1e-300, 1}, "interface state, the healed fraction", Scale::log));

  struct Published {
    std::string_view name, source;
    Spinodal law;
  };
  static std::vector<Published> presets() {
    return {{"bristol-board",
             "Woodhouse, Putelat & McKay (2015), Table 1; mu0 is not printed there: 0.369 reproduces Fig 1",
             Spinodal{}}};
  }

  Real psi_ref = L / (L + v0 * t_heal);  ///< ψ*, steady state at v0
  // What does not change is divided by once: divisions are the dearest part of an evaluation in lanes.
  Real per_psi_ref = 1.0 / psi_ref, per_a = 1.0 / a, per_L = 1.0 / L, per_t_heal = 1.0 / t_heal;
  Real log_2v0 = log(2.0 * v0);
  Real exponent(State s) const { return (mu0 + b * log(c + s.psi * per_psi_ref)) * per_a - log_2v0; }

  Real friction(Sliding<Real> at, State s) const { return a * asinh_exp(at.slip_rate, exponent(s)); }
  Real slip_rate(Real mu, Sliding<Real>, State s) const { return sinh_exp(Real(mu * per_a), exponent(s)); }
  State rate(Sliding<Real> at, State s) const {
    return {(1.0 - s.psi) * per_t_heal - abs(at.slip_rate) * s.psi * per_L};
  }
  State steady(Sliding<Real> at) const { return {1.0 / (1.0 + abs(at.slip_rate) * t_heal * per_L)}; }
};

}  // namespace rosin::laws
