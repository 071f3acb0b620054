/// Clipping: flat tops are seen, and told from the steps of a converter.
#include "analysis/response/clipping.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/random.hpp"

using namespace rosin::analysis;
using namespace rosin::analysis::response;

namespace {

/// Noise below a thirtieth of the sample rate, of rms about 1.
std::vector<double> slow_noise(std::size_t count) {
  auto x = rosin::white_noise(count, 11);
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t i = 1; i < x.size(); ++i) x[i] = 0.9 * x[i - 1] + 0.3 * x[i];
  return x;
}
ClippingWatch watched(const std::vector<double>& x) {
  ClippingWatch watch;
  for (const double value : x) watch.add(value);
  return watch;
}

}  // namespace

TEST_CASE("flat tops at a sensor's limit are seen at the end that has them", "[extraction]") {
  auto x = slow_noise(20000);
  CHECK(clipping_warning(watched(x), "force", "N", 20000).empty());
  const double limit = 0.7 * *std::ranges::max_element(x);
  const auto beyond = std::ranges::count_if(x, [&](double value) { return value >= limit; });
  for (double& value : x) value = std::min(value, limit);
  const auto watch = watched(x);
  REQUIRE(watch.high().has_value());
  CHECK(watch.high()->value == limit);
  CHECK(watch.high()->samples == beyond);
  CHECK_FALSE(watch.low().has_value());
  for (double& value : x) value = std::max(value, -limit);
  CHECK(watched(x).low()->value == -limit);
  CHECK_THAT(clipping_warning(watched(x), "force", "N", 20000),
             Catch::Contains("force is flat at its largest value") && Catch::Contains("; force is flat at its least"));
}

TEST_CASE("steps of a converter, a settled level and two levels are no clipping", "[extraction]") {
  for (const double step : {0.01, 0.1, 0.5}) {
    auto x = slow_noise(20000);
    for (double& value : x) value = step * std::round(value / step);
    CHECK(clipping_warning(watched(x), "force", "N", 20000).empty());
    std::vector<double> sine;
    for (int i = 0; i < 20000; ++i) sine.push_back(step * std::round(std::sin(0.01 * i) / step));
    CHECK(clipping_warning(watched(sine), "force", "N", 20000).empty());
  }
  std::vector<double> settled, levels;
  for (int i = 0; i < 5000; ++i) {
    settled.push_back(std::round(1e6 * std::exp(-0.01 * i)));
    levels.push_back((i / 50) % 2);
  }
  CHECK(clipping_warning(watched(settled), "friction", "1", 5000).empty());
  CHECK(clipping_warning(watched(levels), "reference", "1", 5000).empty());
  CHECK(clipping_warning(watched(std::vector<double>(100, 1.0)), "load", "N", 100).empty());
}
