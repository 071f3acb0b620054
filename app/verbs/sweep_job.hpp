/// What the verbs sweep and map have in common: a sweep that a scene asks for.
#pragma once
#include "app/verbs/job.hpp"

namespace rosin::app::verbs {

/// Computes the sweep of the scene, or goes on with one that was interrupted, and writes its results.
Status perform_sweep(Job&);

}  // namespace rosin::app::verbs
