/// The table [fit] of a scene.
#pragma once
#include "app/scene/reader.hpp"

namespace rosin::app::verbs {

/// True if events of stick–slip of the scene's oscillator are among the data.
bool fits_stick_slip(const toml::node& fit);
/// True if motions of the scene's oscillator are among the data.
bool fits_a_machine(const toml::node& fit);

/// Reads what is to be fitted, and the files of data. \throws InputError with the place of what cannot be used.
void read_fit(scene::Table, scene::SceneReader&);

}  // namespace rosin::app::verbs
