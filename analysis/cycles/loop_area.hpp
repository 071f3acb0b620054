/// The steady friction that is subtracted in the area of the friction-velocity loop.
#pragma once
#include <cmath>

#include "oscillators/slider_system.hpp"

namespace rosin::analysis::cycles {

/// True where friction is a function of the slip rate, so that the loop has no area.
inline bool follows_steady_curve(const oscillators::SliderSystem& slider) {
  return slider.rigid() && (slider.model().lambda == 0 || !slider.model().law->has_states());
}

/// The slip rate of μ_ss in ∮ (μ − μ_ss) dv: v for fast slip, and near V/10 for slip much slower than the drive V > 0.
/// Any function of v may be subtracted, because its loop integral is zero; this one is smooth where slip reverses, so
/// that no step of a solver has to resolve the reversal of the steady curve.
inline double loop_slip_rate(double v, double V) { return std::sqrt(v * v + 0.01 * (V * V)); }

}  // namespace rosin::analysis::cycles
