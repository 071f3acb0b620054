/// Thermal friction whose heat spreads from a disc of contact into the depth of a half-space.
#pragma once
#include "laws/conduction.hpp"
#include "laws/heated_curve.hpp"
#include "laws/law.hpp"

namespace rosin::laws {

/// The states are the temperature y (laws/heated_curve.hpp) and, in kelvin, the parts of the rise that belong to all
/// but the fastest exponential of laws/conduction.hpp.
template <class Real = double>
struct ThermalDisc {
  static constexpr Card card{
      .name = "thermal-disc",
      .title = "Thermal friction with conduction from a disc into depth",
      .formula = R"(F = N\mu(T)\,\mathrm{sgn}\,v,\quad T - T_a = \sum_k T_k,\quad
\lambda\tau_k t_r\Bigl(\frac{N}{N_\mathrm{ref}}\Bigr)^{s}\dot T_k =
\frac{\rho_k}{h_0}\Bigl[\Bigl(\frac{N}{N_\mathrm{ref}}\Bigr)^{1-m+s/2}\mu|v| - h_1|v|(T - T_a)\Bigr] - T_k,\quad
\mu(T)\text{ such that steady sliding at }N_\mathrm{ref}\text{ has }\mu = \mu_\infty + \mu_1 e^{-v/v_1} + \mu_2 e^{-v/v_2})",
      .source =
          "Smith & Woodhouse (2000); Woodhouse (2003); a disc on a half-space: Carslaw & Jaeger (1959), sect. 10.5",
      .limits =
          "sooner than 0.001 r2/kappa after a change of heating it warms like a thin layer; heat does not follow "
          "a change of load at once where the discs grow",
      .approximation = disc_approximation,
      .option = {"thermal", "conduction", "lumped", "disc"}};

  Real mu_inf = 0.35, mu_1 = 0.4, v_1 = 0.01, mu_2 = 0.45, v_2 = 0.1, time = 1e-3, h0 = 1e-3, h1 = 8e-3,
       area_exponent = 1, size_exponent = 0, N_ref = 1;
  static constexpr auto parameters =
      table(field(&ThermalDisc::mu_inf, "mu_inf", "1", {0, 10}, "friction of a hot contact"),
            field(&ThermalDisc::mu_1, "mu_1", "1", {0, 10}, "part of the steady curve that decays over v_1"),
            field(&ThermalDisc::v_1, "v_1", "m/s", {1e-12, 1e3}, "first decay speed"),
            field(&ThermalDisc::mu_2, "mu_2", "1", {0, 10}, "part of the steady curve that decays over v_2"),
            field(&ThermalDisc::v_2, "v_2", "m/s", {1e-12, 1e3}, "second decay speed"),
            field(&ThermalDisc::time, "time", "s", {1e-15, 1e15}, "r2/kappa at N_ref: radius squared over diffusivity"),
            field(&ThermalDisc::h0, "h0", "W/(K N)", {1e-12, 1e6},
                  "heat conducted away at rest, at N_ref per unit load: pi r K of each disc"),
            field(&ThermalDisc::h1, "h1", "J/(m K N)", {0, 1e6},
                  "heat swept away per length of slip, at N_ref per unit load"),
            field(&ThermalDisc::area_exponent, "area_exponent", "1", {0, 1},
                  "m of contact area ~ N^m: 1 in proportion to load, 0 fixed"),
            field(&ThermalDisc::size_exponent, "size_exponent", "1", {0, 1},
                  "s of the area of one disc ~ N^s, at most m: 0 for more discs of one size, m for one that grows"),
            field(&ThermalDisc::N_ref, "N_ref", "N", {1e-12, 1e12}, "load at which steady sliding has the curve"));

  struct State {
    Real y, T1, T2, T3, T4, T5, T6, T7, T8, T9;
  };
  static constexpr auto states =
      table(field(&State::y, "y", "m/s", {0, 1e12},
                  "temperature, as the slip rate that heats to it if nothing is swept away"),
            field(&State::T1, "T1", "K", {0, 1e15}, "part of the rise with the relaxation time 9.4e-4 r2/kappa"),
            field(&State::T2, "T2", "K", {0, 1e15}, "part of the rise with the relaxation time 4.9e-3 r2/kappa"),
            field(&State::T3, "T3", "K", {0, 1e15}, "part of the rise with the relaxation time 0.025 r2/kappa"),
            field(&State::T4, "T4", "K", {0, 1e15}, "part of the rise with the relaxation time 0.13 r2/kappa"),
            field(&State::T5, "T5", "K", {0, 1e15}, "part of the rise with the relaxation time 0.68 r2/kappa"),
            field(&State::T6, "T6", "K", {0, 1e15}, "part of the rise with the relaxation time 3.6 r2/kappa"),
            field(&State::T7, "T7", "K", {0, 1e15}, "part of the rise with the relaxation time 19 r2/kappa"),
            field(&State::T8, "T8", "K", {0, 1e15}, "part of the rise with the relaxation time 96 r2/kappa"),
            field(&State::T9, "T9", "K", {0, 1e15}, "part of the rise with the relaxation time 500 r2/kappa"));
  static_assert(std::tuple_size_v<decltype(states)> == disc_modes);

  static void check(const ThermalDisc<double>& law) {
    if (law.size_exponent > law.area_exponent)
      throw InputError(
          fmt::format("law.size_exponent = {} is above law.area_exponent = {}: discs would grow faster than all their "
                      "area; take at most the same",
                      law.size_exponent, law.area_exponent));
    law.curve.check();
  }

  HeatedCurve<Real> curve{mu_inf, mu_1, v_1, mu_2, v_2, h0, h1};
  /// Load over conductance, each over its value at N_ref; the conductance goes as number times radius of the discs.
  Real crowding(Sliding<Real> at) const {
    return power(Real(at.normal_load / N_ref), Real(1.0 - area_exponent + 0.5 * size_exponent));
  }

  Real friction(Sliding<Real>, State s) const { return curve.friction(curve.slip_rate(s.y)); }
  Real static_limit(Sliding<Real> at, State s) const { return friction(at, s); }
  State rate(Sliding<Real> at, State s) const {
    const Real& v = at.slip_rate;
    const auto here = curve.at(curve.slip_rate(s.y));
    const Real& mu = here.friction;
    const Real rise[] = {mu * s.y / h0, s.T1, s.T2, s.T3, s.T4, s.T5, s.T6, s.T7, s.T8, s.T9};
    const Real ends_at = mu * (crowding(at) * v - h1 / h0 * v * s.y) / h0;
    Real g[disc_modes];
    heat_rates(disc, ends_at, rise, g);
    const Real pace = 1.0 / (time * power(Real(at.normal_load / N_ref), size_exponent));
    return {g[0] * pace * h0 * h0 / here.rise_slope,
            g[1] * pace,
            g[2] * pace,
            g[3] * pace,
            g[4] * pace,
            g[5] * pace,
            g[6] * pace,
            g[7] * pace,
            g[8] * pace,
            g[9] * pace};
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
    return {y,
            disc[1].share * rise,
            disc[2].share * rise,
            disc[3].share * rise,
            disc[4].share * rise,
            disc[5].share * rise,
            disc[6].share * rise,
            disc[7].share * rise,
            disc[8].share * rise,
            disc[9].share * rise};
  }
};

}  // namespace rosin::laws
