/// Large planes from few points: patches refined on their own, each a unit of work that can be kept and resumed.
#pragma once
#include "analysis/cycles/coexistence.hpp"
#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// Computes the points of the plane that are not known. If somebody watches, work is weighed beforehand, which takes
/// some of the time itself. Neither who computes them nor what is known shows in the results. \throws Stopped
void compute_adaptively(const Model&, const MapOptions&, cycles::CoexistenceSearch&, const MapHooks&, Map&);

}  // namespace rosin::analysis::planes
