/// The verb `rosin fit`: parameters of laws from measurements, and laws ranked by how well they do.
#pragma once
#include "app/job.hpp"

namespace rosin::app {

Status fit(Job&);

}  // namespace rosin::app
