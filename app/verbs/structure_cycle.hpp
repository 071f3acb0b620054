/// The verb cycle for structures, and for sliders under a drive that varies.
#pragma once
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

Status perform_structure_cycle(Job&);

}  // namespace rosin::app::verbs
