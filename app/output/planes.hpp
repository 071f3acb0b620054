/// Parameter planes as NetCDF-4 files that xarray opens with coordinates, units and flags.
#pragma once
#include <filesystem>

#include "analysis/basins/basins.hpp"
#include "analysis/planes/map.hpp"
#include "analysis/planes/sweep.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::output {

// Each \throws std::runtime_error if the file cannot be written.
void write_plane(const std::filesystem::path& path, const scene::Scene&, const analysis::planes::Map&);
/// Metrics over the values, or the moments of each value; those of values that have fewer are filled with NaN.
void write_sweep(const std::filesystem::path& path, const scene::Scene&, const analysis::planes::Sweep&);
/// The number of the attractor that each start comes to, over the grid, or with the places of random starts.
void write_basins(const std::filesystem::path& path, const scene::Scene&, const analysis::basins::Basins&);

}  // namespace rosin::app::output
