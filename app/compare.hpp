/// The verb `rosin compare`: laws and parameter sets side by side, and the design of measurements that tell them apart.
#pragma once
#include "app/job.hpp"

namespace rosin::app {

Status compare(Job&);

}  // namespace rosin::app
