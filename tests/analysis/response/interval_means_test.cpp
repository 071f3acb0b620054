/// Slip rate out of a displacement: means of intervals, exact where all runs straight, with a stated bias else.
#include "analysis/response/interval_means.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

using namespace rosin::analysis::response;

namespace {

constexpr double rate = 1000, turn = 2 * std::numbers::pi;
constexpr std::size_t samples = 20'000;

/// The response in blocks of several lengths, by a clock whose first times tell `assumed`.
MeasuredFrf measured(const std::vector<double>& position, const std::vector<double>& force, double assumed) {
  IntervalMeans means(2, assumed);
  CrossSpectra spectra(2, {.segment = 500});
  for (std::size_t begin = 0, length = 1; begin < samples; begin += length, length = 3 * length + 1) {
    const auto count = std::min(length, samples - begin);
    const std::span<const double> block[] = {std::span(position).subspan(begin, count),
                                             std::span(force).subspan(begin, count)};
    spectra.add(means.add(block));
  }
  CHECK(spectra.samples() == samples - 1);
  auto result = extract_frf(spectra, {}, rate, {.from = 4, .to = highest_part * rate});
  state_interval_bias(result, assumed, rate);
  return result;
}

}  // namespace

TEST_CASE("a displacement that was made of straight pieces of slip rate gives the response to the last digits",
          "[response]") {
  std::mt19937 dice(5);
  std::vector<double> position(samples), force(samples);
  double x = 0, before = 0.02;
  for (std::size_t i = 0; i < samples; ++i) {
    const double v = 0.02 + 1e-3 * (double(dice()) / 4294967296.0 - 0.5);
    x += i > 0 ? 0.5 * (v + before) / rate : 0;
    before = v, position[i] = x, force[i] = 3 + 200 * v;
  }
  const auto found = measured(position, force, 999);
  CHECK(found.slip_rate == Approx(0.02).epsilon(1e-3));
  for (std::size_t k = 0; k < found.frequency.size(); ++k) {
    CHECK(std::abs(found.tangential[k] - 200.0) < 1e-6);
    CHECK(found.coherence[k] > 1 - 1e-9);
  }
}

TEST_CASE("the bias of means of intervals is stated where motion holds no frequency above the samples'", "[response]") {
  // A dashpot of 200 N s/m beside a mass of 0.3 kg: Z = 200 + 0.3 iω.
  constexpr double dashpot = 200, mass = 0.3;
  std::mt19937 dice(3);
  std::vector<double> position(samples), force(samples);
  for (double f = 1; f < 480; f += 0.7) {  // at random phases
    const double w = turn * f, amplitude = 1e-4 / f;
    const auto step = std::polar(1.0, w / rate);
    auto x = std::polar(amplitude, turn * double(dice()) / 4294967296.0);
    for (std::size_t i = 0; i < samples; ++i, x *= step) {
      position[i] += x.real();
      force[i] += (std::complex<double>(dashpot, mass * w) * std::complex<double>(0, w) * x).real();
    }
  }
  for (std::size_t i = 0; i < samples; ++i) position[i] += 0.02 * double(i) / rate;
  const auto found = measured(position, force, rate);
  REQUIRE(found.frequency.size() > 100);
  for (std::size_t k = 0; k < found.frequency.size(); ++k) {
    const std::complex<double> Z(dashpot, mass * turn * found.frequency[k]);
    const double half = std::numbers::pi * found.frequency[k] / rate;
    CHECK(std::abs(found.tangential[k] - Z * half / std::tan(half)) < 5e-3 * std::abs(Z));
    if (half > 0.1) CHECK(std::abs(found.tangential[k] - Z) < 1.5 * found.bias_error[k] + 2 * found.standard_error[k]);
  }
}

TEST_CASE("no segment reaches across an interruption", "[response]") {
  CrossSpectra spectra(1, {.segment = 64, .overlap = 0.5});
  const std::vector<double> values(100, 1.0);
  const std::span<const double> block[] = {values};
  spectra.add(block);  // two segments, 96 samples
  spectra.interrupt();
  spectra.add(block);
  CHECK(spectra.segments() == 4);
  CHECK(spectra.used() == 192);
  CHECK(spectra.samples() == 200);
}
