/// What the dense and the tracked modes of steady sliding are asked and say alike.
#pragma once
#include "analysis/steady/structure_stability.hpp"
#include "core/eigenpairs.hpp"

namespace rosin::analysis::steady {

/// \throws InputError for a contact at rest, unless it has no friction.
void require_sliding(const oscillators::Structure&);

/// Eigenvalues of small motions about steady sliding. \throws InputError where they are no numbers, of which none is a
/// verdict
Spectrum spectrum_of_sliding(const MovingPart&);

/// Orders modes and eigenvalues by their growth, and decides by the fastest (1/s), known to its error.
/// \throws InputError where eigenvalues are no numbers
void conclude(StructureStability&, double fastest_growth, double error);

}  // namespace rosin::analysis::steady
