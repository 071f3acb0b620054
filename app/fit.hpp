/// The verb `rosin fit`: parameters of laws from measurements, and laws ranked by how well they do.
#pragma once
#include "app/verbs.hpp"

namespace rosin::app {

Status fit(const Request&);

}  // namespace rosin::app
