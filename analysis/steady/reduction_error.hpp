/// What the reduction of a structure changes in the modes and thresholds of its steady sliding.
#pragma once
#include <functional>
#include <vector>

#include "analysis/steady/thresholds.hpp"
#include "oscillators/block_reduction.hpp"

namespace rosin::analysis::steady {

/// Distance of each mode of the reduced structure to that of the whole one (1/s), which two-sided inverse iteration
/// finds from the eigenvalue and the shape: a few sparse factorisations each. Infinite, not known, where it leads away
/// from the mode by more than a quarter of the distance to the next one, and for contacts with states.
std::vector<double> reduction_errors(const oscillators::Reduction&, const StructureStability& of_reduced);

/// Half of an interval about the crossing of a reduced structure at whose ends the mode of the whole one is calm and
/// grows. It begins as growth of the whole at the crossing, over the slope of growth of the reduced one, and is doubled
/// until that holds. Infinite, not known, where it does not, and for contacts with states.
double reduction_error(const Crossing&, const std::function<oscillators::Reduction(double)>& reduction_at,
                       const std::function<StructureStability(const oscillators::Structure&)>& stability_of);

}  // namespace rosin::analysis::steady
