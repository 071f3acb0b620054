/// A scene for `rosin fit` out of a table of measurements.
#pragma once
#include <filesystem>
#include <string>

namespace rosin::app::verbs {

/// A scene that fits a law to the file: its columns by name and unit say what kind of measurement it is, and its
/// numbers where the search starts. \throws InputError for a file that no kind of measurement fits, with its columns
std::string fit_starter(const std::filesystem::path& file);

}  // namespace rosin::app::verbs
