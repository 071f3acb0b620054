/// Scenes with a bowed string: how long it sounds, and what counts as a slip.
#pragma once
#include "app/scene/reader.hpp"

namespace rosin::app::scene {

/// [run] and [transient] of a string, where they are there.
void read_string(SceneReader&);
/// [cycle] and [transient] of a string: the motion that it comes to.
void read_string_cycle(SceneReader&);

}  // namespace rosin::app::scene
