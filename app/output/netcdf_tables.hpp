/// Tables of a results folder as NetCDF, beside those in CSV.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/scene/scene.hpp"

namespace rosin::app::output {

/// Writes `run.nc` for `run.csv`, and so on, of every table among the files that is whole, has rows, and stands there
/// in no NetCDF yet. `document`: the result, which knows what columns mean and their errors. \returns the files
std::vector<std::string> write_netcdf_tables(const std::filesystem::path& folder, const std::vector<std::string>& files,
                                             const scene::Scene&, const std::string& document);

}  // namespace rosin::app::output
