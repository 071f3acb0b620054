/// How long a plane takes on many processes.
#pragma once
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "analysis/planes/parts.hpp"

namespace rosin::analysis::planes {

struct Schedule {
  double seconds = 0;     ///< until the last process is done
  double efficiency = 1;  ///< what all parts take over what the processes could do in that time
};

/// Groups of parts, in the order in which they are handed out, each to the process that is free first; `answer` (s)
/// passes between two groups that are handed out, and `wait` (s) before each, at the process that asked.
Schedule schedule(std::span<const double> groups, std::size_t processes, double answer, double wait);

/// The same of a partition whose parts take so long (s), in groups as they are formed for so many processes of one
/// thread.
Schedule schedule(const Partition&, std::span<const double> seconds, std::size_t processes);

/// The time of every part from those that are known, which stand for the others in turn; the known lie scattered over
/// the plane where they are of shares. `known` is not empty.
std::vector<double> filled_up(const std::map<std::size_t, double>& known, std::size_t parts);

}  // namespace rosin::analysis::planes
