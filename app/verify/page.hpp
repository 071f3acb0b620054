/// The dossier as a page: tables of what was wanted and what came out, with sources, and a picture for each group.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/verify/answer.hpp"

namespace rosin::app::verify {

/// The number wanted (of a list the one that is furthest off) in the unit of its source, and what came out.
std::string wanted_text(const Answer&);
std::string got_text(const Answer&);
/// A ratio in three characters or so; "–" where it is none.
std::string readable_ratio(double);
/// "agrees: 41, disagrees: 1"
std::string counted(const std::vector<Answer>&);

/// Writes verify.md and a script for the picture of each group that has numbers. \returns the files' names
std::vector<std::string> write_page(const std::filesystem::path& folder, const std::vector<Answer>&);

}  // namespace rosin::app::verify
