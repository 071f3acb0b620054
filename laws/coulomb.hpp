/// Coulomb friction: one coefficient at rest, another in motion, neither depending on speed.
#pragma once
#include <fmt/format.h>

#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Coulomb {
  static constexpr Card card{
      .name = "coulomb",
      .title = "Coulomb friction",
      .formula = R"(|F| \le \mu_s N \text{ at } v = 0,\quad F = \mu_d N\,\mathrm{sgn}\,v \text{ otherwise})",
      .source = "Amontons (1699); Coulomb (1785)",
      .limits = "no dependence on speed or history: every velocity step is answered by nothing"};

  Real mu_s = 0.4, mu_d = 0.3;
  static constexpr auto parameters =
      table(field(&Coulomb::mu_s, "mu_s", "1", {0, 10}, "static coefficient, the largest that holds at rest"),
            field(&Coulomb::mu_d, "mu_d", "1", {0, 10}, "dynamic coefficient, in motion"));

  static void check(const Coulomb<double>& law) {
    if (law.mu_s < law.mu_d)
      throw InputError(
          fmt::format("law.mu_s = {} is below law.mu_d = {}: friction that holds at rest cannot be "
                      "smaller than friction in motion; raise mu_s or lower mu_d",
                      law.mu_s, law.mu_d));
  }

  Real friction(Sliding<Real>) const { return mu_d; }
  LinearFriction linear() const { return {mu_d, 0}; }
  Real static_limit(Sliding<Real>) const { return mu_s; }
};

}  // namespace rosin::laws
