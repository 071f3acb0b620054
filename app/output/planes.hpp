/// Parameter planes as NetCDF-4 files that xarray opens with coordinates, units and flags.
#pragma once
#include <filesystem>

#include "analysis/planes/map.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::output {

/// \throws std::runtime_error if the file cannot be written.
void write_plane(const std::filesystem::path& path, const scene::Scene&, const analysis::planes::Map&);

}  // namespace rosin::app::output
