/// Damping against mass and stiffness.
#include "oscillators/time_scales.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rosin::oscillators {

double resistance(const Model& model) {
  const double N = model.drive.normal_load.level(), V = model.drive.speed.level();
  return model.slider.damping + N * std::max(model.law->steady_friction({V, N}).slope, 0.0);
}

bool overdamped(const Model& model) {
  return resistance(model) > 2 * std::sqrt(model.slider.mass * model.slider.stiffness);
}
double swing_time(const Model& model) {
  const auto& s = model.slider;
  return overdamped(model) ? resistance(model) / s.stiffness : 2 * std::numbers::pi * std::sqrt(s.mass / s.stiffness);
}

bool remembers(const Model& model) { return model.law->has_states() && model.lambda > 0; }

}  // namespace rosin::oscillators
