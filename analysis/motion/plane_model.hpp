/// A slider in the plane: two springs at right angles, friction along the slip or along what it remembers of it.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "laws/law.hpp"
#include "solvers/stick_slip/plane_solver.hpp"

namespace rosin::analysis::motion {

/// A plane slider, and where it starts.
struct PlaneModel {
  solvers::stick_slip::DryMass<2> mass;
  solvers::stick_slip::PlaneVector displacement{}, velocity{};
  /// Where friction depends on the slip rate or on states; null: Coulomb friction with the mass's coefficients. Without
  /// states the mass has its coefficients at rest and in the slowest slip, both 0 of a law that is not set-valued; with
  /// states it is smooth at rest (laws::refusal_in_plane), and both are 0.
  std::shared_ptr<const FrictionLaw> law = nullptr;
  double lambda = 1;  ///< clock factor of the states, above 0
  /// States at the start by the names of memory_of(); others are those of steady sliding at the slip rate, or of long
  /// rest on the surface.
  std::map<std::string, double> states = {};

  bool remembers() const { return law && law->has_states(); }
};

/// A number that the contact remembers. A state that turns with the slip is two, named NAME_x and NAME_y, along the
/// slip rate as on a line: that of the surface against the mass.
struct PlaneMemory {
  Quantity state;
  int place;  ///< of its unknown among those of the contact
};
/// Empty of a slider that remembers nothing.
std::vector<PlaneMemory> memory_of(const PlaneModel&);

/// By events, or, where friction remembers, by smooth steps. \param stick_threshold  over the speed of the surface, of
/// friction that remembers: slower slip counts as stick. \throws InputError for a law without a form in the plane
std::unique_ptr<solvers::stick_slip::PlaneSolver> solver_of(const PlaneModel&, double tolerance,
                                                            double stick_threshold = 0);

/// The model's start as a state of its solver.
std::vector<double> start_of(const PlaneModel&);

/// Sizes by which states of its solver are compared; infinite: an entry is not.
std::vector<double> sizes_of(const PlaneModel&);

}  // namespace rosin::analysis::motion
