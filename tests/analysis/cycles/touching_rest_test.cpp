/// Cycles whose slip touches rest, or sticks for next to no time, against closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::slider_under;

TEST_CASE("a stick of 1e-5 of the period is as long as static friction grows in it", "[cycle]") {
  // Undamped, slip oscillates as under Coulomb friction with d = (mu_s - mu_d) N/k, and the drive loads 2 d at rest.
  struct Case {
    Model model;
    double mu_s0, beta, t_c, mu_d;
  };
  std::vector<Case> cases = {
      {slider_under("static-growth", {0.4, 0.015, 1.0, 0.3}, {1e12, 7417.0, 0}, 2.259e-7, 0.008349), 0.4, 0.015, 1.0,
       0.3},
      {slider_under("static-growth", {0.2167, 0.01988, 0.0001352, 0.1332}, {0.1132, 9.617e4, 0}, 0.7187, 0.04036),
       0.2167, 0.01988, 0.0001352, 0.1332}};
  cases[0].model.lambda = 4.07e5;
  for (const auto& [model, mu_s0, beta, t_c, mu_d] : cases) {
    const double k = model.slider.stiffness, V = model.drive.speed.level(), N = model.drive.normal_load.level();
    double d = 0;
    for (int i = 0; i < 50; ++i) d = (mu_s0 + beta * std::log10(1 + 2 * d / V / model.lambda / t_c) - mu_d) * N / k;
    const double w = std::sqrt(k / model.slider.mass), stick = 2 * d / V;
    const double period = 2 * (std::numbers::pi - std::atan(w * d / V)) / w + stick;
    INFO("stick for " << stick / period << " of the period");
    const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
    REQUIRE(cycle.outcome.complete());
    CHECK(std::abs(cycle.metrics.period - period) <= cycle.error.period);
    CHECK(std::abs(cycle.metrics.stick_fraction - stick / period) <= cycle.error.stick_fraction);
    CHECK(cycle.error.stick_fraction <= 1e-6);
    CHECK(cycle.metrics.stick_fraction == Approx(stick / period).epsilon(0.05));
  }
}

TEST_CASE("friction that falls along all of a slip lets it touch rest with the slip rate that it began with",
          "[cycle]") {
  // Between onset and rest the contact is a spring of negative stiffness κ: the slip rate is V k/(k − κ) (1 − cos ωt),
  // ω² = (k − κ)/m, whose bottom touches rest, and the static coefficient, whole again, holds for κ/(k − κ) of the
  // slip.
  const double mu_s = 0.4, mu_d = 0.3, d_c = 1e-5, lambda = 52.9117;
  const double m = 0.000964646, k = 3982.87, V = 0.073707;
  for (const double N : {8.2192e-5, 4.2}) {
    INFO("load " << N);
    Model model = slider_under("slip-distance", {mu_s, mu_d, d_c}, {m, k, 0}, V, N);
    model.lambda = lambda;
    const double kappa = N * (mu_s - mu_d) / (lambda * d_c), omega = std::sqrt((k - kappa) / m);
    const double slip = 2 * std::numbers::pi / omega, mean = V * k / (k - kappa);
    REQUIRE(mean * slip < lambda * d_c);
    const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
    REQUIRE(cycle.metrics.period > 0);
    CHECK(std::abs(cycle.metrics.period - slip * k / (k - kappa)) <= cycle.error.period);
    CHECK(cycle.metrics.period == Approx(slip * k / (k - kappa)).epsilon(1e-8));
    CHECK(std::abs(cycle.metrics.slip_rate_max - 2 * mean) <= cycle.error.slip_rate_max);
    CHECK(std::abs(cycle.metrics.stick_fraction - kappa / k) <= cycle.error.stick_fraction);
  }
}

TEST_CASE("friction after slip that touches rest is known to the root of rounding error", "[cycle]") {
  // Rest lasts for the time of an oscillation by sqrt(2 epsilon), in which the drive loads 1e-4 of the friction.
  const double mu_s = 0.3754, mu_d = 0.3011, d_c = 0.1594;
  const double m = 1e12, k = 0.7604, V = 3.191e-7;
  auto model = slider_under("slip-distance", {mu_s, mu_d, d_c}, {m, k, 0}, V, 1.46e-5);
  model.lambda = 3.702e5;
  // Friction falls with the distance of slip, V times the period of a free oscillation, and slip goes on from rest that
  // it only touches.
  const double slipped = V * 2 * std::numbers::pi * std::sqrt(m / k);
  const double touching = mu_d + (mu_s - mu_d) * std::exp(-slipped / (model.lambda * d_c));
  for (const double tolerance : {1e-4, 1e-6, 1e-9}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.metrics.period > 0);
    CHECK(std::abs(cycle.metrics.friction_min - touching) <= cycle.error.friction_min);
    CHECK(cycle.error.friction_min < 1e-3);
  }
}

TEST_CASE("slip that friction lets touch rest ends there at every tolerance", "[cycle]") {
  // While friction falls by κ = 1076 N/m against 1348 N/m of the spring, v = V k/(k - κ) (1 - cos wt) touches 0.
  const double m = 204.9, k = 1348.0, V = 5.074e-8, N = 0.1691;
  const double mu_s = 0.4513, mu_d = 0.2068, d_c = 1.037e-6;
  auto model = slider_under("slip-distance", {mu_s, mu_d, d_c}, {m, k, 0}, V, N);
  model.lambda = 37.07;
  model.drive.force = Signal(0.006171);
  const double kappa = N * (mu_s - mu_d) / (model.lambda * d_c);
  REQUIRE(kappa < k);
  const double period = 2 * std::numbers::pi * std::sqrt(m / (k - kappa)) * k / (k - kappa);
  for (const double tolerance : {1e-6, 1e-7, 1e-8}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance});
    CHECK(cycle.metrics.slip_rate_max == Approx(2 * V * k / (k - kappa)).epsilon(0.05));
    CHECK(cycle.metrics.period == Approx(period).epsilon(1e-3));
  }
}

TEST_CASE("slip that loses nothing comes back to the static limit that it began at, and is held", "[cycle]") {
  // A free oscillation from rest to rest, after which the drive takes the load from one limit to the other.
  const double V = 1.978e-7, N = 2.206e-7;
  auto model = slider_under("loading-rate", {10.0, 10.0, 94.62, 1e-30}, {23.49, 4.167e5, 0}, V, N);
  const double k = model.slider.stiffness, w = std::sqrt(k / model.slider.mass), d = 10 * N / k;
  const double stick = 2 * d / V, slip = 2 * (std::numbers::pi - std::atan(w * d / V)) / w;
  for (const double tolerance : {1e-5, 1e-6, 3e-7, 1e-8}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.outcome.complete());
    CHECK(std::abs(cycle.metrics.period - (stick + slip)) <= cycle.error.period);
    CHECK(std::abs(cycle.metrics.stick_fraction - stick / (stick + slip)) <= cycle.error.stick_fraction);
  }
}
