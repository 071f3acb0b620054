/// Lines of a noise, summed by one transform for each derivative.
#include "core/noise.hpp"

#include <fftw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <mutex>
#include <numbers>

#include "core/error.hpp"
#include "core/fourier.hpp"
#include "core/random.hpp"

namespace rosin {

namespace {

constexpr int points = 1 << 20, points_per_period = 16;

double uniform(std::uint64_t& state) { return open_unit(splitmix(state += splitmix_step)); }

}  // namespace

BandNoise::BandNoise(const NoiseBand& band) : band_(band) {
  if (!(band.low >= 0) || !(band.low < band.high) || !std::isfinite(band.high) || !(band.rms >= 0) ||
      !std::isfinite(band.rms))
    throw InputError(fmt::format("noise: band [{}, {}] Hz and rms {} must be 0 <= low < high and rms >= 0", band.low,
                                 band.high, band.rms));
  step_ = 1 / (points_per_period * band.high);
  const double spacing = 1 / (points * step_);
  const int first = std::max(1, int(std::ceil(band.low / spacing))), last = points / points_per_period;
  if (last - first < 16)
    throw InputError(fmt::format("noise: the band [{}, {}] Hz is too narrow", band.low, band.high));
  std::uint64_t state = band.seed;
  std::vector<std::complex<double>> lines(points / 2 + 1);
  double power = 0;
  for (int k = first; k <= last; ++k) {
    const double radius = std::sqrt(-2 * std::log(uniform(state)));
    const double angle = 2 * std::numbers::pi * uniform(state);
    lines[std::size_t(k)] = std::polar(radius, angle);
    power += 2 * radius * radius;  // mean square of 2 Re(A e^{iωt})
  }
  const double scale = band.rms / std::sqrt(power);
  const auto transform = [&](int derivative) {
    std::vector<std::complex<double>> a(lines.size());
    for (int k = first; k <= last; ++k) {
      const std::complex<double> turn(0, 2 * std::numbers::pi * k / points);  // per step
      a[std::size_t(k)] = scale * lines[std::size_t(k)] *
                          (derivative == 0   ? 1.0
                           : derivative == 1 ? turn
                                             : turn * turn);
    }
    std::vector<double> result(points);
    const std::lock_guard lock(fourier_planner());
    const auto plan =
        fftw_plan_dft_c2r_1d(points, reinterpret_cast<fftw_complex*>(a.data()), result.data(), FFTW_ESTIMATE);
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    return result;
  };
  value_ = transform(0), slope_ = transform(1), curvature_ = transform(2);
  const auto [low, high] = std::ranges::minmax(value_);
  lowest_ = low, highest_ = high;
}

/// p = f + f' x + ½ f'' x² + c₃ x³ + c₄ x⁴ + c₅ x⁵ with value, slope and curvature of both ends.
BandNoise::Piece BandNoise::piece(double t) const {
  const double at = t / step_, whole = std::floor(at);
  const auto i = std::size_t(std::int64_t(whole) & (points - 1)), j = (i + 1) & (points - 1);
  const double d = value_[j] - value_[i];
  const double a = d - slope_[i] - 0.5 * curvature_[i], b = slope_[j] - slope_[i] - curvature_[i],
               c = curvature_[j] - curvature_[i];
  return {at - whole,
          value_[i],
          slope_[i],
          curvature_[i],
          10 * a - 4 * b + 0.5 * c,
          -15 * a + 7 * b - c,
          6 * a - 3 * b + 0.5 * c};
}

double BandNoise::value(double t) const {
  const auto [x, f, slope, curvature, c3, c4, c5] = piece(t);
  return f + x * (slope + x * (0.5 * curvature + x * (c3 + x * (c4 + x * c5))));
}

double BandNoise::rate(double t) const {
  const auto [x, f, slope, curvature, c3, c4, c5] = piece(t);
  return (slope + x * (curvature + x * (3 * c3 + x * (4 * c4 + x * 5 * c5)))) / step_;
}

}  // namespace rosin
