/// The table [frf] of a scene.
#pragma once
#include <filesystem>

#include "app/scene.hpp"
#include "app/scene_table.hpp"

namespace rosin::app {

/// Files are looked for in `folder`; `oscillator` is the scene's, or null. \throws InputError with the place of what
/// cannot be used.
void read_frf(Table&, Scene&, const toml::node* oscillator, const std::filesystem::path& folder);

}  // namespace rosin::app
