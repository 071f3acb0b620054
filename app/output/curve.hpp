/// A steady friction curve to be written and drawn.
#pragma once
#include <vector>

#include "analysis/steady/curve.hpp"

namespace rosin::app::output {

/// A steady curve as sampled.
struct Curve {
  std::vector<double> slip_rate, friction_coefficient;
  std::vector<analysis::steady::Extremum> extrema;
};

}  // namespace rosin::app::output
