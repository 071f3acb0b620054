/// The verb cycle for structures, sliders under a drive that varies, and oscillators that are followed by steps.
#pragma once
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

Status perform_structure_cycle(Job&);

}  // namespace rosin::app::verbs
