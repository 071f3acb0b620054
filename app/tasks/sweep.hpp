/// What the verb sweep is asked.
#pragma once
#include <string>

#include "analysis/planes/sweep.hpp"

namespace rosin::app::tasks {

struct Sweep {
  analysis::planes::SweepOptions options;
  std::string column;  ///< whose values the result lists and the picture shows
};

}  // namespace rosin::app::tasks
