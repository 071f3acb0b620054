/// Models whose motion ends in finite time, though every number in them is in range.
#pragma once
#include <optional>
#include <string>

#include "oscillators/slider_system.hpp"

namespace rosin::analysis::motion {

/// True where μ_ss(v) does not fall to 0 with v → 0 although the law is not set-valued: a power of v, b >= a, that
/// weakens down to rest. Without its state such a law has no friction at rest, only a jump from −∞ to +∞.
bool unbounded_at_rest(const FrictionLaw&, double normal_load);

/// True where friction at rest jumps between two values although the law is not set-valued: a deflection that holds at
/// rest, without which nothing does.
bool jumps_at_rest(const FrictionLaw&, double normal_load);

/// Why the unknowns y at time t, if they are at rest under λ = 0 and a curve that rises without bound toward rest,
/// never slip again.
std::optional<std::string> why_nothing_slips_again(const oscillators::SliderSystem&, double t, const double* y);

/// That, or why they do not get away from rest under λ = 0 and a curve that jumps there.
std::optional<std::string> why_rest_lasts(const oscillators::SliderSystem&, double t, const double* y);

/// Why slip in the unknowns y at time t has run away, if it has under a constant drive: neither mass nor damping
/// between friction and a spring, and slip against the drive, 10⁸ times as fast. A step may pass over the moment at
/// which slip is infinite, to slip of any speed and direction.
std::optional<std::string> why_slip_runs_away(const oscillators::SliderSystem&, double t, const double* y);

/// Why no integration gets beyond the unknowns y at time t, or nothing where the equations give no reason:
/// - λ = 0 under a curve that rises without bound toward rest: once at rest, nothing slips again;
/// - λ = 0 under a curve that jumps at rest: what holds there is the deflection alone;
/// - λ = 0 under a weakening curve with no mass between it and a spring: where the curve turns back, slip would jump;
/// - friction of a law that answers to the slip rate at once (a bristle with damping) falls with the slip rate of a
///   contact behind a spring faster than damping resists: that rate would have to jump;
/// - neither mass nor damping between friction and a spring: slip that weakens faster than the spring unloads reaches
///   infinite speed in finite time (Rice & Gu, Pure Appl. Geophys. 121, 187-219, 1983).
std::optional<std::string> why_motion_ends(const oscillators::SliderSystem&, double t, const double* y);

}  // namespace rosin::analysis::motion
