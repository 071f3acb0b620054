/// Slip rate out of a recorded displacement, for responses: means over the interval between two samples.
///
/// The mean slip rate of an interval is (x_{k+1} − x_k) f_s, whatever happens between; that of any other channel is
/// taken as (F_k + F_{k+1})/2. Where slip rate and force run straight between samples this loses nothing. Where they
/// hold no frequency above half the sample rate, it makes of Z the (θ/2) cot(θ/2) ≈ 1 − θ²/12 of it, θ = 2π f/f_s: 0.8
/// % less at a twentieth of the sample rate, which is stated as a part of the bias.
#pragma once
#include <span>
#include <vector>

#include "analysis/response/extraction.hpp"

namespace rosin::analysis::response {

class IntervalMeans {
 public:
  /// The first of the channels is a displacement.
  IntervalMeans(int channels, double sample_rate);
  /// Means of the intervals that this block ends, valid until the next call.
  std::span<const std::span<const double>> add(std::span<const std::span<const double>> block);
  /// The next block does not go on where the last one ended.
  void interrupt();
  double sample_rate() const { return rate_; }

 private:
  double rate_;
  std::vector<double> last_;  ///< sample of each channel; empty at the beginning
  std::vector<std::vector<double>> means_;
  std::vector<std::span<const double>> out_;
};

/// Highest frequency of a response out of a displacement, of the sample rate: its bias is a fifth there.
inline constexpr double highest_part = 0.25;

/// Adds the bias to a response from means of intervals, and corrects the sample rate that they were made with to that
/// of the whole record.
void state_interval_bias(MeasuredFrf&, double assumed_rate, double sample_rate);

}  // namespace rosin::analysis::response
