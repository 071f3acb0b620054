/// What the verb compare is asked.
#pragma once
#include <string>
#include <vector>

#include "analysis/inference/discrimination.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::tasks {

/// Scenes side by side, and what is made equal in them beforehand.
struct Compare {
  struct Member {
    std::string name;
    scene::Scene scene;            ///< as the verb of the protocol reads it
    std::vector<double> adjusted;  ///< values of the parameters that were adjusted
    double difference = 0;         ///< that is left of the properties made equal, relative
  };
  std::vector<Member> members;  ///< the first is the one that the others are compared with
  std::string protocol = "cycle";
  std::vector<std::string> adjust;  ///< paths of parameters
  std::vector<analysis::inference::Noise> noise;
  double confidence = 0.95;
  std::string parameter;  ///< of which a design asks; empty: it tells members apart
};

}  // namespace rosin::app::tasks
