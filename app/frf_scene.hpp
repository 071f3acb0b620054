/// The table [frf] of a scene.
#pragma once
#include <filesystem>

#include "app/scene.hpp"

namespace rosin::app {

class Table;

/// Files are looked for in `folder`. \throws InputError with the place of what cannot be used.
void read_frf(Table&, Scene&, const std::filesystem::path& folder);

}  // namespace rosin::app
