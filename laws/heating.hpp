/// Any law whose contact warms as it slides and softens as it warms.
#pragma once
#include <memory>

#include "laws/law.hpp"

namespace rosin::laws {

/// F = N·μ(v, ψ)/(1 + ϑ/ϑ_s), ϑ̇ = (R·F·v − ϑ)/t: one contact temperature ϑ above its surroundings, a state beside the
/// law's own and slowed by λ with them. In steady sliding ϑ = R·F·v, which is a quadratic equation.
struct Heating {
  double resistance = 0;  ///< R, K/W: temperature rise in steady sliding per power
  double time = 1;        ///< t, s: in which the contact warms and cools
  double softening = 1;   ///< ϑ_s, K: temperature rise that halves friction
};

/// The law with heating. Its parameters are the law's, then "heating.resistance", "heating.time" and
/// "heating.softening"; its states are the law's, then "temperature_rise" (K).
/// \throws InputError outside the ranges, and for laws with a deflection: these give back a part of F·v.
std::shared_ptr<const FrictionLaw> heated(std::shared_ptr<const FrictionLaw> law, const Heating&);

/// Ranges and units of the three parameters, in the order of Heating.
const std::vector<Quantity>& heating_parameters();

}  // namespace rosin::laws
