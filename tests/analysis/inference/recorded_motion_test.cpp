/// Motions behind recorded displacements, against the motions that made them.
#include "analysis/inference/recorded_motion.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "core/random.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;

namespace {

struct Record {
  std::vector<double> time, displacement;
};
Record sampled(int samples, double spacing, const std::function<double(double)>& displacement) {
  Record record;
  for (int i = 0; i < samples; ++i) {
    record.time.push_back(spacing * i);
    record.displacement.push_back(displacement(spacing * i));
  }
  return record;
}
double rms(const std::vector<double>& x, const std::function<double(std::size_t)>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += std::pow(x[i] - truth(i), 2);
  return std::sqrt(sum / double(x.size()));
}

// A sine of 1 mm and 30 rad/s.
constexpr double size = 1e-3, pulse = 30;
double sine(double t) { return size * std::sin(pulse * t); }
double rate(double t) { return pulse * size * std::cos(pulse * t); }

}  // namespace

TEST_CASE("displacements without noise stay, and their slip rate is that of the motion", "[recorded-motion]") {
  const auto record = sampled(2000, 0.001, sine);
  const auto motion = recorded_motion(record.time, record.displacement);
  CHECK(rms(motion.displacement, [&](std::size_t i) { return record.displacement[i]; }) < 1e-9 * size);
  CHECK(rms(motion.before, [&](std::size_t i) { return rate(record.time[i]); }) < 1e-4 * pulse * size);
  CHECK(motion.before == motion.after);
  CHECK(motion.resolution == 0);
}

TEST_CASE("noise of a displacement, and steps of an encoder, are found and taken out", "[recorded-motion]") {
  const bool steps = GENERATE(false, true);
  const double noise = 2e-6, step = noise * std::sqrt(12.0);
  const auto record = [&] {
    auto made = sampled(2000, 0.001, sine);
    const auto white = white_noise(2000, 5);
    for (std::size_t i = 0; i < 2000; ++i) {
      double& x = made.displacement[i];
      x = steps ? step * std::round(x / step) : x + noise * white[i];
    }
    return made;
  }();
  const auto motion = recorded_motion(record.time, record.displacement);
  INFO("steps " << steps);
  CHECK(motion.noise == Approx(noise).epsilon(0.1));
  CHECK(motion.resolution == Approx(steps ? step : 0).epsilon(1e-6));
  // Neighbours alone tell the slip rate to √2 times the noise over the interval.
  const double error = rms(motion.before, [&](std::size_t i) { return rate(record.time[i]); });
  CHECK(error < 0.1 * std::sqrt(2.0) * noise / 0.001);
  const auto middle = motion.standard_error[1000];
  CHECK(error > 0.5 * middle);
  CHECK(error < 2 * middle);
  // Recorded once more it errs as much again.
  const auto again = recorded_again(record.time, motion, 7);
  const double change = rms(again.before, [&](std::size_t i) { return motion.before[i]; });
  CHECK(change > 0.5 * middle);
  CHECK(change < 2 * middle);
}

TEST_CASE("sliding, rest and sliding have corners, with noise and without", "[recorded-motion]") {
  const double V = 1e-5, noise = GENERATE(0.0, 1e-9, 1e-7);
  auto record = sampled(900, 0.1, [&](double t) { return V * (t < 30 ? t : t < 60 ? 30 : t - 30); });
  const auto white = white_noise(900, 3);
  for (std::size_t i = 0; i < 900; ++i) record.displacement[i] += noise * white[i];
  const auto motion = recorded_motion(record.time, record.displacement);
  const double bound = 1e-3 * V + 0.1 * noise / 0.1;
  for (const std::size_t i : {10, 200, 295, 700, 880}) CHECK(motion.before[i] == Approx(V).margin(bound));
  for (const std::size_t i : {310, 450, 590}) {
    CHECK(motion.before[i] == Approx(0).margin(bound));
    if (noise == 0) CHECK(motion.after[i] == 0);
  }
  CHECK(std::ranges::count(motion.corner, 1) >= 2);
  CHECK(std::ranges::count(motion.corner, 1) <= 4);
}
