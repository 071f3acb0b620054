/// When a recorded motion is at rest, though the sensor of its slip rate never reads exactly 0.
#pragma once
#include <span>
#include <vector>

namespace rosin::analysis::inference {

struct Rest {
  double noise = 0;              ///< m/s, standard deviation of the slip rate
  double below = 0;              ///< m/s, up to which a slip rate cannot be told from rest
  bool found = false;            ///< stretches at rest; else only reversals, of which the noise hides the moment
  bool given = false;            ///< by the user
  std::vector<char> state = {};  ///< of each sample
};

/// Between two changes of its sign a slip rate is one lobe. Where sliding reverses, friction does as well; a change of
/// sign that friction does not follow is noise about rest. The noise of the sensor is that of such lobes, or, where
/// there are fewer than `enough_lobes`, what the second differences of the slip rate tell of it. At rest is a sample
/// within four standard deviations of 0, and what the sensor cannot resolve in time beside it.
/// \param slip_rate,friction at the same times; friction over load, of a law that jumps where slip reverses.
Rest find_rest(std::span<const double> slip_rate, std::span<const double> friction);

/// The same with a slip rate given, up to which the record is at rest.
Rest rest_below(std::span<const double> slip_rate, double below);

}  // namespace rosin::analysis::inference
