/// Steady sliding of structures of many coordinates and its slowest modes, by sparse factorisations.
#pragma once
#include "analysis/steady/mode_tracking.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "oscillators/station_forces.hpp"

namespace rosin::analysis::steady {

/// Coordinates of steady sliding at t = 0, K q = f + dead load + Bᵀ f(B q, 0), by Newton's method from the place to
/// which the dead load alone presses the contacts, with friction brought up in parts where it does not get there at
/// once.
/// \throws InputError where there is none
Eigen::VectorXd steady_sliding(const oscillators::Structure&, const oscillators::StationForces&);

/// Small motions about steady sliding, in which contacts bear these forces.
QuadraticPencil pencil_of_sliding(const oscillators::Structure&, const oscillators::StationForces&,
                                  const oscillators::StationForces::Forces&);

/// As stability(), with the `count` modes of lowest |s| alone: a mesh flutters weakly, without damping, in modes that
/// only it has, whose frequencies lie far above and rise as it is refined.
/// \throws InputError as that, and for contacts with states
StructureStability lowest_modes_of_sliding(const oscillators::Structure&, int count);

}  // namespace rosin::analysis::steady
