/// How much more than its estimate an error is stated with.
#pragma once
#include <algorithm>

namespace rosin::analysis::motion {

/// The estimate of an error falls short of the error now and then: up to three times as much is stated, where that
/// stays within the requested tolerance, `asked`, of the value's `size`.
inline double with_caution(double error, double size, double asked) {
  constexpr double times = 3;
  return std::max(error, std::min(times * error, asked * size));
}

}  // namespace rosin::analysis::motion
