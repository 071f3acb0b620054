/// The verb cycle for structures, sliders under a drive that varies, and oscillators that are followed by steps.
#pragma once
#include <string_view>

#include "analysis/cycles/structure_cycle.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

/// Whether a summary has room for the metric: the period, extremes of displacements and slip rates, and stick.
bool is_told(std::string_view metric);

Status perform_structure_cycle(Job&);

}  // namespace rosin::app::verbs
