/// Thermal friction whose heat spreads from a disc of contact, under a layer that holds heat, into depth.
#pragma once
#include "laws/conduction.hpp"
#include "laws/heated_curve.hpp"
#include "laws/law.hpp"

namespace rosin::laws {

/// The states are the temperature y (laws/heated_curve.hpp) and, in kelvin, the parts of the rise that belong to all
/// but the fastest exponential of laws/conduction.hpp.
template <class Real = double>
struct ThermalLayer {
  static constexpr Card card{
      .name = "thermal-layer",
      .title = "Thermal friction with conduction from a disc under a thin layer",
      .formula = R"(F = N\mu(T)\,\mathrm{sgn}\,v,\quad T - T_a = \sum_k T_k,\quad
\lambda\tau_k t_r\dot T_k = \frac{\rho_k}{h_0}\Bigl[\Bigl(\frac{N}{N_\mathrm{ref}}\Bigr)^{1-m}\mu|v| - h_1|v|(T - T_a)\Bigr] - T_k,\quad
\mu(T)\text{ such that steady sliding at }N_\mathrm{ref}\text{ has }\mu = \mu_\infty + \mu_1 e^{-v/v_1} + \mu_2 e^{-v/v_2})",
      .source = "Smith & Woodhouse (2000); Woodhouse (2003); the layer: five relaxation times chosen here",
      .limits =
          "shares and times of the kernel are a choice, not measured: the thermal constants of rosin contacts "
          "are not published",
      .option = {"thermal", "conduction", "lumped", "layer"}};

  Real mu_inf = 0.35, mu_1 = 0.4, v_1 = 0.01, mu_2 = 0.45, v_2 = 0.1, time = 1e-3, h0 = 1e-3, h1 = 8e-3,
       area_exponent = 1, N_ref = 1;
  static constexpr auto parameters = table(
      field(&ThermalLayer::mu_inf, "mu_inf", "1", {0, 10}, "friction of a hot contact"),
      field(&ThermalLayer::mu_1, "mu_1", "1", {0, 10}, "part of the steady curve that decays over v_1"),
      field(&ThermalLayer::v_1, "v_1", "m/s", {1e-12, 1e3}, "first decay speed"),
      field(&ThermalLayer::mu_2, "mu_2", "1", {0, 10}, "part of the steady curve that decays over v_2"),
      field(&ThermalLayer::v_2, "v_2", "m/s", {1e-12, 1e3}, "second decay speed"),
      field(&ThermalLayer::time, "time", "s", {1e-15, 1e15}, "r2/kappa at N_ref: radius squared over diffusivity"),
      field(&ThermalLayer::h0, "h0", "W/(K N)", {1e-12, 1e6},
            "heat conducted away at rest, at N_ref per unit load: pi r K of each disc"),
      field(&ThermalLayer::h1, "h1", "J/(m K N)", {0, 1e6},
            "heat swept away per length of slip, at N_ref per unit load"),
      field(&ThermalLayer::area_exponent, "area_exponent", "1", {0, 1},
            "m of contact area ~ N^m: 1 in proportion to load, 0 fixed"),
      field(&ThermalLayer::N_ref, "N_ref", "N", {1e-12, 1e12}, "load at which steady sliding has the curve"));

  struct State {
    Real y, T1, T2, T3, T4;
  };
  static constexpr auto states =
      table(field(&State::y, "y", "m/s", {0, 1e12},
                  "temperature, as the slip rate that heats to it if nothing is swept away"),
            field(&State::T1, "T1", "K", {0, 1e15}, "part of the rise with the relaxation time 0.1 r2/kappa"),
            field(&State::T2, "T2", "K", {0, 1e15}, "part of the rise with the relaxation time 0.46 r2/kappa"),
            field(&State::T3, "T3", "K", {0, 1e15}, "part of the rise with the relaxation time 2.2 r2/kappa"),
            field(&State::T4, "T4", "K", {0, 1e15}, "part of the rise with the relaxation time 15 r2/kappa"));
  static_assert(std::tuple_size_v<decltype(states)> == layer_modes);

  static void check(const ThermalLayer<double>& law) { law.curve.check(); }

  HeatedCurve<Real> curve{mu_inf, mu_1, v_1, mu_2, v_2, h0, h1};
  /// What a part of the contact is loaded with, over its load at N_ref.
  Real crowding(Sliding<Real> at) const { return power(Real(at.normal_load / N_ref), Real(1.0 - area_exponent)); }

  Real friction(Sliding<Real>, State s) const { return curve.friction(curve.slip_rate(s.y)); }
  Real static_limit(Sliding<Real> at, State s) const { return friction(at, s); }
  State rate(Sliding<Real> at, State s) const {
    const Real& v = at.slip_rate;
    const auto here = curve.at(curve.slip_rate(s.y));
    const Real& mu = here.friction;
    const Real rise[] = {mu * s.y / h0, s.T1, s.T2, s.T3, s.T4};
    Real g[layer_modes];
    heat_rates(layered_disc, Real(mu * (crowding(at) * v - h1 / h0 * v * s.y) / h0), rise, g);
    const Real pace = 1.0 / time;
    return {g[0] * pace * h0 * h0 / here.rise_slope, g[1] * pace, g[2] * pace, g[3] * pace, g[4] * pace};
  }
  State steady(Sliding<Real> at) const {
    const Real v = abs(at.slip_rate), y = crowding(at) * v / (1.0 + h1 / h0 * v);
    return parted(y, Real(curve.friction(curve.slip_rate(y)) * y / h0));
  }
  State rest(Sliding<Real>) const { return parted(Real(0.0), Real(0.0)); }
  State size() const { return parted(v_1, Real(curve.friction(v_1) * v_1 / h0)); }

 private:
  /// A rise of temperature in the proportions of steady sliding.
  static State parted(const Real& y, const Real& rise) {
    return {y, layered_disc[1].share * rise, layered_disc[2].share * rise, layered_disc[3].share * rise,
            layered_disc[4].share * rise};
  }
};

}  // namespace rosin::laws
