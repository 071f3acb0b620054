/// What the verb lab is asked.
#pragma once
#include <optional>

#include "analysis/lab/experiment.hpp"

namespace rosin::app::tasks {

struct Lab {
  const analysis::lab::Experiment* experiment = nullptr;
  std::optional<analysis::lab::Task> task;
};

}  // namespace rosin::app::tasks
