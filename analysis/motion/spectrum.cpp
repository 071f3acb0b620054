/// Windowed Fourier transforms of the columns of a run, and sinusoids between their frequencies.
#include "analysis/motion/spectrum.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.hpp"
#include "core/fourier.hpp"

namespace rosin::analysis::motion {

namespace {

constexpr int least_samples = 16;

class WindowedTransform {
 public:
  WindowedTransform(const std::string& window, int n) : window_(window_values(window, n)), transform_(n) {
    sum_ = std::accumulate(window_.begin(), window_.end(), 0.0);
  }

  /// Of every stride-th of the values.
  std::vector<double> amplitudes(std::span<const double> x, int stride = 1) {
    const auto record = transform_.record();
    // The mean would leak into the lowest frequencies.
    double mean = 0;
    for (std::size_t i = 0; i < record.size(); ++i) mean += x[i * std::size_t(stride)] * window_[i];
    mean /= sum_;
    for (std::size_t i = 0; i < record.size(); ++i) record[i] = (x[i * std::size_t(stride)] - mean) * window_[i];
    const auto bins = transform_();
    std::vector<double> list(bins.size());
    for (std::size_t k = 0; k < bins.size(); ++k) list[k] = 2 * std::abs(bins[k]) / sum_;
    list.front() = mean;
    return list;
  }

 private:
  std::vector<double> window_;
  RealTransform transform_;
  double sum_;
};

/// A sinusoid between two frequencies of the transform, told by the ratio of its maximum and a neighbour.
class Interpolation {
 public:
  Interpolation(const std::string& window, int n) : cosines_(window_cosines(window)), n_(n) {}

  struct Sinusoid {
    double frequency, amplitude;  ///< in frequencies of the transform
  };
  /// \param larger  by the larger of the neighbours, or by the other
  Sinusoid at(std::span<const double> a, std::size_t k, bool larger) const {
    // The smaller neighbour of a rectangular window lies in a side lobe, which tells nothing.
    if (!larger && cosines_.size() == 1) return {double(k), a[k]};
    const bool up = (a[k + 1] >= a[k - 1]) == larger;
    const double ratio = (up ? a[k + 1] : a[k - 1]) / a[k];
    // W(1 − d)/W(d) rises with d, the distance of the sinusoid from the maximum.
    double low = larger ? 0 : -0.5, high = 0.5;
    for (int i = 0; i < 50; ++i) {
      const double d = 0.5 * (low + high);
      (response(1 - d) < ratio * response(d) ? low : high) = d;
    }
    return {double(k) + (up ? low : -low), a[k] / response(low)};
  }

 private:
  /// W, what the window leaves of a sinusoid of amplitude 1 that lies `aside` by so many frequencies.
  double response(double aside) const {
    const auto plain = [&](double x) -> std::complex<double> {  // Σ e^(2πi x m/n)/n
      const double turn = std::numbers::pi * x;
      const double size = x == 0 ? 1 : std::sin(turn) / (n_ * std::sin(turn / n_));
      return std::polar(1.0, turn * (n_ - 1) / n_) * size;
    };
    auto sum = cosines_[0] * plain(aside);
    for (std::size_t k = 1; k < cosines_.size(); ++k)
      sum += (k % 2 ? -0.5 : 0.5) * cosines_[k] * (plain(aside - double(k)) + plain(aside + double(k)));
    return std::abs(sum) / cosines_[0];
  }

  std::span<const double> cosines_;
  double n_;
};

std::vector<SpectralLine> lines_of(const Interpolation& interpolation, std::span<const double> a,
                                   std::span<const double> of_every_second, double spacing, int most) {
  std::vector<std::size_t> peaks;
  for (std::size_t k = 2; k + 1 < a.size(); ++k)
    if (a[k] > a[k - 1] && a[k] >= a[k + 1] && a[k] > 0) peaks.push_back(k);
  const auto kept = std::min(peaks.size(), std::size_t(most));
  std::ranges::partial_sort(peaks, peaks.begin() + std::ptrdiff_t(kept), std::greater(), [&](auto k) { return a[k]; });
  peaks.resize(kept);
  std::vector<SpectralLine> lines;
  for (const std::size_t k : peaks) {
    const auto best = interpolation.at(a, k, true), other = interpolation.at(a, k, false);
    double frequency_error = std::abs(best.frequency - other.frequency),
           amplitude_error = std::abs(best.amplitude - other.amplitude);
    if (k + 1 < of_every_second.size()) {
      const auto coarse = interpolation.at(of_every_second, k, true);
      frequency_error += std::abs(coarse.frequency - best.frequency);
      amplitude_error += std::abs(coarse.amplitude - best.amplitude);
    } else {
      frequency_error += 0.5, amplitude_error += best.amplitude;
    }
    lines.push_back({best.frequency * spacing, best.amplitude, frequency_error * spacing, amplitude_error});
  }
  return lines;
}

}  // namespace

MotionSpectrum spectrum(const Run& run, const SpectrumOptions& options) {
  const auto first = std::size_t(std::ranges::lower_bound(run.time, options.from) - run.time.begin());
  // A period is as many intervals as samples: the last sample would be the first again.
  std::size_t count = run.time.size() > first + 1 ? run.time.size() - first - 1 : 0;
  count -= count % 2;
  if (count < least_samples)
    throw InputError(
        fmt::format("run.spectrum.from = {:g} leaves {} samples, fewer than {}", options.from, count, least_samples));
  const double step = (run.time[first + count] - run.time[first]) / double(count);
  for (std::size_t i = 0; i < count; ++i)
    if (std::abs(run.time[first + i] - run.time[first] - double(i) * step) > 1e-6 * step)
      throw InputError("run.spectrum needs samples at equal intervals: give run.samples instead of run.times");
  std::vector<std::size_t> chosen;
  for (const auto& name : options.columns) {
    const auto found = std::ranges::find(run.column_names, name);
    if (found == run.column_names.end()) {
      const auto near = nearest_name(name, run.column_names);
      throw InputError(fmt::format("run.spectrum.columns: '{}' is no column of this run; {}", name,
                                   near.empty() ? fmt::format("it has {}", fmt::join(run.column_names, ", "))
                                                : fmt::format("did you mean '{}'?", near)));
    }
    chosen.push_back(std::size_t(found - run.column_names.begin()));
  }
  if (chosen.empty()) chosen.resize(run.columns.size()), std::iota(chosen.begin(), chosen.end(), std::size_t(0));

  MotionSpectrum result;
  const double spacing = 1 / (step * double(count));
  constexpr int lobe[] = {2, 4, 1};  // half the main lobe in frequencies, in the order of window_names()
  result.resolution = spacing * lobe[std::ranges::find(window_names(), options.window) - window_names().begin()];
  for (std::size_t k = 0; k <= count / 2; ++k) result.frequency.push_back(spacing * double(k));
  WindowedTransform whole(options.window, int(count)), half(options.window, int(count / 2));
  const Interpolation interpolation(options.window, int(count));
  const auto part = std::size_t(std::lround(options.segment / step)) / 2 * 2;
  const bool parted = options.segment > 0;
  if (parted && (part < least_samples || part > count))
    throw InputError(fmt::format("run.spectrum.segment = {:g} s is outside {:g} … {:g} s, {} samples to all of them",
                                 options.segment, least_samples * step, double(count) * step, least_samples));
  std::optional<WindowedTransform> short_term;
  if (parted) {
    short_term.emplace(options.window, int(part));
    for (std::size_t k = 0; k <= part / 2; ++k) result.part_frequency.push_back(double(k) / (step * double(part)));
    for (std::size_t at = 0; at + part <= count; at += part / 2)
      result.part_time.push_back(run.time[first + at] + 0.5 * step * double(part));
  }
  for (const std::size_t c : chosen) {
    const auto x = std::span(run.columns[c]).subspan(first, count);
    if (!std::ranges::all_of(x, [](double value) { return std::isfinite(value); }))
      throw InputError(fmt::format("run.spectrum: the column {} is not defined at every sample", run.column_names[c]));
    result.names.push_back(run.column_names[c]), result.units.push_back(run.column_units[c]);
    result.amplitude.push_back(whole.amplitudes(x));
    result.lines.push_back(
        lines_of(interpolation, result.amplitude.back(), half.amplitudes(x, 2), spacing, options.lines));
    if (!parted) continue;
    auto& parts = result.part_amplitude.emplace_back();
    for (std::size_t at = 0; at + part <= count; at += part / 2) {
      const auto of_part = short_term->amplitudes(x.subspan(at, part));
      parts.insert(parts.end(), of_part.begin(), of_part.end());
    }
  }
  return result;
}

}  // namespace rosin::analysis::motion
