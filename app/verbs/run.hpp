/// The motion of a scene's oscillator, whatever its type.
#pragma once
#include "analysis/motion/run.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::verbs {

analysis::motion::Run run_of(const scene::Scene&, const analysis::motion::RunOptions&);

}  // namespace rosin::app::verbs
