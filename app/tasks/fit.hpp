/// What the verb fit is asked.
#pragma once
#include <string>
#include <vector>

#include "analysis/inference/fit.hpp"

namespace rosin::app::tasks {

/// Data, and the laws that are fitted to them.
struct Fit {
  struct Candidate {
    std::string name;
    analysis::inference::Subject subject;
    std::vector<std::string> parameters;
    std::vector<analysis::inference::DerivedNumber> derived;
  };
  std::vector<Candidate> candidates;  ///< the scene's own law first
  std::vector<analysis::inference::Measurement> data;
  analysis::inference::FitOptions options;
};

}  // namespace rosin::app::tasks
