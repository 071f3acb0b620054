/// A response given at times of a table, as weights of a wave's samples.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "core/signal.hpp"

namespace rosin {

/// y(n) = Σ wᵢ x(n − first − i): the wave ∫ h(t) x(n Δ − t) dt of a response h, linear between the rows of its table
/// and 0 outside, to a wave x, linear between its samples Δ apart. The integral is exact. The spectrum of the weights
/// is a mean of that of h, by positive parts with sum 1 at frequencies 1/Δ apart, so that a response whose gain is
/// nowhere above 1 has no larger one at any Δ.
struct SampledResponse {
  int first = 0;
  std::vector<double> weights;
  double sum() const;
  double delay() const;  ///< of slow waves, samples; NaN where the sum is 0
};
/// \param response  times in s, ascending; values per second
/// \param shift     s, added to all times
/// \param step      Δ, s
SampledResponse sampled(const Signal::Table& response, double shift, double step);

struct LargestGain {
  double gain, frequency;  ///< frequency: cycles per sample, up to 1/2
};
/// Of the weights' spectrum, at eight or more frequencies for each weight.
LargestGain largest_gain(const SampledResponse&);

/// The response to samples that begin with the first and have been constant before, as if for ever.
std::vector<double> convolved(std::span<const double> samples, const SampledResponse&);

}  // namespace rosin
