/// The table [law] of a scene, or of a member of a comparison or a candidate of a fit.
#pragma once
#include "app/scene/scene_table.hpp"
#include "oscillators/model.hpp"

namespace rosin::app::scene {

struct SceneReader;

/// Sets law, lambda, contact stiffness and load memory of the model; a set-valued law is smoothed where the scene says
/// so. \throws InputError with its place.
void read_law(SceneReader&, Table, oscillators::Model&);

}  // namespace rosin::app::scene
