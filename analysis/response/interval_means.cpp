/// Means of intervals, block by block.
#include "analysis/response/interval_means.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace rosin::analysis::response {

IntervalMeans::IntervalMeans(int channels, double sample_rate) : rate_(sample_rate), means_(std::size_t(channels)) {}

std::span<const std::span<const double>> IntervalMeans::add(std::span<const std::span<const double>> block) {
  out_.clear();
  const bool begins = last_.empty();
  if (begins) last_.resize(means_.size());
  for (std::size_t c = 0; c < means_.size(); ++c) {
    auto& means = means_[c];
    means.clear();
    for (std::size_t k = 0; k < block[c].size(); ++k) {
      const double before = std::exchange(last_[c], block[c][k]), now = last_[c];
      if (k > 0 || !begins) means.push_back(c == 0 ? (now - before) * rate_ : 0.5 * (before + now));
    }
    out_.emplace_back(means);
  }
  return out_;
}

void IntervalMeans::interrupt() { last_.clear(); }

void state_interval_bias(MeasuredFrf& measured, double assumed_rate, double sample_rate) {
  const double unit = assumed_rate / sample_rate;  // in which slip rates were made
  for (auto* list : {&measured.tangential, &measured.h1, &measured.h2, &measured.hv})
    for (auto& value : *list) value *= unit;
  for (auto* list : {&measured.standard_error, &measured.bias_error})
    for (auto& value : *list) value *= unit;
  for (auto* list : {&measured.matrix, &measured.matrix_error})
    for (auto& value : *list) value.tt *= unit, value.nt *= unit;
  for (auto* rate : {&measured.slip_rate, &measured.slip_rate_rms}) *rate /= unit;
  for (std::size_t k = 0; k < measured.bias_error.size(); ++k) {
    const double half = std::numbers::pi * measured.frequency[k] / sample_rate;
    if (half > 0) measured.bias_error[k] += std::abs(measured.tangential[k]) * (1 - half / std::tan(half));
  }
}

}  // namespace rosin::analysis::response
