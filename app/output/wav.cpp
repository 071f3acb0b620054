/// Resampling by a windowed sinc, and the RIFF header.
#include "app/output/wav.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "app/output/files.hpp"

namespace rosin::app::output {

namespace {

constexpr double usual_rate = 48'000;

/// A low pass below 0.9 of half of the new rate, taken at the new samples: a sinc under Hann's window, 32 new samples
/// long.
std::vector<double> resampled(std::span<const double> signal, double from, double to) {
  const double ratio = from / to, cut = 0.9 / ratio, reach = 16 * ratio;
  std::vector<double> out;
  for (double at = 0; at <= double(signal.size()) - 1; at = double(out.size()) * ratio) {
    const long first = std::max(0L, long(std::ceil(at - reach))),
               last = std::min(long(signal.size()) - 1, long(std::floor(at + reach)));
    double sum = 0, weights = 0;
    for (long i = first; i <= last; ++i) {
      const double x = double(i) - at, angle = std::numbers::pi * cut * x;
      const double weight =
          (x == 0 ? 1 : std::sin(angle) / angle) * (0.5 + 0.5 * std::cos(std::numbers::pi * x / reach));
      sum += weight * signal[std::size_t(i)];
      weights += weight;
    }
    out.push_back(sum / weights);
  }
  return out;
}

/// Without what no ear hears, the constant part of a force foremost: a high pass of the first order.
std::vector<double> heard(std::vector<double> sound, double rate) {
  const double keep = std::exp(-2 * std::numbers::pi * lowest_heard / rate);
  double before = sound.empty() ? 0 : sound.front(), level = 0;
  for (double& x : sound) {
    level = keep * level + (x - before);
    before = x;
    x = level;
  }
  return sound;
}

void put(std::string& bytes, std::uint32_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += char((value >> (8 * i)) & 0xff);
}

}  // namespace

double write_wav(const std::filesystem::path& path, std::span<const double> signal, double sample_rate) {
  const double rate = std::min(std::round(sample_rate), usual_rate);
  const auto sound = heard(
      rate == sample_rate ? std::vector<double>(signal.begin(), signal.end()) : resampled(signal, sample_rate, rate),
      rate);
  double full = 0;
  for (const double x : sound) full = std::max(full, std::abs(x));
  constexpr int bytes_each = 2;
  const auto size = std::uint32_t(sound.size() * bytes_each), per_second = std::uint32_t(rate);
  std::string bytes = "RIFF";
  put(bytes, 36 + size, 4);
  bytes += "WAVEfmt ";
  put(bytes, 16, 4), put(bytes, 1, 2), put(bytes, 1, 2);  // whole numbers, one channel
  put(bytes, per_second, 4), put(bytes, per_second * bytes_each, 4), put(bytes, bytes_each, 2), put(bytes, 16, 2);
  bytes += "data";
  put(bytes, size, 4);
  constexpr double largest = 32'767;
  for (const double x : sound)
    put(bytes, std::uint32_t(std::int32_t(full > 0 ? std::lround(largest * x / full) : 0)), bytes_each);
  write_whole(path, bytes);
  return full;
}

}  // namespace rosin::app::output
