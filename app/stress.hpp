/// The verb `rosin stress`: random scenes judged, counted and reported; failing ones are written as scene files.
#pragma once
#include "app/verbs.hpp"

namespace rosin::app {

Status stress(const Request&);

}  // namespace rosin::app
