/// The verb cycle, as far as others share in it.
#pragma once
#include <string>
#include <vector>

#include "app/scene/scene.hpp"

namespace rosin::app::verbs {

/// The metrics that a summary has room for, in its order: those of Metrics, extremes of coordinates and slip rates, and
/// stick.
std::vector<std::string> told_metrics(const scene::Scene&, const std::vector<std::string>& known);

}  // namespace rosin::app::verbs
