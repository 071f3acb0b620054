/// The motion behind recorded displacements: smooth but for corners, found with the noise and the resolution of the
/// record.
#pragma once
#include <cstdint>
#include <vector>

namespace rosin::analysis::inference {

struct RecordedMotion {
  std::vector<double> displacement;    ///< m, at each time
  std::vector<double> before, after;   ///< m/s, slip rate just before and after each time, which differ at corners
  std::vector<double> standard_error;  ///< m/s, of the slip rate
  std::vector<char> corner;            ///< true where the slip rate jumps
  double noise = 0;                    ///< m, standard deviation of the recorded displacements
  double resolution = 0;               ///< m, steps in which they were recorded, where noise is that of steps; else 0
  double roughness = 0;                ///< spectral density of the jerk, where noise and median spacing are 1
};

/// Displacement whose jerk is white noise, recorded with white noise: both sizes maximise the likelihood, and the
/// motion is the mean that they leave (Kalman filter and smoother; Durbin & Koopman, Time Series Analysis by State
/// Space Methods, 2012). Noise that is small beside what happens between samples leaves the displacements as they are.
/// Where the slip rate would have to jump by more than 5 standard errors it does: a corner. Where neighbouring
/// displacements are equal and the slip rate is 0 within 3 standard errors, the motion rests.
/// \param time in s, ascending, 4 or more
RecordedMotion recorded_motion(const std::vector<double>& time, const std::vector<double>& displacement);

/// Another motion that the record allows as well: with a draw of the error of the one found.
RecordedMotion recorded_again(const std::vector<double>& time, const RecordedMotion&, std::uint64_t seed);

}  // namespace rosin::analysis::inference
