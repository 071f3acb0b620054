/// The sentence that a section of a report begins with. Include only in .cpp files.
#pragma once
#include <string>
#include <vector>

#include "app/report/folder.hpp"

namespace rosin::app::report {

/// A physicist's sentence with the numbers that decide, as plain text; others of the folder may complete it.
std::string verdict_of(const Folder&, const Result&);
/// What was left out or taken as simple, and why, each as a sentence.
std::vector<std::string> assumptions_of(const Result&);

}  // namespace rosin::app::report
