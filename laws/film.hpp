/// Eyring film: a thin viscoelastic layer that shears elastically and flows by thermally activated jumps.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Film {
  static constexpr Card card{
      .name = "film",
      .title = "Eyring-Maxwell film",
      .formula = R"(F = A\tau,\quad
\frac{\lambda d}{S}\dot\tau = v - v_0 e^{-p/p_0}\sinh\frac{\tau}{\tau_*},\quad p = N/A)",
      .source = "Eyring (1936); Woodhouse, Putelat & McKay (2015), eq 3.6, at one temperature",
      .limits = "one temperature, at which friction strengthens with slip rate: no stick-slip without heating"};

  Real A = 1e-8, d = 1e-9, S = 1e9, tau_star = 1e6, v0 = 1e-9, p0 = 5e7;
  static constexpr auto parameters = table(
      field(&Film::A, "A", "m2", {1e-18, 1e2}, "area of the film"),
      field(&Film::d, "d", "m", {1e-12, 1}, "thickness of the film"),
      field(&Film::S, "S", "Pa", {1, 1e15}, "shear modulus"),
      field(&Film::tau_star, "tau_star", "Pa", {1e-3, 1e12}, "stress over which flow grows by e"),
      field(&Film::v0, "v0", "m/s", {1e-30, 1e3}, "speed scale of flow without pressure"),
      field(&Film::p0, "p0", "Pa", {1, 1e15}, "pressure that slows flow by e: thermal energy over volume of a jump"));

  struct State {
    Real tau;
  };
  static constexpr auto states =
      table(field(&State::tau, "tau", "Pa", {-1e15, 1e15}, "shear stress of the film", Scale::linear, Parity::odd));

  /// ln of the inverse of the flow's speed scale.
  Real slowness(Sliding<Real> at) const { return at.normal_load / (A * p0) - log(v0); }

  Real friction(Sliding<Real> at, State s) const { return A * s.tau / at.normal_load; }
  State rate(Sliding<Real> at, State s) const {
    return {S / d * (at.slip_rate - sinh_exp(Real(s.tau / tau_star), slowness(at)))};
  }
  State steady(Sliding<Real> at) const { return {tau_star * asinh_exp(at.slip_rate, slowness(at))}; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State size() const { return {tau_star}; }
};

}  // namespace rosin::laws
