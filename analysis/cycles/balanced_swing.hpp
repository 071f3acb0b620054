/// Slip that never sticks, under a set-valued law without memory. Displacement and slip rate are the only unknowns, so
/// that its cycle follows from a search over one amplitude.
#pragma once
#include <optional>

#include "analysis/cycles/stick_slip_period.hpp"

namespace rosin::analysis::cycles {

/// One period of slip, which may reverse but does not stick for long, between crossings of v = V with v rising, from
/// `swing` (m) above the displacement of steady sliding. Metrics and orbit are recorded if `record`.
StickSlipPeriod slip_return(const Model&, double swing, double tolerance, double stick_threshold, bool record);

/// The amplitude `swing` (m) at which slip that never sticks repeats itself: its growth ln(A'/A) falls through zero.
struct BalancedSwing {
  std::optional<double> swing;
  Outcome outcome;
};
BalancedSwing balanced_swing(const Model&, double tolerance);

/// d growth / d ln swing, for the amplitude growth ln(A'/A) per period.
double slope_of_swing(const Model&, double swing, double stick_threshold, double relative_distance = 1e-4);

/// Static limit, over load, of a contact without memory.
double static_limit_of_curve(const Model&);

}  // namespace rosin::analysis::cycles
