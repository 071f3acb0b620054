/// LuGre model: bristles that deflect under slip and give way, with a Stribeck curve in steady sliding.
#pragma once
#include <fmt/format.h>

#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Lugre {
  static constexpr Card card{
      .name = "lugre",
      .title = "LuGre bristle model",
      .formula = R"(\mu = \sigma_0 z + \sigma_1\lambda\dot z + \sigma_2 v,\quad
\lambda\dot z = v - \frac{\sigma_0|v|}{g(v)}\,z,\quad g = \mu_d + (\mu_s - \mu_d)\,e^{-(v/v_s)^2})",
      .source = "Canudas de Wit, Olsson, Astrom & Lischinsky (1995), eqs 3-5, per unit load",
      .limits = "drifts under a small oscillating force; a large sigma1 gives energy back as slip speeds up"};

  Real sigma0 = 1e5, sigma1 = 100, sigma2 = 0.4, mu_s = 0.4, mu_d = 0.3, v_s = 1e-3;
  static constexpr auto parameters =
      table(field(&Lugre::sigma0, "sigma0", "1/m", {1e-6, 1e15}, "stiffness of the bristles per unit load"),
            field(&Lugre::sigma1, "sigma1", "s/m", {0, 1e12}, "damping of the bristles per unit load"),
            field(&Lugre::sigma2, "sigma2", "s/m", {0, 1e6}, "viscous coefficient per unit load"),
            field(&Lugre::mu_s, "mu_s", "1", {1e-6, 10}, "static coefficient, that of slowest sliding"),
            field(&Lugre::mu_d, "mu_d", "1", {1e-6, 10}, "dynamic coefficient, far above v_s without viscous part"),
            field(&Lugre::v_s, "v_s", "m/s", {1e-12, 1e3}, "Stribeck speed, over which friction falls"));

  struct State {
    Real z;
  };
  static constexpr auto states =
      table(field(&State::z, "z", "m", {-1e6, 1e6}, "deflection of the bristles", Scale::linear, Parity::odd));

  struct Published {
    std::string_view name, source;
    Lugre law;
  };
  static std::vector<Published> presets() {
    return {{"canudas-de-wit",
             "Canudas de Wit, Olsson, Astrom & Lischinsky (1995), Table I, forces of a load of 1 N",
             {.sigma0 = 1e5, .sigma1 = 316.22776601683793, .sigma2 = 0.4, .mu_s = 1.5, .mu_d = 1, .v_s = 1e-3}}};
  }

  Real stribeck(Real v) const {
    const Real x = v / v_s;
    return mu_d + (mu_s - mu_d) * exp(-(x * x));
  }
  Real friction(Sliding<Real> at, State s) const {
    return sigma0 * s.z + sigma1 * rate(at, s).z + sigma2 * at.slip_rate;
  }
  State rate(Sliding<Real> at, State s) const {
    const Real v = at.slip_rate;
    return {v - sigma0 * abs(v) / stribeck(v) * s.z};
  }
  /// Without the bristles' damping, of whose large forces rounding would leave some.
  Real steady_friction(Sliding<Real> at) const {
    return sign(at.slip_rate) * stribeck(at.slip_rate) + sigma2 * at.slip_rate;
  }
  State steady(Sliding<Real> at) const { return {sign(at.slip_rate) * stribeck(at.slip_rate) / sigma0}; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State size() const { return {mu_s / sigma0}; }
  /// Bristles that follow at once leave the steady curve.
  LawByName without_clock(double) const { return {"stribeck", {mu_s, mu_d, v_s, 2.0, sigma2}}; }
};

}  // namespace rosin::laws
