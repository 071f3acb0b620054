/// One point of a plane: what is known of it before any integration, and what integration finds.
#pragma once
#include <optional>

#include "analysis/cycles/coexistence.hpp"
#include "analysis/lanes/cycle_lanes.hpp"
#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// What linear stability and the folds of cycles say of a point before any integration.
enum class PointVerdict : std::uint8_t { stable, look_for_cycle, look_beside_steady };
/// \throws InputError where steady sliding cannot be found or linearised.
PointVerdict judge(const Model&, cycles::CoexistenceSearch&);

MapPoint stable_point();
MapPoint failed_point(std::string why);
/// What lanes say of a point, or nothing where it is to be looked at by itself. `attracts`: steady sliding is stable.
std::optional<MapPoint> point_of(const lanes::LaneCycle&, bool attracts);
/// A point by itself, at the full order of the collocation. `near`: as in CycleOptions.
MapPoint compute_point(const Model&, double tolerance, double stick_threshold, bool attracts,
                       const std::vector<double>& near);

}  // namespace rosin::analysis::planes
