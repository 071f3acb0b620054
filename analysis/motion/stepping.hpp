/// How a motion is followed by steps of a given length.
#pragma once
#include <string>
#include <vector>

namespace rosin::analysis::motion {

enum class Scheme {
  average_acceleration,  ///< Newmark (1959) with β = 1/4, γ = 1/2: order 2, no damping of its own
  generalised_alpha,     ///< Chung & Hulbert 1993, J. Appl. Mech. 60, 371: order 2, damps the fastest
  explicit_steps,        ///< velocities halfway between displacements, with a diagonal mass
};

/// As scenes name the schemes, in their order.
const std::vector<std::string>& scheme_names();

struct Stepping {
  Scheme scheme = Scheme::average_acceleration;
  double step = 0;               ///< s
  double spectral_radius = 0.8;  ///< of generalised_alpha: what it leaves of the fastest motion in a step, 0 … 1
  double stick_width = 0;        ///< m/s, slip rate below which a station counts as sticking
};

}  // namespace rosin::analysis::motion
