/// The table [frf] of a scene.
#pragma once
#include "app/scene/reader.hpp"

namespace rosin::app {

/// \param oscillator the scene's, or null. \throws InputError with the place of what cannot be used.
void read_frf(Table, SceneReader&, const toml::node* oscillator);

}  // namespace rosin::app
