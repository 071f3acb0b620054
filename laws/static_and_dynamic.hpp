/// What laws with a static and a dynamic coefficient have in common.
#pragma once
#include <fmt/format.h>

#include "laws/law.hpp"

namespace rosin::laws {

/// \throws InputError where friction at rest, by the parameter of that name, may be smaller than friction in motion.
inline void require_static_above_dynamic(std::string_view name, double at_rest, double mu_d) {
  if (at_rest < mu_d)
    throw InputError(fmt::format(
        "law.{} = {} is below law.mu_d = {}: friction that holds at rest cannot be smaller than friction in "
        "motion; raise {} or lower mu_d",
        name, at_rest, mu_d, name));
}

/// Slip counted in units of a distance for laws that weaken over it: exact up to that distance, on which alone friction
/// depends, and beyond it levelling off at twice the distance, so that steady sliding has a state.
template <class Real>
Real counted_slip_rate(const Real& v, const Real& slip, const Real& distance) {
  return v * min(Real(1.0), Real(2.0 - slip / distance));
}

/// Coefficient that falls linearly from mu_s to mu_d over a distance of slip.
template <class Real>
Real linear_weakening(const Real& mu_s, const Real& mu_d, const Real& slip, const Real& distance) {
  return mu_d + (mu_s - mu_d) * max(Real(0.0), Real(1.0 - slip / distance));
}

/// Rate of the time at rest t: it passes in stick; in motion, when friction does not ask for it, it is forgotten over
/// t_c.
template <class Real>
Real time_at_rest_rate(const Real& v, const Real& t, const Real& t_c) {
  return select(v > Real(0.0), Real(-t / t_c), Real(1.0));
}

}  // namespace rosin::laws
