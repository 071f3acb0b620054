/// Welch's method on FFTW, segment by segment.
#include "analysis/response/spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/fourier.hpp"
#include "core/parameters.hpp"

namespace rosin::analysis::response {

struct CrossSpectra::Work {
  int channels, segment, hop;
  std::vector<double> window;
  double power = 0;                          ///< Σ w²
  std::vector<std::vector<double>> pending;  ///< samples not yet passed by all segments
  std::vector<std::complex<double>> sums;    ///< [(i·channels + j)·bins + bin], j ≥ i
  std::vector<Level> levels;
  std::vector<ClippingWatch> clipping;
  std::vector<double> lowest_mean, highest_mean, mean_sum, square_sum;
  long segments = 0, samples = 0, used = 0;
  bool overlaps = false;  ///< the next segment, with the one before it
  RealTransform transform;
  std::vector<std::vector<std::complex<double>>> transformed;  ///< [channel][bin]

  explicit Work(int length) : segment(length), transform(length) {}

  int bins() const { return segment / 2 + 1; }

  void take_segment(std::size_t first) {
    const auto count = std::size_t(segment);
    for (int c = 0; c < channels; ++c) {
      const auto k = std::size_t(c);
      const double* x = pending[k].data() + first;
      // Straight line by least squares, about the middle.
      double mean = 0, moment = 0, spread = 0;
      for (std::size_t i = 0; i < count; ++i) mean += x[i];
      mean /= double(count);
      const double middle = (double(count) - 1) / 2;
      for (std::size_t i = 0; i < count; ++i) moment += (double(i) - middle) * (x[i] - mean);
      spread = double(count) * (double(count) * double(count) - 1) / 12;
      const double slope = moment / spread;
      double squares = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const double left = x[i] - mean - slope * (double(i) - middle);
        squares += left * left;
        transform.record()[i] = left * window[i];
      }
      const auto bins = transform();
      transformed[k].assign(bins.begin(), bins.end());
      square_sum[k] += squares / double(count);
      mean_sum[k] += mean;
      lowest_mean[k] = std::min(lowest_mean[k], mean);
      highest_mean[k] = std::max(highest_mean[k], mean);
    }
    const auto n = std::size_t(bins());
    for (int i = 0; i < channels; ++i)
      for (int j = i; j < channels; ++j) {
        auto* sum = sums.data() + std::size_t(i * channels + j) * n;
        const auto &a = transformed[std::size_t(i)], &b = transformed[std::size_t(j)];
        for (std::size_t k = 0; k < n; ++k) sum[k] += std::conj(a[k]) * b[k];
      }
    ++segments;
    used += overlaps ? hop : segment;
    overlaps = true;
  }
};

CrossSpectra::CrossSpectra(int channels, const WelchOptions& options) {
  if (options.segment < 16)
    throw InputError(
        fmt::format("a segment of {} samples is too short: at least 16 are needed; ask for a finer "
                    "resolution",
                    options.segment));
  require(options.overlap, {0, 0.9}, "overlap", "of neighbouring segments", "1");
  const auto window = window_values(options.window, options.segment);
  work_ = std::make_unique<Work>(options.segment);
  auto& w = *work_;
  w.channels = channels;
  w.hop = std::max(1, int(std::lround(options.segment * (1 - options.overlap))));
  w.window = window;
  for (const double x : w.window) w.power += x * x;
  const auto count = std::size_t(channels), n = std::size_t(w.bins());
  w.pending.resize(count);
  w.sums.resize(count * count * n);
  w.levels.resize(count);
  w.clipping.resize(count);
  for (auto& level : w.levels) level.least = infinity;
  w.lowest_mean.assign(count, infinity);
  w.highest_mean.assign(count, -infinity);
  w.mean_sum.assign(count, 0);
  w.square_sum.assign(count, 0);
  w.transformed.resize(count);
}

CrossSpectra::~CrossSpectra() = default;

CrossSpectra::CrossSpectra(CrossSpectra&&) noexcept = default;

void CrossSpectra::add(std::span<const std::span<const double>> block) {
  auto& w = *work_;
  const auto length = block.front().size();
  for (std::size_t c = 0; c < block.size(); ++c) {
    w.pending[c].insert(w.pending[c].end(), block[c].begin(), block[c].end());
    for (const double x : block[c]) {
      w.levels[c].least = std::min(w.levels[c].least, x);
      w.clipping[c].add(x);
    }
  }
  w.samples += long(length);
  const auto segment = std::size_t(w.segment), hop = std::size_t(w.hop), held = w.pending.front().size();
  std::size_t first = 0;
  for (; first + segment <= held; first += hop) w.take_segment(first);
  if (first > 0)
    for (auto& list : w.pending) list.erase(list.begin(), list.begin() + std::ptrdiff_t(std::min(first, held)));
}

void CrossSpectra::interrupt() {
  for (auto& list : work_->pending) list.clear();
  work_->overlaps = false;
}

int CrossSpectra::bins() const { return work_->bins(); }
long CrossSpectra::segments() const { return work_->segments; }
long CrossSpectra::samples() const { return work_->samples; }
long CrossSpectra::used() const { return work_->used; }

double CrossSpectra::averages() const {
  const auto& w = *work_;
  double sum = 1;
  for (long k = 1; k * w.hop < w.segment && k < w.segments; ++k) {
    double overlap = 0;
    for (std::size_t i = std::size_t(k * w.hop); i < w.window.size(); ++i)
      overlap += w.window[i] * w.window[i - std::size_t(k * w.hop)];
    const double correlation = overlap / w.power;
    sum += 2 * (1 - double(k) / double(w.segments)) * correlation * correlation;
  }
  return double(w.segments) / sum;
}

std::complex<double> CrossSpectra::spectrum(int i, int j, int bin) const {
  if (i > j) return std::conj(spectrum(j, i, bin));
  const auto& w = *work_;
  return w.sums[std::size_t(i * w.channels + j) * std::size_t(w.bins()) + std::size_t(bin)] /
         (w.power * double(std::max(1L, w.segments)));
}

double CrossSpectra::window_moment() const {
  const auto& w = work_->window;
  double change = 0;
  for (std::size_t i = 1; i < w.size(); ++i) {  // jumps at the ends are window_ends()
    const double step = w[i] - w[i - 1];
    change += step * step;
  }
  const double turns = double(w.size()) / (2 * std::numbers::pi);
  return change / work_->power * turns * turns;
}

double CrossSpectra::window_ends() const {
  const auto& w = work_->window;
  return 0.5 * (w.front() * w.front() + w.back() * w.back()) * double(w.size()) / work_->power;
}

const ClippingWatch& CrossSpectra::clipping(int channel) const { return work_->clipping[std::size_t(channel)]; }

CrossSpectra::Level CrossSpectra::level(int channel) const {
  const auto& w = *work_;
  const auto k = std::size_t(channel);
  auto level = w.levels[k];
  const double count = double(std::max(1L, w.segments));
  level.mean = w.mean_sum[k] / count;
  level.rms = std::sqrt(w.square_sum[k] / count);
  level.drift = w.segments > 0 ? w.highest_mean[k] - w.lowest_mean[k] : 0;
  return level;
}

}  // namespace rosin::analysis::response
