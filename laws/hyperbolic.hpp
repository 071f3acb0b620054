/// Hyperbolic friction curve: friction falls from its static value in inverse proportion to 1 + delta·v.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Hyperbolic {
  static constexpr Card card{
      .name = "hyperbolic",
      .title = "Hyperbolic friction curve",
      .formula = R"(\mu = \frac{\mu_s}{1 + \delta\,|v|},\quad |F| \le \mu_s N \text{ at } v = 0)",
      .source = "Leine, van Campen, de Kraker & van den Steen (1998)",
      .limits = "friction follows speed at once and vanishes at high speed"};

  Real mu_s = 0.4, delta = 3;
  static constexpr auto parameters =
      table(field(&Hyperbolic::mu_s, "mu_s", "1", {0, 10}, "static coefficient, the largest that holds at rest"),
            field(&Hyperbolic::delta, "delta", "s/m", {0, 1e9}, "decay with speed: half of mu_s is left at 1/delta"));

  struct Published {
    std::string_view name, source;
    Hyperbolic law;
  };
  static std::vector<Published> presets() {
    return {{"leine",
             "Leine, van Campen, de Kraker & van den Steen (1998): F_s 1 N at a load of 1 N, delta 3 s/m",
             {.mu_s = 1, .delta = 3}}};
  }

  Real friction(Sliding<Real> at) const { return mu_s / (1.0 + delta * at.slip_rate); }
  Real static_limit(Sliding<Real>) const { return mu_s; }
};

}  // namespace rosin::laws
