/// What the verb stability is asked.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "analysis/planes/map.hpp"
#include "core/parameters.hpp"

namespace rosin::app::tasks {

/// A parameter along which the stability of a structure is followed.
struct StabilityScan {
  Quantity parameter;
  analysis::planes::Axis axis;
};

struct Stability {
  std::vector<std::string> parameters;  ///< paths asked for besides the usual ones
  int modes = 0;                        ///< of lowest frequency; 0: all
  std::optional<StabilityScan> scan;
};

}  // namespace rosin::app::tasks
