/// Noise of measurements: the size of it and what neighbours share, from what a fit leaves over.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace rosin::analysis::inference {

/// Noise ε of one series: standard deviation `size`, ε_k = correlation·ε_{k−1} + independent noise.
struct SeriesNoise {
  double size = 1;
  double correlation = 0;
};

/// Rows of values, a row a point: makes of each what its predecessor does not foretell, at the same size, so that rows
/// of correlated noise become independent.
/// \param apart true for each point that belongs to no series: it stays, and with the next one a series begins.
void whiten(std::span<double> values, std::size_t columns, double correlation, std::span<const char> apart = {});

/// How neighbouring residuals hang together.
struct Neighbours {
  double correlation = 0;    ///< of each with the next
  double durbin_watson = 2;  ///< mean square of differences over mean square: 2 without correlation
  double sigmas = 0;         ///< of the correlation, over 1/√n that chance gives it
};
Neighbours neighbours(std::span<const double> residuals);

/// Size of the noise of a smooth curve, from its second differences: the median, which few kinks do not move.
double roughness(std::span<const double> y);

/// One series of a fit: what is left over, and its slopes by the variables, a row of them for each point.
struct Leftover {
  std::vector<double> residual, slopes;
  SeriesNoise noise;
  bool unknown = false;          ///< `noise` is to be found, else it stands
  bool series = false;           ///< neighbours may be correlated
  std::vector<char> apart = {};  ///< points that tell nothing of the noise, as in `whiten`
};
/// Finds the noise that is unknown, as it maximises the restricted likelihood: that of what no change of the variables
/// could take up, so that their number makes noise seem neither smaller nor less correlated than it is (Patterson &
/// Thompson 1971).
void find_noise(std::vector<Leftover>&);

}  // namespace rosin::analysis::inference
