/// What a friction response is used for: is a structure with this contact stable? Include only in .cpp files.
#pragma once
#include "app/verbs/job.hpp"

namespace rosin::app::verbs {

/// Adds `stability` to the document of a response, says it, and draws the loop. Only where the scene has a structure.
void add_stability(Job&, results::Result&, std::vector<std::string>& files);

}  // namespace rosin::app::verbs
