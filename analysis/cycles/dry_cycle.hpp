/// The stick–slip cycle of friction that is linear in the slip rate, in closed form.
#pragma once
#include <optional>

#include "analysis/cycles/cycle.hpp"
#include "solvers/stick_slip/exact.hpp"

namespace rosin::analysis::cycles {

/// One slip, a free damped oscillation from the static limit until it comes to rest, and the stick that loads the
/// spring again. The multiplier is 0, because stick forgets the past. Errors are the differences to extended
/// arithmetic. Nothing if slip does not come to rest in its first oscillation, or double and extended arithmetic
/// disagree on it.
///
/// The sums avoid cancellation where friction is weak compared with the drive: a rest of 10⁻⁹ of the period depends on
/// 10⁻¹⁸ of the slip rate.
std::optional<Cycle> find_dry_cycle(const solvers::stick_slip::DryOscillator&, const CycleOptions&);

}  // namespace rosin::analysis::cycles
