/// Responses from tables against closed forms.
#include "core/sampled_response.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace {

using namespace rosin;

constexpr double rate = 30, turn = 400;  // 1/s

/// e^{−at} sin ωt every `spacing` until it is gone.
Signal::Table decaying_mode(double spacing) {
  Signal::Table table;
  for (int i = 0; i * spacing < 1; ++i) {
    table.time.push_back(i * spacing);
    table.value.push_back(std::exp(-rate * i * spacing) * std::sin(turn * i * spacing));
  }
  return table;
}

TEST_CASE("a ramp through the table of a mode is that of the mode, better by four at half the spacing", "[core]") {
  // y″ + 2a y′ + (a² + ω²) y = ω t from rest.
  const double square = rate * rate + turn * turn;
  const auto exact = [&](double t) {
    const double still = turn / square * (t - 2 * rate / square);
    const double sine = (2 * rate * rate / square - 1) / square, cosine = 2 * rate * turn / (square * square);
    return still + std::exp(-rate * t) * (cosine * std::cos(turn * t) + sine * std::sin(turn * t));
  };
  const double step = 3e-4;
  std::vector<double> ramp;
  for (int n = 0; n < 500; ++n) ramp.push_back(n * step);
  double before = 0;
  for (const double spacing : {8e-4, 4e-4, 2e-4}) {
    const auto sound = convolved(ramp, sampled(decaying_mode(spacing), 0, step));
    double largest = 0;
    for (std::size_t n = 0; n < ramp.size(); ++n)
      largest = std::max(largest, std::abs(sound[n] - exact(double(n) * step)));
    if (before > 0) CHECK(before / largest == Approx(4).margin(0.2));
    before = largest;
  }
  CHECK(before < 1e-6);
}

TEST_CASE("what is constant for ever stays so, and a response may look ahead", "[core]") {
  const auto response = sampled({{-1e-3, 0, 2e-3}, {0, 100, 0}}, 0, 2.5e-4);
  CHECK(response.first < 0);
  CHECK(response.sum() == Approx(0.15));
  for (const double y : convolved(std::vector<double>(40, 3.0), response)) CHECK(y == Approx(0.45));
  CHECK(sampled({{-1e-3, 0, 2e-3}, {0, 100, 0}}, 5e-3, 2.5e-4).delay() == Approx(response.delay() + 20));
}

TEST_CASE("sampling makes no gain larger", "[core]") {
  // −δ(t − 1 ms) + ½ δ(t − 2 ms), each as a triangle: a gain of 1.5 at odd multiples of 500 Hz, less above.
  const Signal::Table table{{9e-4, 1e-3, 1.1e-3, 1.9e-3, 2e-3, 2.1e-3}, {0, -1e4, 0, 0, 5e3, 0}};
  for (const double step : {1.3e-5, 1e-4, 3.1e-4}) {
    const auto largest = largest_gain(sampled(table, 0, step));
    CAPTURE(step);
    CHECK(largest.gain < 1.5);
    CHECK(largest.gain > 1.3);
    CHECK(largest.frequency / step == Approx(500).epsilon(0.1));
  }
}

}  // namespace
