/// The cycle under a law that is smooth at rest: a fixed point of the return map.
#pragma once
#include "analysis/cycles/cycle.hpp"

namespace rosin::analysis::cycles {

/// As find_cycle, of a model that it has checked, with a drive speed above 0.
Cycle find_smooth_cycle(const oscillators::Model&, const CycleOptions&);

}  // namespace rosin::analysis::cycles
