/// Stribeck friction curve: friction falls from static to dynamic over a characteristic speed, then rises viscously.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Stribeck {
  static constexpr Card card{
      .name = "stribeck",
      .title = "Stribeck friction curve",
      .formula =
          R"(\mu = \mu_d + (\mu_s - \mu_d)\,e^{-(|v|/v_s)^{n}} + \eta\,|v|,\quad |F| \le \mu_s N \text{ at } v = 0)",
      .source = "Stribeck (1902); exponential form after Bo & Pavelescu (1982)",
      .limits = "friction follows speed at once: no memory, no direct effect"};

  Real mu_s = 0.4, mu_d = 0.3, v_s = 0.01, exponent = 2, viscous = 0;
  static constexpr auto parameters =
      table(field(&Stribeck::mu_s, "mu_s", "1", {0, 10}, "static coefficient, the largest that holds at rest"),
            field(&Stribeck::mu_d, "mu_d", "1", {0, 10}, "dynamic coefficient, far above v_s without viscous part"),
            field(&Stribeck::v_s, "v_s", "m/s", {1e-12, 1e3}, "Stribeck speed, over which friction falls"),
            field(&Stribeck::exponent, "exponent", "1", {0.1, 10}, "sharpness n of the fall"),
            field(&Stribeck::viscous, "viscous", "s/m", {0, 1e6}, "viscous coefficient, eta, per unit load"));

  struct Published {
    std::string_view name, source;
    Stribeck law;
  };
  static std::vector<Published> presets() {
    return {{"canudas-de-wit",
             "Canudas de Wit, Olsson, Astrom & Lischinsky (1995), Table I, forces of a load of 1 N: F_S 1.5 N, F_C 1 N",
             {.mu_s = 1.5, .mu_d = 1, .v_s = 1e-3, .exponent = 2, .viscous = 0.4}}};
  }

  /// Below this share of v_s no digit of friction changes. With n < 1 the slope at rest would be infinite without it.
  Real rest = select(exponent < Real(1.0), Real(exp(-39.0 / exponent)), Real(0.0));
  Real friction(Sliding<Real> at) const {
    return mu_d + (mu_s - mu_d) * exp(-power(Real(at.slip_rate / v_s + rest), exponent)) + viscous * at.slip_rate;
  }
  std::optional<LinearFriction> linear() const {
    if (mu_s != mu_d) return std::nullopt;  // else the exponential remains
    return LinearFriction{mu_d, viscous};
  }
  Real static_limit(Sliding<Real>) const { return mu_s; }
};

}  // namespace rosin::laws
