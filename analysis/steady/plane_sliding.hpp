/// Steady sliding in the plane as that of a structure.
#pragma once
#include "oscillators/structure.hpp"
#include "solvers/stick_slip/dry_mass.hpp"

namespace rosin::analysis::steady {

/// The slider on its moving surface, linearised across the direction e in which it slides: along e it has the contact
/// of any slider; across e friction F turns with the slip, −F w⊥/V, as a damper of F/V does.
/// \param like  the contact but for its direction, speed and load
/// \throws InputError where the surface rests
oscillators::Structure sliding_in_plane(const solvers::stick_slip::DryMass<2>&, oscillators::FrictionContact like);

}  // namespace rosin::analysis::steady
