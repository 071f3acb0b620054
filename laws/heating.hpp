/// Any law whose contact warms as it slides and softens as it warms.
#pragma once
#include <memory>

#include "laws/conduction.hpp"
#include "laws/law.hpp"

namespace rosin::laws {

/// F = N·μ(v, ψ)/(1 + ϑ/ϑ_s), where the contact's temperature ϑ above its surroundings follows the power F·v through a
/// kernel of conduction: states beside the law's own and slowed by λ with them. Of one lump ϑ̇ = (R·F·v − ϑ)/t. In
/// steady sliding ϑ = R·F·v of any kernel, which is a quadratic equation.
struct Heating {
  double resistance = 0;  ///< R, K/W: temperature rise in steady sliding per power
  double time = 1;        ///< t, s: in which the contact warms and cools; the unit of the kernel's times
  double softening = 1;   ///< ϑ_s, K: temperature rise that halves friction
  std::span<const HeatMode> kernel = lump;
};

/// The law with heating. Its parameters are the law's, then "heating.resistance", "heating.time" and
/// "heating.softening"; its states are the law's, then "temperature_rise" and, for a kernel of several exponentials,
/// the parts "temperature_part_1" … of all but the fastest (K). \throws InputError outside the ranges, for laws with a
/// deflection, which give back a part of F·v, and for laws with more states than a contact has room for beside the
/// kernel's.
std::shared_ptr<const FrictionLaw> heated(std::shared_ptr<const FrictionLaw> law, const Heating&);

/// Ranges and units of the three parameters, in the order of Heating.
const std::vector<Quantity>& heating_parameters();

}  // namespace rosin::laws
