/// A Lyapunov exponent: the mean rate at which neighbouring motions diverge, or approach each other.
#pragma once
#include <cmath>

namespace rosin::analysis::cycles {

struct Exponent {
  double value, error;   ///< 1/s; −∞: of a direction that stick, or a dead impact, forgets
  bool trivial = false;  ///< along the flow of a motion that is not driven, 0 but for its error
  /// Five standard errors or less from 0.
  bool is_zero() const { return !(std::abs(value) > 5 * error); }
};

}  // namespace rosin::analysis::cycles
