/// LuGre model with stiffness and damping of the bristles that do not grow with the load.
#pragma once
#include "laws/lugre.hpp"

namespace rosin::laws {

template <class Real = double>
struct LugreUnscaled {
  static constexpr Card card{
      .name = "lugre-unscaled",
      .title = "LuGre bristle model, bristles independent of load",
      .formula = R"(F = \sigma_0 z + \sigma_1\lambda\dot z + \sigma_2 v,\quad
\lambda\dot z = v - \frac{\sigma_0|v|}{N g(v)}\,z,\quad g = \mu_d + (\mu_s - \mu_d)\,e^{-(v/v_s)^2})",
      .source = "Canudas de Wit, Olsson, Astrom & Lischinsky (1995), eqs 3-5, with g in proportion to load",
      .limits = "drifts under a small oscillating force; a large sigma1 gives energy back as slip speeds up",
      .option = {"lugre", "load_scaling", "load", "none"}};

  Real sigma0 = 1e5, sigma1 = 100, sigma2 = 0.4, mu_s = 0.4, mu_d = 0.3, v_s = 1e-3;
  static constexpr auto parameters = table(
      field(&LugreUnscaled::sigma0, "sigma0", "N/m", {1e-6, 1e15}, "stiffness of the bristles"),
      field(&LugreUnscaled::sigma1, "sigma1", "N s/m", {0, 1e12}, "damping of the bristles"),
      field(&LugreUnscaled::sigma2, "sigma2", "N s/m", {0, 1e6}, "viscous coefficient"),
      field(&LugreUnscaled::mu_s, "mu_s", "1", {1e-6, 10}, "static coefficient, that of slowest sliding"),
      field(&LugreUnscaled::mu_d, "mu_d", "1", {1e-6, 10}, "dynamic coefficient, far above v_s without viscous part"),
      field(&LugreUnscaled::v_s, "v_s", "m/s", {1e-12, 1e3}, "Stribeck speed, over which friction falls"));

  using State = typename Lugre<Real>::State;
  static constexpr auto states = Lugre<Real>::states;

  struct Published {
    std::string_view name, source;
    LugreUnscaled law;
  };
  static std::vector<Published> presets() {
    return {{"canudas-de-wit",
             "Canudas de Wit, Olsson, Astrom & Lischinsky (1995), Table I, Coulomb and static force at a load of 1 N",
             {.sigma0 = 1e5, .sigma1 = 316.22776601683793, .sigma2 = 0.4, .mu_s = 1.5, .mu_d = 1, .v_s = 1e-3}}};
  }

  /// The same bristles per unit of the present load.
  Lugre<Real> at_load(const Real& N) const { return {sigma0 / N, sigma1 / N, sigma2 / N, mu_s, mu_d, v_s}; }

  Real friction(Sliding<Real> at, State s) const { return at_load(at.normal_load).friction(at, s); }
  State rate(Sliding<Real> at, State s) const { return at_load(at.normal_load).rate(at, s); }
  Real steady_friction(Sliding<Real> at) const { return at_load(at.normal_load).steady_friction(at); }
  State steady(Sliding<Real> at) const { return at_load(at.normal_load).steady(at); }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  LawByName without_clock(double N) const { return at_load(N).without_clock(N); }
};

}  // namespace rosin::laws
