/// The verb `rosin compare`: laws and parameter sets side by side, and the design of measurements that tell them apart.
#pragma once
#include <stop_token>

#include "app/verbs.hpp"

namespace rosin::app {

Status compare(const Request&, std::stop_token);

}  // namespace rosin::app
