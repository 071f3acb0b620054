/// Friction under a bow from the forces of the string on its ends.
#pragma once
#include "analysis/lab/experiment.hpp"

namespace rosin::analysis::lab {

/// Velocity of the string and friction at the bow from the forces at bridge and nut, recorded or of a simulated motion.
/// \throws InputError for a bow of several contacts, a bridge that moves, and records that are too short
Result inverse_of_string(const Task&);

}  // namespace rosin::analysis::lab
