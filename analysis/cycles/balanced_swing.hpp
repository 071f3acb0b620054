/// Slip that never sticks, under a set-valued law without memory: two mechanical unknowns, so that its cycle is found
/// along a line.
#pragma once
#include <optional>

#include "analysis/cycles/stick_slip_period.hpp"

namespace rosin::analysis::cycles {

/// A passage of slip, which may reverse but does not stick for long, from v = V rising at a displacement `swing` (m)
/// above that of steady sliding to the next such passage. Metrics and orbit are kept if it is to `record` them.
StickSlipPeriod slip_passage(const Model&, double swing, double tolerance, double stick_threshold, bool record);

/// The swing (m) at which slip that never sticks repeats itself: where the drift ln(A'/A) falls through zero.
struct BalancedSwing {
  std::optional<double> swing;
  Outcome outcome;
};
BalancedSwing balanced_swing(const Model&, double tolerance);

/// How the growth of a swing in a passage changes with the swing, d growth / d ln swing.
double slope_of_swing(const Model&, double swing, double stick_threshold, double beside = 1e-4);

/// Static limit, over load, of a contact without memory.
double static_limit_of_curve(const Model&);

}  // namespace rosin::analysis::cycles
