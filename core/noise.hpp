/// Band-limited Gaussian noise as a smooth function of time: the same seed gives the same noise on every machine.
#pragma once
#include <cstdint>
#include <vector>

namespace rosin {

struct NoiseBand {
  double rms;        ///< in the unit of the signal
  double low, high;  ///< Hz
  std::uint64_t seed = 1;
};

/// A sum of lines with Gaussian amplitudes, evenly spaced within the band, tabulated at 16 points of the shortest
/// period with two derivatives and read by quintic Hermite interpolation (error 1e-7 of the rms). It repeats after
/// 65536 shortest periods.
class BandNoise {
 public:
  /// \throws InputError unless 0 <= low < high and the band holds a line.
  explicit BandNoise(const NoiseBand&);
  double value(double t) const;
  double rate(double t) const;
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  const NoiseBand& band() const { return band_; }

 private:
  /// The polynomial around a time: x in steps past the last point, then its coefficients; value, slope and curvature
  /// (twice the second coefficient) as tabulated.
  struct Piece {
    double x, value, slope, curvature, third, fourth, fifth;
  };
  Piece piece(double t) const;

  NoiseBand band_;
  double step_, lowest_, highest_;
  std::vector<double> value_, slope_, curvature_;  ///< the last two times step and step²
};

}  // namespace rosin
