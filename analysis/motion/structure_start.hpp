/// Where the motion of a structure starts.
#pragma once
#include <optional>
#include <vector>

#include "analysis/motion/start.hpp"
#include "oscillators/structure_system.hpp"

namespace rosin::analysis::motion {

/// A start by its kind; what is not given is taken from steady sliding, or 0 where there is none.
struct StructureStart {
  Start::Kind kind = Start::Kind::steady;
  std::vector<std::optional<double>> coordinates, velocities;  ///< m, m/s; of the first coordinates, or of all
  std::vector<std::map<std::string, double>> states = {};      ///< of each contact, natural values by name
  Eigen::VectorXd beside = {};                                 ///< added to the coordinates; empty: nothing
  std::vector<double> unknowns = {};  ///< all of the system, in place of everything above; empty: not given
};

struct StructureModel {
  oscillators::Structure structure;
  StructureStart start;
};

/// The start as unknowns of the system at t = 0. "rest": all contacts move with their surfaces, other coordinates rest.
/// \throws InputError for a steady start without steady sliding, and for one behind a rigid stop.
std::vector<double> starting_point(const oscillators::StructureSystem&, const StructureStart&);

}  // namespace rosin::analysis::motion
