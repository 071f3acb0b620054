/// The motion of a scene's oscillator, whatever its type, and what is read for it.
#pragma once
#include "analysis/motion/run.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::verbs {

/// A start as the type of oscillator takes it; of a slider that is no structure it is that of the run's options.
void read_start_of_run(const toml::node&, const std::string& path, scene::Scene&);
/// [solver]
void read_solver(scene::Table, scene::SceneReader&);

analysis::motion::Run run_of(const scene::Scene&, const analysis::motion::RunOptions&);

}  // namespace rosin::app::verbs
