/// The stick–slip cycle of friction that is linear in the slip rate, in closed form.
#pragma once
#include <optional>

#include "analysis/cycles/cycle.hpp"
#include "solvers/stick_slip/exact.hpp"

namespace rosin::analysis::cycles {

/// One slip, a free damped swing from the static limit until it comes to rest, and the stick that loads the spring
/// again. Multiplier 0: stick forgets the past. Errors are what extended arithmetic changes. Nothing if slip does not
/// come to rest in its first swing, or extended arithmetic has another opinion of that.
///
/// Written so that nothing cancels where friction is weak beside the drive: slip that comes to rest for 10⁻⁹ of its
/// period does so by 10⁻¹⁸ of its speed.
std::optional<Cycle> find_dry_cycle(const solvers::stick_slip::DryOscillator&, const CycleOptions&);

}  // namespace rosin::analysis::cycles
