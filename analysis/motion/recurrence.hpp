/// Whether a motion recurs, by what is recorded of it at moments one return apart.
#pragma once
#include <vector>

namespace rosin::analysis::motion {

/// The smallest number of moments after which all columns [column][moment] are what they were to 1e-6 of their size,
/// over the second half of the record; 0: none up to `longest`.
int recurrence_of(const std::vector<std::vector<double>>& columns, int longest);

}  // namespace rosin::analysis::motion
