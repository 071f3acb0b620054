/// How a motion begins: `start` of [run] and [cycle].
#pragma once
#include "analysis/motion/plane_model.hpp"
#include "analysis/motion/start.hpp"
#include "app/scene/scene_table.hpp"
#include "laws/law.hpp"

namespace rosin::app::scene {

/// "steady", "rest", or a table of displacement, velocity or slip rate, and states by name. \throws InputError
analysis::motion::Start read_start(const toml::node&, const std::string& path, const FrictionLaw&);
/// States of a law at a start, by name with a suffix, or as `state`: natural values of those that are given.
std::map<std::string, double> read_start_states(Table&, const FrictionLaw&, const std::string& suffix);
/// The same of a slider in the plane: "rest", or a table of pairs.
void read_plane_start(const toml::node&, const std::string& path, analysis::motion::PlaneModel&);

}  // namespace rosin::app::scene
