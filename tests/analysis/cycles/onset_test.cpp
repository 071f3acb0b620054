/// Onset of slip in cycles, and the slip that follows.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "tests/analysis/agreement.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::check_agreement;
using rosin::tests::slider_under;

TEST_CASE("slip begins along the load that released it, whatever rounding error the balance has", "[cycle]") {
  // Friction falls within a slip of 7e-11 m under a mass of 5e-16 kg: a force short by its rounding error would grow
  // backwards.
  const double mu_s = 0.2158, mu_d = 0.1701, d_c = 4.37e-7;
  const double lambda = 0.000158, m = 4.766e-16, k = 11.52;
  const double V = 9.718e-5, N = 64.18;
  Model model = slider_under("slip-distance", {mu_s, mu_d, d_c}, {m, k, 0}, V, N);
  model.lambda = lambda;
  model.drive.force = 0.1154;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.stable);
  // Nothing is lost but the work of the weakening, N (mu_s - mu_d) lambda d_c/2, 1e-9 of the spring's: slip oscillates
  // from N mu_s to as far below N mu_d, at the speed of a free mass on its spring.
  CHECK(cycle.metrics.period == Approx(2 * N * (mu_s - mu_d) / (k * V)).epsilon(1e-8));
  CHECK(cycle.metrics.slip_rate_max == Approx(N * (mu_s - mu_d) / std::sqrt(k * m)).epsilon(1e-8));
  CHECK(cycle.metrics.friction_min == Approx(2 * mu_d - mu_s).epsilon(1e-8));
}

TEST_CASE("slip that feeds itself within 1e-7 s begins though rounding hides the load for 1e-3 s", "[cycle]") {
  const oscillators::Slider slider{2.3979e-5, 0.155732, 28.2561};
  const double V = 6.70651e-9, N = 9703.27;
  const double mu_inf = 0.713652, mu_1 = 0.205629, mu_2 = 0.237296;
  Model model = slider_under(
      "thermal", {mu_inf, mu_1, 0.000526807, mu_2, 3.71166, 7.92144e-5, 0.000109077, 2.61336e-5, 0.869153, 0.0141941},
      slider, V, N);
  model.lambda = 0.00815206;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  // Slip takes no time compared with loading: the drive loads the spring again from a friction a little above the
  // least friction.
  const auto& m = cycle.metrics;
  CHECK(m.friction_max == Approx(mu_inf + mu_1 + mu_2).epsilon(1e-12));
  CHECK(m.period == Approx(N * (m.friction_max - m.friction_min) / (slider.stiffness * V)).epsilon(1e-2));
  CHECK(cycle.cost.steps < 50'000);
}

TEST_CASE("friction that falls with a root of the slip rate lets slip begin", "[cycle]") {
  const auto model =
      slider_under("stribeck", {1.114, 0.8187, 0.004743, 0.7688, 0.163}, {0.9033, 4.029e6, 0}, 0.002171, 1.237e-5);
  for (const double tolerance : {1e-6, 1e-9}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.outcome.complete());
    CHECK(cycle.cost.steps < 20'000);
    CHECK(cycle.metrics.friction_max == Approx(1.114));
    CHECK(cycle.metrics.slip_rate_mean == Approx(model.drive.speed.level()).epsilon(1e-9));
  }
}

TEST_CASE("slip that creeps along the rising part of its curve for years is part of the period", "[cycle]") {
  const double V = 3.22e-6, N = 8757.0, k = 0.00421;
  const std::vector<double> v = {0.0, 0.000186, 0.0005579, 0.00186, 0.005579, 0.0186},
                            mu = {0.3707, 0.3151, 0.2873, 0.278, 0.2873, 0.3058};
  const auto cycle = cycles::find_cycle(slider_under("tabulated", {v, mu}, {k, 0.002079, 0.01848}, V, N));
  REQUIRE(cycle.outcome.complete());
  // Slip goes on until the curve rises again, at its lowest friction, and stick loads the spring again.
  CHECK(cycle.metrics.friction_min == Approx(mu[3]).epsilon(1e-9));
  const double creep = (1 - cycle.metrics.stick_fraction) * cycle.metrics.period;
  CHECK(creep > 0.1 * N * (mu[4] - mu[3]) / (k * v[4]));
  CHECK(cycle.metrics.slip_rate_mean == Approx(V).epsilon(1e-9));
}

TEST_CASE("contacts that strengthen far beyond what they held at first stick long, and slip again", "[cycle]") {
  const auto model =
      slider_under("loading-rate", {1.243, 0.1801, 0.3705, 0.1121}, {0.2066, 39.08, 1.192}, 7.865e-8, 0.002736);
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.outcome.complete());
  check_agreement(loose, fine, {&cycles::Metrics::period});
}
