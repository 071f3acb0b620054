/// Lines that divide a plane: where steady sliding loses its stability.
#pragma once
#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// What is known of steady sliding at a point of the grid.
enum class Side : std::uint8_t { stable, unstable, unknown };

/// The border of stability as polylines, located to rounding on the grid lines. `sides`: one for each point of the
/// plane, row by row; the border is looked for between points that differ.
Polyline threshold_of_sliding(const Model&, const Axis& x, const Axis& y, const std::vector<Side>& sides);

}  // namespace rosin::analysis::planes
