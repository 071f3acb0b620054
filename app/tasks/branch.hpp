/// What the verb branch is asked.
#pragma once
#include <optional>

#include "analysis/branches/branches.hpp"
#include "analysis/motion/structure_start.hpp"
#include "core/parameters.hpp"

namespace rosin::app::tasks {

/// A parameter along which steady sliding and cycles are followed.
struct Branch {
  Quantity parameter;
  bool from_cycle = false;  ///< from the motion that has settled at the first value, else from steady sliding
  /// Where that motion starts, if it is given: of a structure, or of a slider that settles as one; of others.
  std::optional<analysis::motion::StructureStart> structure_start;
  std::optional<analysis::motion::Start> slider_start;
  analysis::branches::BranchOptions options;
  /// A second parameter, in which the points where branches change are followed.
  struct Locus {
    Quantity parameter;
    double value = 0;  ///< of the scene
    analysis::branches::LocusOptions options;
  };
  std::optional<Locus> locus;
};

}  // namespace rosin::app::tasks
