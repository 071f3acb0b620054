/// What is taken off friction where the area of the friction-velocity loop is summed.
#pragma once
#include <cmath>

#include "oscillators/slider_system.hpp"

namespace rosin::analysis::cycles {

/// True where friction is a function of the slip rate, so that the loop has no area.
inline bool follows_steady_curve(const oscillators::SliderSystem& slider) {
  return slider.rigid() && (slider.model().lambda == 0 || !slider.model().law->has_states());
}

/// The slip rate at which ∮ (μ − μ_ss) dv asks for μ_ss: v, but for slip much slower than the drive V > 0 near a tenth
/// of it. Any function of v may be taken off, as none has an area; this one is smooth where slip reverses, so that no
/// step of a solver has to see the steady curve turn over.
inline double loop_slip_rate(double v, double V) { return std::sqrt(v * v + 0.01 * (V * V)); }

}  // namespace rosin::analysis::cycles
