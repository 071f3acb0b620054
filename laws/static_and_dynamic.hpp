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

}  // namespace rosin::laws
