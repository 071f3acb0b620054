/// Parameter planes as NetCDF-4 files that xarray opens with coordinates, units and flags.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace rosin::analysis::basins {
struct Basins;
}
namespace rosin::analysis::planes {
struct Map;
struct Sweep;
}  // namespace rosin::analysis::planes
namespace rosin::app::scene {
struct Scene;
}

namespace rosin::app::output {

/// Names of coordinates whose values are those of parameters: "normal_load" of "drive.normal_load". Where that is
/// another's name, or one of those that are taken, each is its whole path, "drive_normal_load".
std::vector<std::string> axis_names(const std::vector<std::string>& paths, const std::vector<std::string>& taken);

// Each \throws std::runtime_error if the file cannot be written.
void write_plane(const std::filesystem::path& path, const scene::Scene&, const analysis::planes::Map&);
/// Metrics over the values, or the moments of each value; those of values that have fewer are filled with NaN.
void write_sweep(const std::filesystem::path& path, const scene::Scene&, const analysis::planes::Sweep&);
/// The number of the attractor that each start comes to, over the grid, or with the places of random starts.
void write_basins(const std::filesystem::path& path, const scene::Scene&, const analysis::basins::Basins&);

}  // namespace rosin::app::output
