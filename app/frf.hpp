/// The verb `rosin frf`: the friction frequency response, predicted, simulated and measured.
#pragma once
#include "app/verbs.hpp"

namespace rosin::app {

Status frf(const Request&);

}  // namespace rosin::app
