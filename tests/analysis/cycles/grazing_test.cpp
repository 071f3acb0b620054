/// Cycles whose slip grazes rest: it comes to rest, touches it or reverses by next to nothing.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "tests/analysis/agreement.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::check_agreement;
using rosin::tests::slider_under;

TEST_CASE("grazing slip is not missed at a loose tolerance", "[cycle]") {
  // Coulomb friction with an amplitude of slip 1e5 times that of stick: the slider grazes rest within 1e-12 V. Stick
  // lasts for 2 d/V, slip for 2 (pi - atan(w d/V))/w, with d = N (mu_s - mu_d)/k.
  const double mu_s = 0.31, mu_d = 0.2252, m = 9.876e4, k = 0.06041, V = 65.1, N = 0.1084;
  const double d = N * (mu_s - mu_d) / k, w = std::sqrt(k / m);
  const double stick = 2 * d / V, slip = 2 * (std::numbers::pi - std::atan(w * d / V)) / w;
  const auto cycle = cycles::find_cycle(slider_under("coulomb", {mu_s, mu_d}, {m, k, 0}, V, N), {.tolerance = 1e-6});
  CHECK(cycle.metrics.stick_fraction == Approx(stick / (stick + slip)).epsilon(1e-4));
}

TEST_CASE("grazing slip with a stick of 1e-3 of the period repeats itself at the requested tolerance", "[cycle]") {
  // The law's state counts the stick of a thousandth of a period, and scatters with the times of the stops.
  auto model = slider_under("loading-rate", {10.0, 0.2253, 0.002659, 0.09628}, {0.08582, 373.7, 0}, 9.658e-6, 7.085e-7);
  model.drive.force = -3.255e-8;
  model.lambda = 4.032e-5;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6}),
             finer = cycles::find_cycle(model, {.tolerance = 1e-8});
  REQUIRE(cycle.outcome.complete());
  REQUIRE(finer.outcome.complete());
  CHECK(cycle.metrics.friction_mean == Approx(0.09628).epsilon(1e-6));  // sliding friction hardly changes
  check_agreement(cycle, finer);
}

TEST_CASE("slip that comes to rest at 1e-17 of its size is a cycle, and the friction at rest is known too", "[cycle]") {
  Model model =
      slider_under("thermal", {0.3359, 0.2083, 0.02326, 0.1771, 0.06178, 6.373e-8, 0.002715, 0.006065, 1.0, 2.28},
                   {0.0445, 7.67, 0}, 15.27, 0.2004);
  model.lambda = 1.109e5;
  model.drive.force = -0.117;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6}),
             tight = cycles::find_cycle(model, {.tolerance = 1e-10});
  CHECK(cycle.outcome.complete());
  CHECK(std::abs(cycle.metrics.friction_min - tight.metrics.friction_min) <= cycle.error.friction_min);
  CHECK(cycle.metrics.slip_rate_mean == Approx(model.drive.speed.level()).epsilon(1e-8));
}

TEST_CASE("a stick of no time or of 1e-8 of the period leaves friction uncertain by its load", "[cycle]") {
  const auto cycle_at = [](double tolerance) {
    auto model = slider_under("thermal",
                              {0.3649, 0.4859, 3.166e-5, 0.5509, 1.714e-6, 6.976e-7, 0.009554, 1.08e-7, 0.4958, 452.4},
                              {0.0002437, 2.778e5, 0}, 4.977e-10, 2.023e-12);
    model.lambda = 0.0001176;
    return cycles::find_cycle(model, {.tolerance = tolerance});
  };
  const auto loose = cycle_at(1e-6), tight = cycle_at(1e-9);
  check_agreement(loose, tight, {&cycles::Metrics::friction_min});
}

TEST_CASE("a cycle that reverses by 3e-6 of the drive's speed is refined with the derivative that it has there",
          "[cycle]") {
  auto model = slider_under("two-state-ageing", {0.6, 0.01, 0.009, 2e-6, 0.006, 4e-5, 1e-6}, {383.0, 0.2228, 0},
                            0.06707, 0.0002228);
  model.lambda = 2.115e4;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.outcome.complete());
  // Slip comes within 3e-6 of the drive speed of not reversing, and friction takes its other sign within that.
  CHECK(fine.metrics.slip_rate_min < 0);
  CHECK(fine.metrics.slip_rate_min > -1e-5 * model.drive.speed.level());
  CHECK(fine.metrics.friction_min < -0.4);
  check_agreement(loose, fine, {&cycles::Metrics::friction_min});
}

TEST_CASE("a short stick in a free oscillation is not passed over", "[cycle]") {
  // From rest, loaded to the static limit, the slider oscillates by V about the drive at constant friction and comes
  // back to rest, but for the friction added within 1e-4 V of it: 1e-3 of the spring force, in a hundredth of the
  // period.
  const double V = 1e4, N = 279.4, k = 18.19, m = 25.53;
  const double mu_inf = 0.2478, mu_1 = 0.4137, mu_2 = 0.3282;
  const auto model = slider_under("two-exponential", {mu_inf, mu_1, 0.006465, mu_2, 0.2646}, {m, k, 0}, V, N);
  // A period is a whole oscillation and the time that the drive takes to load the spring from rest to the limit.
  const double oscillation = 2 * std::numbers::pi * std::sqrt(m / k);
  for (const double tolerance : {1e-2, 1e-3, 1e-5, 1e-6, 1e-9}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.outcome.complete());
    CHECK(cycle.metrics.stick_fraction > 0);
    CHECK(cycle.metrics.friction_max == Approx(mu_inf + mu_1 + mu_2));
    CHECK(std::abs(cycle.metrics.period / oscillation - 1) < 1e-4);
    CHECK(std::abs(cycle.metrics.slip_rate_mean / V - 1) <= cycle.error.slip_rate_mean / V);
  }
}

TEST_CASE("slip that passes a threshold and comes back within a step is seen", "[cycle]") {
  // Oscillations with lowest slip rate -0.0101 V: outside 0.01 V for a moment, which at 1e-6 lies between two nodes.
  const double V = 0.05899;
  const auto model = slider_under("hyperbolic", {0.165, 4.764}, {3.223, 5.582, 0}, V, 0.01314);
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  REQUIRE(-cycle.metrics.slip_rate_min > 0.01 * V);
  REQUIRE(-cycle.metrics.slip_rate_min < 0.0102 * V);
  motion::RunOptions options;
  options.duration = cycle.metrics.period;
  options.samples = 100'000;
  options.start.kind = motion::Start::Kind::given;
  options.start.displacement = cycle.section_displacement;
  options.start.slip_rate = V;
  const auto motion = motion::run(model, options);
  const auto& slip_rate = motion.columns[2];
  const auto slow =
      std::count_if(slip_rate.begin(), slip_rate.end(), [&](double u) { return std::abs(u) <= 0.01 * V; });
  CHECK(cycle.metrics.stick_fraction_001 == Approx(double(slow) / options.samples).margin(1e-4));
}

TEST_CASE("slip that reverses by less than its error may as well rest", "[cycle]") {
  // Friction is 2e-13 of the spring's force: v = V (1 - cos wt), which touches rest, and rounding error decides whether
  // slip reverses.
  const double m = 0.2085, k = 3.159e6, V = 10000;
  auto model = slider_under("thermal", {0.7898, 0.3184, 368.3, 1.043, 0.3113, 0.001018, 34.87, 9.251e-8, 1.0, 4693.0},
                            {m, k, 0}, V, 1.761e-5);
  model.lambda = 235.9;
  model.drive.force = 5.3e-6;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             tight = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.metrics.period > 0);
  REQUIRE(tight.metrics.period > 0);
  CHECK(std::abs(loose.metrics.period - 2 * std::numbers::pi * std::sqrt(m / k)) <= loose.error.period);
  check_agreement(loose, tight,
                  {&cycles::Metrics::friction_mean, &cycles::Metrics::friction_min, &cycles::Metrics::stick_fraction});
}

TEST_CASE("slip that misses rest within rounding error of its highest rate has come to rest", "[cycle][long]") {
  // Rounding error would decide by which oscillation: a period had 1, 2 or 33 of them.
  const double m = 2.84168, k = 9573.62;
  auto model = slider_under(
      "thermal", {0.83118, 0.166724, 9.35607e-6, 0.24898, 0.000451573, 3.57551e-5, 0.00280819, 14.6541, 1.0, 442.695},
      {m, k, 0}, 0.504161, 2.51881);
  model.lambda = 4138.08;
  for (const double tolerance : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance, .multipliers = false});
    REQUIRE(cycle.outcome.complete());
    CHECK(cycle.metrics.period == Approx(2 * std::numbers::pi * std::sqrt(m / k)).epsilon(1e-9));
  }
}
