/// The verb `rosin frf`: the friction frequency response, predicted, simulated and measured.
#pragma once
#include "app/job.hpp"

namespace rosin::app {

Status frf(Job&);

}  // namespace rosin::app
