/// The table [frf] of a scene.
#pragma once
#include "app/scene/reader.hpp"

namespace rosin::app::verbs {

/// \param oscillator the scene's, or null. \throws InputError with the place of what cannot be used.
void read_frf(scene::Table, scene::SceneReader&, const toml::node* oscillator);

}  // namespace rosin::app::verbs
