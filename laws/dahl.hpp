/// Dahl model: the force-displacement curve of a contact that yields gradually, up to the Coulomb force.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Dahl {
  static constexpr Card card{.name = "dahl",
                             .title = "Dahl model",
                             .formula = R"(\mu = \sigma_0 z,\quad \lambda\dot z = v - \frac{\sigma_0|v|}{\mu_d}\,z)",
                             .source = "Dahl (1968), with exponent 1",
                             .limits = "no dependence on slip rate: neither a static peak nor stick-slip"};

  Real sigma0 = 1e5, mu_d = 0.3;
  static constexpr auto parameters =
      table(field(&Dahl::sigma0, "sigma0", "1/m", {1e-6, 1e15}, "stiffness of the contact at rest per unit load"),
            field(&Dahl::mu_d, "mu_d", "1", {1e-6, 10}, "coefficient of steady sliding"));

  struct State {
    Real z;
  };
  static constexpr auto states =
      table(field(&State::z, "z", "m", {-1e6, 1e6}, "elastic deflection", Scale::linear, Parity::odd));

  Real friction(Sliding<Real>, State s) const { return sigma0 * s.z; }
  State rate(Sliding<Real> at, State s) const { return {at.slip_rate - sigma0 * abs(at.slip_rate) / mu_d * s.z}; }
  State steady(Sliding<Real> at) const { return {sign(at.slip_rate) * mu_d / sigma0}; }
  State rest(Sliding<Real>) const { return {Real(0.0)}; }
  State size() const { return {mu_d / sigma0}; }
};

}  // namespace rosin::laws
