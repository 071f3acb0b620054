/// The verb study.
#pragma once
#include "app/job.hpp"

namespace rosin::app {

Status study(Job&);

}  // namespace rosin::app
