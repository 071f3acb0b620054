/// Spectra of motions: sinusoids between the frequencies of a transform, windows, and amplitudes over time.
#include "analysis/motion/spectrum.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;

namespace {

Run record(double duration, int samples, const std::function<double(double)>& x) {
  Run run;
  run.column_names = {"displacement"}, run.column_units = {"m"}, run.columns.resize(1);
  for (int i = 0; i <= samples; ++i) {
    run.time.push_back(duration * i / samples);
    run.columns[0].push_back(x(run.time.back()));
  }
  return run;
}

constexpr double turn = 2 * std::numbers::pi;

}  // namespace

TEST_CASE("sinusoids between the frequencies of a transform are told within their errors") {
  const auto run = record(
      20, 4000, [](double t) { return 0.7 + 2 * std::cos(turn * 3.313 * t + 0.4) + 0.5 * std::sin(turn * 7.777 * t); });
  for (const auto* window : {"hann", "blackman-harris", "rectangular"}) {
    INFO(window);
    const auto found = spectrum(run, {.columns = {}, .window = window});
    REQUIRE(found.lines[0].size() >= 2);
    const double wanted[][2] = {{3.313, 2}, {7.777, 0.5}};
    for (int k = 0; k < 2; ++k) {
      const auto& line = found.lines[0][std::size_t(k)];
      CHECK(std::abs(line.frequency - wanted[k][0]) <= line.frequency_error);
      CHECK(std::abs(line.amplitude - wanted[k][1]) <= line.amplitude_error);
      if (std::string(window) == "rectangular") continue;
      CHECK(line.frequency_error < 1e-3);
      CHECK(line.amplitude_error < 1e-2);
    }
    CHECK(found.amplitude[0].front() == Approx(0.7).epsilon(0.02));
  }
}

TEST_CASE("a record of whole periods has its harmonics at their frequencies, those of a square wave at 4/(pi k)") {
  const auto run = record(8, 4096, [](double t) { return std::sin(turn * (t + 1e-4)) > 0 ? 1.0 : -1.0; });
  const auto found = spectrum(run, {.columns = {}, .window = "rectangular"});
  for (int k = 0; k < 3; ++k) {
    const auto& line = found.lines[0][std::size_t(k)];
    const double order = 2 * k + 1;
    CHECK(line.frequency == Approx(order).epsilon(1e-9));
    CHECK(std::abs(line.amplitude - 4 / (std::numbers::pi * order)) <= line.amplitude_error);
    CHECK(line.amplitude_error < 1e-3);
  }
}

TEST_CASE("a spectrogram shows when an oscillation grows") {
  const auto run = record(20, 4000, [](double t) { return (t < 10 ? 1 : 3) * std::cos(turn * 5 * t); });
  const auto found = spectrum(run, {.columns = {}, .segment = 2});
  REQUIRE(found.part_time.size() == 19);
  CHECK(found.part_time.front() == Approx(1));
  const auto at = std::ranges::min_element(found.part_frequency, {}, [](double f) { return std::abs(f - 5); });
  const auto column = std::size_t(at - found.part_frequency.begin()), width = found.part_frequency.size();
  CHECK(found.part_amplitude[0][2 * width + column] == Approx(1).epsilon(1e-9));
  CHECK(found.part_amplitude[0][16 * width + column] == Approx(3).epsilon(1e-9));
}

TEST_CASE("a record without equal intervals, an unknown column and parts out of range are refused") {
  auto run = record(20, 400, [](double t) { return std::cos(t); });
  CHECK_THROWS_WITH(spectrum(run, {.columns = {"displacment"}}), Catch::Contains("did you mean 'displacement'"));
  CHECK_THROWS_WITH(spectrum(run, {.columns = {}, .segment = 0.1}),
                    Catch::Contains("run.spectrum.segment = 0.1 s is outside 0.8"));
  CHECK_THROWS_WITH(spectrum(run, {.columns = {}, .from = 19.5}), Catch::Contains("leaves 10 samples, fewer than 16"));
  run.time[7] += 0.01;
  CHECK_THROWS_WITH(spectrum(run, {}), Catch::Contains("needs samples at equal intervals"));
}
