/// Large planes from few points: patches refined on their own, each a unit of work that can be kept and resumed.
#pragma once
#include <functional>
#include <utility>
#include <vector>

#include "analysis/cycles/coexistence.hpp"
#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// Points [row by row] with what was found there, and the work done for them as a part of all.
using FinishedPoints = std::vector<std::pair<std::size_t, MapPoint>>;

/// Computes the points of the plane that are not done in `known`. `finish` is called from several threads; if
/// `foretell`, work is weighed beforehand, which takes some of the time itself. Neither
/// their number nor what is known shows in the results. \throws Stopped
void compute_adaptively(const Model&, const MapOptions&, cycles::CoexistenceSearch&, const std::vector<MapPoint>& known,
                        bool foretell, const std::function<void(FinishedPoints&, double work)>& finish);

}  // namespace rosin::analysis::planes
