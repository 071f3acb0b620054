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

namespace rosin {

namespace {

constexpr int points = 1 << 20, points_per_period = 16;

/// Uniform on (0, 1) from a counter (splitmix64; Steele, Lea & Flood 2014).
double uniform(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  z ^= z >> 31;
  return (double(z >> 11) + 0.5) * 0x1p-53;
}

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
    static std::mutex planner;
    const std::lock_guard lock(planner);
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

double BandNoise::value(double t) const {
  const double at = t / step_, whole = std::floor(at), x = at - whole;
  const auto i = std::size_t(std::int64_t(whole) & (points - 1)), j = (i + 1) & (points - 1);
  const double d = value_[j] - value_[i];
  // p = f + f' x + ½ f'' x² + c₃ x³ + c₄ x⁴ + c₅ x⁵ with value, slope and curvature of both ends
  const double a = d - slope_[i] - 0.5 * curvature_[i], b = slope_[j] - slope_[i] - curvature_[i],
               c = curvature_[j] - curvature_[i];
  const double c3 = 10 * a - 4 * b + 0.5 * c, c4 = -15 * a + 7 * b - c, c5 = 6 * a - 3 * b + 0.5 * c;
  return value_[i] + x * (slope_[i] + x * (0.5 * curvature_[i] + x * (c3 + x * (c4 + x * c5))));
}

double BandNoise::rate(double t) const {
  const double at = t / step_, whole = std::floor(at), x = at - whole;
  const auto i = std::size_t(std::int64_t(whole) & (points - 1)), j = (i + 1) & (points - 1);
  const double d = value_[j] - value_[i];
  const double a = d - slope_[i] - 0.5 * curvature_[i], b = slope_[j] - slope_[i] - curvature_[i],
               c = curvature_[j] - curvature_[i];
  const double c3 = 10 * a - 4 * b + 0.5 * c, c4 = -15 * a + 7 * b - c, c5 = 6 * a - 3 * b + 0.5 * c;
  return (slope_[i] + x * (curvature_[i] + x * (3 * c3 + x * (4 * c4 + x * 5 * c5)))) / step_;
}

}  // namespace rosin
