/// Reading scenes for verbs, and performing them.
#pragma once
#include "app/scene/scene.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

/// The scene of a request as its verb reads it: the file, and overrides "path=value" whose value is TOML (bare words
/// are texts). \throws InputError that begins with file:line:column, the file, or the override, for anything that
/// cannot be used.
scene::Scene read_scene(const Request&);

/// \throws InputError for a wrong scene, Stopped where it was asked to end and has nothing to keep.
Status execute(const Request&);

}  // namespace rosin::app::verbs
