/// What a laboratory sees of the contacts of a structure together: rows over its coordinates, and a stiffness.
#pragma once
#include "oscillators/structure.hpp"

namespace rosin::oscillators {

/// The displacement along slip, the mean over contacts by their loads: Σ N t / Σ N.
/// \throws InputError without a contact with friction, here and below
Eigen::VectorXd contact_displacement(const Structure&);

/// The force of springs on what touches (N): total friction, but for the inertia of that mass and for dampers. For a
/// block on springs it is their force, for several blocks the sum. With T = (t …) it is 1ᵀ (Tᵀ M⁻¹ T)⁻¹ Tᵀ M⁻¹ K.
Eigen::VectorXd spring_force(const Structure&);

/// Total friction over the displacement that it holds at rest, N/m; 0: no spring holds it.
double stiffness_at_contact(const Structure&);

}  // namespace rosin::oscillators
