/// Averaged cross-spectra of long records (Welch 1967), fed in blocks of any length: memory does not grow with the
/// record.
#pragma once
#include <complex>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/response/clipping.hpp"

namespace rosin::analysis::response {

struct WelchOptions {
  int segment = 1024;           ///< samples of one segment
  double overlap = 0.5;         ///< of neighbouring segments, 0 … 0.9
  std::string window = "hann";  ///< one of window_names() (core/fourier.hpp)
};

class CrossSpectra {
 public:
  /// \throws InputError for a segment below 16 samples, an overlap out of range, or an unknown window.
  CrossSpectra(int channels, const WelchOptions&);
  ~CrossSpectra();
  CrossSpectra(CrossSpectra&&) noexcept;

  /// One block of equally many samples of each channel. A segment's straight line is removed before its transform.
  void add(std::span<const std::span<const double>> block);
  /// The next block does not go on where the last one ended: no segment reaches across.
  void interrupt();

  int bins() const;
  long segments() const;
  long samples() const;
  /// Samples that stand in a segment.
  long used() const;
  /// Segments that overlap are not independent: the number of independent ones with the same variance (Welch 1967).
  double averages() const;
  /// Mean of conj(X_i) X_j over segments, scaled so that a white signal of variance σ² has σ² in every bin.
  std::complex<double> spectrum(int i, int j, int bin) const;
  /// Second moment of the window's spectrum in bins²: curvature of a response across a bin biases it by half of this.
  double window_moment() const;
  /// Power of the window at its ends, as a share of the mean: 1 of a rectangular one, 0 of one that begins and ends at
  /// 0.
  double window_ends() const;

  struct Level {
    double mean = 0, rms = 0, least = 0;  ///< rms about the segments' straight lines
    double drift = 0;                     ///< largest less smallest mean of a segment
  };
  Level level(int channel) const;
  /// What all samples of a channel show of a sensor's limits.
  const ClippingWatch& clipping(int channel) const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace rosin::analysis::response
