/// Thermal friction: the coefficient follows the contact's temperature, calibrated by a steady friction curve.
#pragma once
#include <fmt/format.h>

#include <cmath>

#include "laws/law.hpp"

namespace rosin::laws {

/// The temperature is carried as w, the slip rate whose steady sliding has it. A heat balance per unit load,
/// C·ΔṪ = μ v − (h₀ + h₁ v) ΔT with the steady rise ΔT(w) = μ(w) w/(h₀ + h₁ w), then gives ẇ without any table of μ
/// against temperature, and the calibration is exact.
template <class Real = double>
struct Thermal {
  static constexpr Card card{
      .name = "thermal",
      .title = "Thermal friction with one contact temperature",
      .formula = R"(F = N\mu(T)\,\mathrm{sgn}\,v,\quad
\lambda C\dot T = \mu|v| - (h_0 + h_1|v|)(T - T_a),\quad
\mu(T)\text{ such that steady sliding has }\mu = \mu_\infty + \mu_1 e^{-v/v_1} + \mu_2 e^{-v/v_2})",
      .source = "Smith & Woodhouse (2000); Woodhouse (2003): heat balance of a bowed string's contact",
      .limits = "one temperature: no spread of heat into depth; contact area in proportion to load"};

  Real mu_inf = 0.35, mu_1 = 0.4, v_1 = 0.01, mu_2 = 0.45, v_2 = 0.1, C = 5e-7, h0 = 1e-3, h1 = 8e-3;
  static constexpr auto parameters =
      table(field(&Thermal::mu_inf, "mu_inf", "1", {0, 10}, "friction of a hot contact"),
            field(&Thermal::mu_1, "mu_1", "1", {0, 10}, "part of the steady curve that decays over v_1"),
            field(&Thermal::v_1, "v_1", "m/s", {1e-12, 1e3}, "first decay speed"),
            field(&Thermal::mu_2, "mu_2", "1", {0, 10}, "part of the steady curve that decays over v_2"),
            field(&Thermal::v_2, "v_2", "m/s", {1e-12, 1e3}, "second decay speed"),
            field(&Thermal::C, "C", "J/(K N)", {1e-15, 1e6}, "heat capacity of the contact per unit load"),
            field(&Thermal::h0, "h0", "W/(K N)", {1e-12, 1e6}, "heat conducted away at rest per unit load"),
            field(&Thermal::h1, "h1", "J/(m K N)", {0, 1e6}, "heat swept away per length of slip and unit load"));

  struct State {
    Real w;
  };
  static constexpr auto states =
      table(field(&State::w, "w", "m/s", {0, 1e12}, "temperature, as the slip rate whose steady sliding has it"));

  struct Published {
    std::string_view name, source;
    Thermal law;
  };
  static std::vector<Published> presets() {
    return {
        {"violin-rosin", "curve: Smith & Woodhouse (2000); thermal constants of that order, not published", Thermal{}}};
  }

  /// The temperature must rise with the steady slip rate, else μ(T) is not a function.
  static void check(const Thermal<double>& law) {
    const double slow = 1e-3 * std::min(law.v_1, law.v_2), fast = 40 * std::max(law.v_1, law.v_2);
    for (double w = slow; w < fast; w *= 1.01)
      if (!(law.rise_slope(w) > 0))
        throw InputError(
            fmt::format("law.h1 = {:.6g} J/(m K N) is too large for this curve: steady sliding at {:.3g} m/s would be "
                        "colder than slower sliding, and friction no function of temperature; take h1/h0 below about "
                        "{:.3g} s/m, or a curve that falls less steeply",
                        law.h1, w, law.steepest_ratio()));
  }

  Real curve(const Real& w) const { return mu_inf + mu_1 * exp(-w / v_1) + mu_2 * exp(-w / v_2); }
  /// w dμ/dw
  Real fall(const Real& w) const { return -(mu_1 / v_1 * exp(-w / v_1) + mu_2 / v_2 * exp(-w / v_2)) * w; }
  /// d(ΔT)/dw times (h₀ + h₁ w)².
  Real rise_slope(const Real& w) const { return curve(w) * h0 + fall(w) * (h0 + h1 * w); }

  Real friction(Sliding<Real>, State s) const { return curve(s.w); }
  Real static_limit(Sliding<Real>, State s) const { return curve(s.w); }
  State rate(Sliding<Real> at, State s) const {
    const Real mu = curve(s.w);
    return {mu * h0 * (at.slip_rate - s.w) * (h0 + h1 * s.w) / (C * rise_slope(s.w))};
  }
  State steady(Sliding<Real> at) const { return {abs(at.slip_rate)}; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State size() const { return {v_1}; }

 private:
  /// The largest h₁/h₀ that the curve allows.
  double steepest_ratio() const {
    double least = infinity;
    const double fast = 40 * std::max(v_1, v_2);
    for (double w = 1e-3 * std::min(v_1, v_2); w < fast; w *= 1.01)
      if (const double falling = -fall(w); falling > 0) least = std::min(least, (curve(w) - falling) / (falling * w));
    return std::max(least, 0.0);
  }
};

}  // namespace rosin::laws
