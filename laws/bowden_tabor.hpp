/// Bowden-Tabor product: area of real contact, which ages, times its shear strength, which rises with slip rate.
#pragma once
#include <fmt/format.h>

#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct BowdenTabor {
  static constexpr Card card{
      .name = "bowden-tabor",
      .title = "Bowden-Tabor product of contact area and shear strength",
      .formula =
          R"(\mu = \Gamma(\psi)\,S(v),\quad \Gamma = 1 + \frac{b}{\mu_0}\ln\Bigl(c + \frac{\psi}{\psi_*}\Bigr),\quad
S = a\,\mathrm{asinh}\Bigl(\frac{v}{2v_0}e^{\mu_0/a}\Bigr),\quad
\lambda\dot\psi = \frac{1-\psi}{t_\mathrm{heal}} - \frac{|v|\psi}{L},\quad \psi_* = \frac{L}{L + v_0 t_\mathrm{heal}})",
      .source = "Bowden & Tabor (1950); Woodhouse, Putelat & McKay (2015), eq 2.9, with the functions of eqs 2.10-2.13",
      .limits = "slow sliding; the contact area must stay positive: 1 + (b/mu0) ln c > 0"};

  Real mu0 = 0.369, a = 0.0349, b = 0.0489, L = 0.9e-6, v0 = 1e-6, c = 1e-2, t_heal = 90;

  static constexpr auto parameters =
      table(field(&BowdenTabor::mu0, "mu0", "1", {1e-6, 5}, "friction at the reference slip rate (c negligible)"),
            field(&BowdenTabor::a, "a", "1", {1e-4, 0.5}, "direct effect of the strength"),
            field(&BowdenTabor::b, "b", "1", {0, 0.5}, "evolution effect of the area; weakening somewhere needs b > a"),
            field(&BowdenTabor::L, "L", "m", {1e-10, 1}, "slip that renews the contacts"),
            field(&BowdenTabor::v0, "v0", "m/s", {1e-14, 10}, "reference slip rate"),
            field(&BowdenTabor::c, "c", "1", {1e-12, 1}, "cut-off of the state at high slip rate"),
            field(&BowdenTabor::t_heal, "t_heal", "s", {1e-6, 1e12}, "healing time of contacts at rest"));

  struct State {
    Real psi;
  };
  static constexpr auto states =
      table(field(&State::psi, "psi", "1", {1e-300, 1}, "interface state, the healed fraction", Scale::log));

  static void check(const BowdenTabor<double>& law) {
    const double least = 1 + law.b / law.mu0 * std::log(law.c);
    if (!(least > 0))
      throw InputError(
          fmt::format("law.mu0 = {}, law.b = {} and law.c = {} leave fast sliding without contact: its relative area "
                      "1 + (b/mu0) ln c = {:.3g} must be positive; raise c above {:.3g} or lower b",
                      law.mu0, law.b, law.c, least, std::exp(-law.mu0 / law.b)));
  }

  Real psi_ref = L / (L + v0 * t_heal);                  ///< ψ*, steady state at v0
  Real b_by_mu0 = b / mu0, E = mu0 / a - log(2.0 * v0);  ///< S = a asinh(v e^E)
  Real area(State s) const { return 1.0 + b_by_mu0 * log(c + s.psi / psi_ref); }

  Real friction(Sliding<Real> at, State s) const { return area(s) * (a * asinh_exp(at.slip_rate, E)); }
  Real slip_rate(Real mu, Sliding<Real>, State s) const { return sinh_exp(Real(mu / (a * area(s))), E); }
  State rate(Sliding<Real> at, State s) const { return {(1.0 - s.psi) / t_heal - abs(at.slip_rate) * s.psi / L}; }
  State steady(Sliding<Real> at) const { return {1.0 / (1.0 + abs(at.slip_rate) * t_heal / L)}; }
};

}  // namespace rosin::laws
