/// Eyring film that warms: a thin viscoelastic layer whose thermally activated flow heats it, and runs the faster.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct HotFilm {
  static constexpr Card card{
      .name = "hot-film",
      .title = "Eyring-Maxwell film with temperature",
      .formula = R"(F = A\tau,\quad
\frac{\lambda d}{S}\dot\tau = v - v_f,\quad
v_f = d\,K T\,e^{-(E_a + p V_a)/k_B T}\sinh\frac{\tau}{\tau_*},\quad p = N/A,\quad
\lambda t\,\dot\vartheta = R A \tau v_f - \vartheta,\quad T = T_a + \vartheta)",
      .source = "Woodhouse, Putelat & McKay (2015), eq 3.6; the heat balance, one lump, chosen here",
      .limits = "one temperature of the whole film; constants of a real film are not published"};

  Real A = 1e-8, d = 1e-9, S = 1e9, tau_star = 1e6, K = 1e8, E_a = 1e-19, V_a = 8e-29, T_a = 293.15, R = 4e3,
       time = 0.03;
  static constexpr auto parameters =
      table(field(&HotFilm::A, "A", "m2", {1e-18, 1e2}, "area of the film"),
            field(&HotFilm::d, "d", "m", {1e-12, 1}, "thickness of the film"),
            field(&HotFilm::S, "S", "Pa", {1, 1e15}, "shear modulus"),
            field(&HotFilm::tau_star, "tau_star", "Pa", {1e-3, 1e12}, "stress over which flow grows by e"),
            field(&HotFilm::K, "K", "1/(s K)", {1e-30, 1e30}, "attempts of flow per time and temperature"),
            field(&HotFilm::E_a, "E_a", "J", {0, 1e-17}, "activation energy of a jump"),
            field(&HotFilm::V_a, "V_a", "m3", {0, 1e-24}, "activation volume of a jump, against pressure"),
            field(&HotFilm::T_a, "T_a", "K", {1, 1e5}, "temperature of the surroundings"),
            field(&HotFilm::R, "R", "K/W", {0, 1e15}, "temperature rise of the film in steady flow per power"),
            field(&HotFilm::time, "time", "s", {1e-15, 1e15}, "time in which the film warms and cools"));

  struct State {
    Real tau, theta;
  };
  static constexpr auto states =
      table(field(&State::tau, "tau", "Pa", {-1e15, 1e15}, "shear stress of the film", Scale::linear, Parity::odd),
            field(&State::theta, "theta", "K", {0, 1e15}, "temperature of the film above its surroundings"));

  static constexpr double boltzmann = 1.380649e-23;  ///< k_B, J/K
  Real energy(Sliding<Real> at) const { return (E_a + at.normal_load / A * V_a) / boltzmann; }
  /// ln of the inverse of the flow's speed scale, at T.
  Real slowness(Sliding<Real> at, const Real& T) const { return energy(at) / T - log(Real(d * K * T)); }

  Real friction(Sliding<Real> at, State s) const { return A * s.tau / at.normal_load; }
  State rate(Sliding<Real> at, State s) const {
    const Real flow = sinh_exp(Real(s.tau / tau_star), slowness(at, Real(T_a + s.theta)));
    return {S / d * (at.slip_rate - flow), (R * A * s.tau * flow - s.theta) / time};
  }
  /// y = τ/τ_* = asinh(v e^s(T)), T = T_a + R A τ_* v y. As s falls with T, and convexly, the difference of the two
  /// sides is concave in y: Newton's method from 0 rises to the only root and does not overshoot.
  State steady(Sliding<Real> at) const {
    const Real &v = at.slip_rate, warming = R * A * tau_star * v;
    Real y = 0.0;
    constexpr int iterations = 40;  // heat of 10⁸ T_a takes 30
    for (int i = 0; i < iterations; ++i) {
      const Real T = T_a + warming * y, flowing = asinh_exp(v, slowness(at, T));
      y = y + (flowing - y) / (1.0 + warming * tanh(flowing) * (energy(at) / (T * T) + 1.0 / T));
    }
    return {tau_star * y, warming * y};
  }
  State rest(Sliding<Real>) const { return {Real(0.0), Real(0.0)}; }
  /// The temperature by which flow grows about e times.
  State size() const { return {tau_star, T_a / (1.0 + E_a / (boltzmann * T_a))}; }
};

}  // namespace rosin::laws
