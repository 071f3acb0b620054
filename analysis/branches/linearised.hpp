/// Steady sliding of an oscillator and the motion of small disturbances about it.
#pragma once
#include <vector>

#include "analysis/branches/oscillator.hpp"
#include "core/eigenpairs.hpp"

namespace rosin::analysis::branches {

struct Linearised {
  std::vector<double> y;
  MovingPart part;
  Eigen::VectorXd scale;
};

/// \throws InputError where there is no steady sliding
Linearised linearise(Oscillator&);

}  // namespace rosin::analysis::branches
