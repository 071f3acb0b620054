/// Coverage of intervals, and bias, of a velocity step as laboratories record it: behind a machine, on a trend, with a
/// clock that is off, and with correlated noise whose size nobody states.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/inference/fit.hpp"
#include "core/random.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;
using oscillators::Model;

namespace {

constexpr double trend = -2.1e-4, late = 0.04, noise = 3e-4;

Model layer(double a, double b, double L, double stiffness) {
  auto model = tests::slider_under("slip", {0.59, a, b, L, 1e-5}, {.mass = 1, .stiffness = 1, .damping = 0}, 1e-5, 20);
  model.contact_stiffness.per_load = stiffness;
  return model;
}

/// A step from 10 to 30 µm/s, of which the clock says that it took place at 0.
Measurement record(int points, double every, double correlation, std::uint64_t seed) {
  Measurement m{Measurement::Kind::velocity_step, "step", 1e-5, 3e-5, 20, {}, {}, {}};
  for (int k = 0; k < points; ++k) m.x.push_back(-1 + every * k);
  m.y = predict(layer(0.008, 0.005, 12e-6, 2500), m, {}, late).y;
  const auto independent = white_noise(m.y.size(), seed);
  double last = independent.front();
  for (std::size_t k = 0; k < m.y.size(); ++k) {
    if (k > 0) last = correlation * last + std::sqrt(1 - correlation * correlation) * independent[k];
    m.y[k] += trend * m.x[k] + noise * last;
  }
  m.terms = {Measurement::Terms::Trend::time, false, true};
  return m;
}

const std::vector<std::string> paths = {"law.mu0", "law.a", "law.b", "law.L", "law.contact_stiffness.per_load"};
const double truth[] = {0.59, 0.008, 0.005, 12e-6, 2500, trend, late};
constexpr std::size_t numbers = std::size(truth);

/// Of each number: how often its interval holds the truth, and the mean error over the mean standard error.
struct Coverage {
  int inside[numbers] = {};
  double bias[numbers] = {};
  int all() const {
    int sum = 0;
    for (const int n : inside) sum += n;
    return sum;
  }
};
Coverage coverage(int realisations, int points, double every, double correlation) {
  Coverage found;
  double error[numbers] = {};
  for (int r = 0; r < realisations; ++r) {
    const auto fitted =
        fit(layer(0.007, 0.006, 15e-6, 2000), {record(points, every, correlation, std::uint64_t(r + 1))},
            {.parameters = paths, .starts = 1, .profiles = false});
    REQUIRE(fitted.parameters.size() == numbers);
    for (std::size_t i = 0; i < numbers; ++i) {
      const auto& p = fitted.parameters[i];
      found.inside[i] += p.low <= truth[i] && truth[i] <= p.high;
      found.bias[i] += p.value - truth[i], error[i] += p.standard_error;
    }
  }
  for (std::size_t i = 0; i < numbers; ++i) found.bias[i] /= error[i];
  return found;
}

}  // namespace

TEST_CASE("intervals of a step with trend, clock and correlated noise hold the truth as often as they say",
          "[fit][long]") {
  constexpr int realisations = 40;
  const auto found = coverage(realisations, 100, 0.05, 0.5);
  const double part = double(found.all()) / (realisations * double(numbers));
  INFO(part);
  // Numbers of one fit err together: as if a third of them were independent, 2.5 standard deviations. Without the
  // correlation of the noise the intervals hold the truth in 78 %.
  const double band = 2.5 * std::sqrt(0.95 * 0.05 / (realisations * double(numbers) / 3));
  CHECK(std::abs(part - 0.95) < band);
  for (const double bias : found.bias) CHECK(std::abs(bias) < 0.2 + 3 / std::sqrt(double(realisations)));
}

TEST_CASE("over 200 records intervals hold the truth in 93 to 97 %, without bias", "[fit][.][long]") {
  constexpr int realisations = 200;
  for (const double correlation : {0.0, 0.5}) {
    const auto found = coverage(realisations, 400, 0.02, correlation);
    for (std::size_t i = 0; i < numbers; ++i)
      WARN(fmt::format("correlation {}: {} in {:.1f} %, bias {:+.3f} standard errors", correlation,
                       i < paths.size()    ? paths[i]
                       : i == paths.size() ? "trend"
                                           : "clock_offset",
                       100.0 * found.inside[i] / realisations, found.bias[i]));
    const double part = double(found.all()) / (realisations * double(numbers));
    WARN(fmt::format("correlation {}: {:.2f} % of all", correlation, 100 * part));
    CHECK(part >= 0.93);
    CHECK(part <= 0.97);
    for (const double bias : found.bias) CHECK(std::abs(bias) < 0.2);
  }
}
