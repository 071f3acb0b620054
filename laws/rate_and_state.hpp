/// What the rate-and-state laws of Dieterich and Ruina have in common: their parameters, under one name each.
///
/// All are regularised at v = 0: μ = a·asinh(v·e^E) with E = (μ₀ + Σ b ln(v₀θ/L))/a − ln 2v₀, which is
/// μ₀ + a ln(v/v₀) + Σ b ln(v₀θ/L) where v·e^E is large. Its inverse v = e^{−E} sinh(μ/a) is explicit.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

template <class L>
constexpr auto one_state_parameters() {
  return table(field(&L::mu0, "mu0", "1", {0, 5}, "friction at the reference slip rate"),
               field(&L::a, "a", "1", {1e-4, 0.5}, "direct effect"),
               field(&L::b, "b", "1", {0, 0.5}, "evolution effect; steady weakening when b > a"),
               field(&L::L, "L", "m", {1e-10, 1}, "slip that renews the contacts"),
               field(&L::v0, "v0", "m/s", {1e-14, 10}, "reference slip rate"));
}

template <class L>
constexpr auto two_state_parameters() {
  return table(field(&L::mu0, "mu0", "1", {0, 5}, "friction at the reference slip rate"),
               field(&L::a, "a", "1", {1e-4, 0.5}, "direct effect"),
               field(&L::b1, "b1", "1", {-0.5, 0.5}, "first evolution effect; steady weakening when b1 + b2 > a"),
               field(&L::L1, "L1", "m", {1e-10, 1}, "slip over which the first state evolves"),
               field(&L::b2, "b2", "1", {-0.5, 0.5}, "second evolution effect"),
               field(&L::L2, "L2", "m", {1e-10, 1}, "slip over which the second state evolves"),
               field(&L::v0, "v0", "m/s", {1e-14, 10}, "reference slip rate"));
}

inline constexpr Range any_age{1e-300, 1e300};  ///< seconds

}  // namespace rosin::laws
