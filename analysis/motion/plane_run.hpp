/// Runs of a slider in the plane: two springs at right angles, friction against the velocity vector.
#pragma once
#include "analysis/motion/run.hpp"
#include "solvers/force_algorithms/stepped_motion.hpp"
#include "solvers/stick_slip/plane_stick_slip.hpp"

namespace rosin::analysis::motion {

/// A plane slider, and where it starts.
struct PlaneModel {
  solvers::force_algorithms::DryMass<2> mass;
  solvers::force_algorithms::Vector<2> displacement{}, velocity{};
  /// Without states, where friction depends on the slip rate; the mass then has its coefficients at rest and in the
  /// slowest slip, both 0 of a law that is not set-valued. Null: Coulomb friction with the mass's coefficients.
  std::shared_ptr<const FrictionLaw> law = nullptr;
};

/// Columns displacement_x, displacement_y, velocity_x, velocity_y, friction_x, friction_y. Solver "auto" or "exact":
/// smooth slip by collocation, events located, checked by a second pass at a looser tolerance; or, under
/// Coulomb friction, a force algorithm, whose errors are the differences to that. \throws InputError for other solvers,
/// and what these refuse.
Run run_plane(const PlaneModel&, const RunOptions&);

/// The law where friction depends on the slip rate, as the solver takes it.
solvers::stick_slip::SlipFriction slip_friction(const PlaneModel&);

/// Names of the solvers that serve in the plane.
std::vector<std::string> plane_solver_names();

}  // namespace rosin::analysis::motion
