/// Runs of a slider in the plane: two springs at right angles, friction against the velocity vector.
#pragma once
#include "analysis/motion/plane_model.hpp"
#include "analysis/motion/run.hpp"

namespace rosin::analysis::motion {

/// Columns displacement_x, displacement_y, velocity_x, velocity_y, friction_x, friction_y, then those of memory_of().
/// Solver "auto" or "exact": smooth slip by collocation, events located, checked by a second pass at a looser
/// tolerance; or, under Coulomb friction, a force algorithm, whose errors are the differences to that. \throws
/// InputError for other solvers, and what these refuse.
Run run_plane(const PlaneModel&, const RunOptions&);

/// Names of the solvers that serve in the plane.
std::vector<std::string> plane_solver_names();

}  // namespace rosin::analysis::motion
