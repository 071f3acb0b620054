/// How a motion begins: `start` of [run] and [cycle].
#pragma once
#include "analysis/plane_run.hpp"
#include "analysis/start.hpp"
#include "app/scene/scene_table.hpp"
#include "laws/law.hpp"

namespace rosin::app {

/// "steady", "rest", or a table of displacement, velocity or slip rate, and states by name. \throws InputError
analysis::Start read_start(const toml::node&, const std::string& path, const FrictionLaw&);
/// The same of a slider in the plane: "rest", or a table of pairs.
void read_plane_start(const toml::node&, const std::string& path, analysis::PlaneModel&);

}  // namespace rosin::app
