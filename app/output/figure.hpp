/// Declared figures as scripts for gnuplot, which stay, so that a user can restyle them, and as JSON beside them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/results/figure.hpp"

namespace rosin::app::output {

/// Writes the script of a figure, NAME.gp, its declaration, NAME.figure.json, and the tables that only it needs into
/// the folder. \returns the names of the files
std::vector<std::string> write(const std::filesystem::path& folder, results::Figure);

/// The declaration, with what is usual left out: tables are files of the folder, columns are numbered from 1.
std::string to_json(const results::Figure&);

}  // namespace rosin::app::output
