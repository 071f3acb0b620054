/// Reasons why a motion ends in finite time although every parameter is in range.
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

/// The reason why slip never starts again from y at time t, under λ = 0 and a curve that rises without bound toward
/// rest; nothing where it may.
std::optional<std::string> why_nothing_slips_again(const oscillators::SliderSystem&, double t, const double* y);

/// The same, or the reason why rest lasts under λ = 0 and a curve that jumps at rest.
std::optional<std::string> why_rest_lasts(const oscillators::SliderSystem&, double t, const double* y);

/// The reason why slip in y at time t has run away under a constant drive: neither mass nor damping lies between
/// friction and a spring, and slip goes against the drive at over 10⁸ times its speed. A step may pass over the time at
/// which slip is infinite, to slip of any speed and direction.
std::optional<std::string> why_slip_runs_away(const oscillators::SliderSystem&, double t, const double* y);

/// The reason why the motion ends at y at time t, or nothing where the equations give none:
/// - λ = 0 under a curve that rises without bound toward rest: once at rest, nothing slips again;
/// - λ = 0 under a curve that jumps at rest: only the deflection holds there;
/// - λ = 0 under a weakening curve with no mass between it and a spring: at the extremum of the curve slip would jump;
/// - friction of a law that answers to the slip rate at once (a bristle with damping) falls with the slip rate of a
///   contact behind a spring faster than damping resists: that rate would have to jump;
/// - neither mass nor damping between friction and a spring: slip that weakens faster than the spring unloads reaches
///   infinite speed in finite time (Rice & Gu, Pure Appl. Geophys. 121, 187-219, 1983).
std::optional<std::string> why_motion_ends(const oscillators::SliderSystem&, double t, const double* y);

}  // namespace rosin::analysis::motion
