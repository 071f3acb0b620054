/// The cycle under a set-valued law: periods of stick and slip, or slip that never sticks.
#pragma once
#include "analysis/cycles/cycle.hpp"

namespace rosin::analysis::cycles {

/// As find_cycle, of a model that it has checked, with a drive speed above 0.
Cycle find_stick_slip_cycle(const oscillators::Model&, const CycleOptions&);

}  // namespace rosin::analysis::cycles
