/// The table [fit] of a scene.
#pragma once
#include "app/scene/reader.hpp"

namespace rosin::app::verbs {

/// Reads what is to be fitted, and the files of data. \throws InputError with the place of what cannot be used.
void read_fit(scene::Table, scene::SceneReader&);

}  // namespace rosin::app::verbs
