/// The picture of an experiment: its panels, with what is read off them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "analysis/lab/experiment.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::output {

/// Writes a script and the data that only it needs into the folder. \returns the names of the files
std::vector<std::string> write_lab_picture(const std::filesystem::path& folder, const scene::Scene&,
                                           const analysis::lab::Result&);

}  // namespace rosin::app::output
