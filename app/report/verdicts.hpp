/// What a result says in a sentence. Include only in .cpp files.
#pragma once
#include <string>
#include <vector>

#include "app/report/folder.hpp"

namespace rosin::app::report {

/// A physicist's sentence with the numbers that decide, as plain text; of a document that has none yet.
std::string verdict_of(const Result&);
/// What was left out or taken as simple, and why, each as a sentence.
std::vector<std::string> assumptions_of(const Result&);

}  // namespace rosin::app::report
