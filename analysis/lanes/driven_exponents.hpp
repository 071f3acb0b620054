/// Largest Lyapunov exponents of forced blocks, in lanes.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "analysis/cycles/lyapunov.hpp"
#include "analysis/motion/structure_start.hpp"

namespace rosin::analysis::lanes {

struct DrivenExponent {
  double value, error;  ///< 1/s
  int returns;          ///< periods of the force after which the motion repeats; 0: it does not
};

/// Whether exponents of a model may be had in lanes: a forced block, for a given duration.
bool serves_exponents(const motion::StructureModel&, const cycles::LyapunovOptions&);

/// Of each model over the duration, rounded up to periods of the force; nothing for those that are not served. Where
/// the motion repeats, over the last of its periods, with the difference from that before as error; else the mean, with
/// its error by blocks (Flyvbjerg & Petersen 1989). \throws Stopped if the thread was asked to stop.
std::vector<std::optional<DrivenExponent>> driven_exponents(std::span<const motion::StructureModel>,
                                                            const cycles::LyapunovOptions&);

}  // namespace rosin::analysis::lanes
