/// Friction along a line as friction in the plane: which laws have a vector form.
#pragma once
#include <string>
#include <vector>

#include "laws/law.hpp"

namespace rosin::laws {

/// Place among the states of the one that turns with the slip, a deflection or a stress; −1: there is none.
int turning_state(const FrictionLaw&);

/// Why the memory of a law has no form in the plane, a clause behind its name; empty where it has one. States that keep
/// their sign when the motion is mirrored do not turn: they answer to the size of the slip rate. One that changes it
/// becomes a vector, if its part of friction and rates is the same for slip either way (then rates are those of
/// bristles, v − a(|v|) z, or of a film, v − f(τ)). Laws without memory are not asked.
std::string refusal_in_plane(const FrictionLaw&, double normal_load);

/// Names of the laws of the catalogue with memory that have a form in the plane.
std::vector<std::string_view> names_in_plane();

}  // namespace rosin::laws
