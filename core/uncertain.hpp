/// Inputs that are known within a relative standard deviation, and draws of them.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>

namespace rosin {

/// An uncertain parameter: its path and relative standard deviation (log-normal about its value).
struct Uncertain {
  std::string parameter;
  double relative;
  /// \param normal of the standard normal distribution
  double drawn(double value, double normal) const { return value * std::exp(std::log1p(relative) * normal); }
};

/// Standard error of a share of so many draws; never below that of a quarter of one draw.
inline double error_of_share(double share, int samples) {
  return std::sqrt(std::max(share * (1 - share), 0.25 / samples) / samples);
}

}  // namespace rosin
