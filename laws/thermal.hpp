/// Thermal friction: the coefficient follows the contact's temperature, calibrated by a steady friction curve.
#pragma once
#include "laws/heated_curve.hpp"
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Thermal {
  static constexpr Card card{
      .name = "thermal",
      .title = "Thermal friction with one contact temperature",
      .formula = R"(F = N\mu(T)\,\mathrm{sgn}\,v,\quad
\lambda C\dot T = \Bigl(\frac{N}{N_\mathrm{ref}}\Bigr)^{1-m}\mu|v| - (h_0 + h_1|v|)(T - T_a),\quad
\mu(T)\text{ such that steady sliding at }N_\mathrm{ref}\text{ has }\mu = \mu_\infty + \mu_1 e^{-v/v_1} + \mu_2 e^{-v/v_2})",
      .source = "Smith & Woodhouse (2000); Woodhouse (2003): heat balance of a bowed string's contact",
      .limits = "one temperature: no spread of heat into depth, for which there is thermal-disc"};

  Real mu_inf = 0.35, mu_1 = 0.4, v_1 = 0.01, mu_2 = 0.45, v_2 = 0.1, C = 5e-7, h0 = 1e-3, h1 = 8e-3, area_exponent = 1,
       N_ref = 1;
  static constexpr auto parameters = table(
      field(&Thermal::mu_inf, "mu_inf", "1", {0, 10}, "friction of a hot contact"),
      field(&Thermal::mu_1, "mu_1", "1", {0, 10}, "part of the steady curve that decays over v_1"),
      field(&Thermal::v_1, "v_1", "m/s", {1e-12, 1e3}, "first decay speed"),
      field(&Thermal::mu_2, "mu_2", "1", {0, 10}, "part of the steady curve that decays over v_2"),
      field(&Thermal::v_2, "v_2", "m/s", {1e-12, 1e3}, "second decay speed"),
      field(&Thermal::C, "C", "J/(K N)", {1e-15, 1e6}, "heat capacity of the contact at N_ref per unit load"),
      field(&Thermal::h0, "h0", "W/(K N)", {1e-12, 1e6}, "heat conducted away at rest, at N_ref per unit load"),
      field(&Thermal::h1, "h1", "J/(m K N)", {0, 1e6}, "heat swept away per length of slip, at N_ref per unit load"),
      field(&Thermal::area_exponent, "area_exponent", "1", {0, 1},
            "m of contact area ~ N^m: 1 in proportion to load, 0 fixed"),
      field(&Thermal::N_ref, "N_ref", "N", {1e-12, 1e12}, "load at which steady sliding has the curve"));

  struct State {
    Real y;
  };
  static constexpr auto states = table(field(
      &State::y, "y", "m/s", {0, 1e12}, "temperature, as the slip rate that heats to it if nothing is swept away"));

  struct Published {
    std::string_view name, source;
    Thermal law;
  };
  static std::vector<Published> presets() {
    return {
        {"violin-rosin", "curve: Smith & Woodhouse (2000); thermal constants of that order, not published", Thermal{}}};
  }

  static void check(const Thermal<double>& law) { law.curve.check(); }

  HeatedCurve<Real> curve{mu_inf, mu_1, v_1, mu_2, v_2, h0, h1};
  /// What a part of the contact is loaded with, over its load at N_ref.
  Real crowding(Sliding<Real> at) const { return power(Real(at.normal_load / N_ref), Real(1.0 - area_exponent)); }

  Real friction(Sliding<Real>, State s) const { return curve.friction(curve.slip_rate(s.y)); }
  Real static_limit(Sliding<Real> at, State s) const { return friction(at, s); }
  State rate(Sliding<Real> at, State s) const {
    const Real& v = at.slip_rate;
    const auto here = curve.at(curve.slip_rate(s.y));
    const Real heating = here.friction * (crowding(at) * v - s.y * (1.0 + h1 / h0 * v));  // C dT/dt
    return {heating * h0 * h0 / (C * here.rise_slope)};
  }
  State steady(Sliding<Real> at) const {
    const Real v = abs(at.slip_rate);
    return {crowding(at) * v / (1.0 + h1 / h0 * v)};
  }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State size() const { return {v_1}; }
};

}  // namespace rosin::laws
