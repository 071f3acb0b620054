/// States that decide a cycle: heat that is gone at once, at rest, or only after thousands of periods.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "laws/catalogue.hpp"
#include "tests/analysis/agreement.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::check_agreement;
using rosin::tests::slider_under;

TEST_CASE("heat that is gone within 1e-7 of a slip does not hold its steps", "[cycle]") {
  // Then friction follows the curve of steady sliding.
  const oscillators::Slider slider{110.6, 202.3, 3.844};
  const double V = 0.0004554, N = 3.849;
  const double mu_inf = 0.1175, mu_1 = 0.5341, v_1 = 0.0544, mu_2 = 0.3344, v_2 = 1.124;
  Model model = slider_under("thermal-disc", {mu_inf, mu_1, v_1, mu_2, v_2, 2.802e-7, 19.22, 0.4152, 1.0, 0.0, 942.8},
                             slider, V, N);
  model.lambda = 0.1562;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.cost.steps < 20'000);
  const auto curve = cycles::find_cycle(slider_under("two-exponential", {mu_inf, mu_1, v_1, mu_2, v_2}, slider, V, N));
  REQUIRE(curve.outcome.complete());
  CHECK(cycle.metrics.period == Approx(curve.metrics.period).epsilon(1e-5));
  CHECK(cycle.metrics.slip_rate_max == Approx(curve.metrics.slip_rate_max).epsilon(1e-5));
}

TEST_CASE("slip hotter than any steady sliding keeps its derivatives", "[cycle]") {
  // h1/h0 bounds the temperature of steady sliding at the load N_ref; a larger one rises beyond.
  Model model = slider_under("thermal-disc",
                             {0.1718, 1.207, 1.632e-7, 0.6255, 0.008303, 0.1202, 0.08205, 1.704, 1.0, 6.727e-5, 103.2},
                             {11.61, 5.36e4, 1.111e6}, 0.05253, 3.859e10);
  model.lambda = 676.7;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.metrics.friction_max == Approx(0.1718 + 1.207 + 0.6255));
  CHECK(cycle.metrics.slip_rate_mean == Approx(0.05253).epsilon(1e-6));
}

TEST_CASE("warmth that a slow drive hardly brings is measured relative to itself", "[cycle]") {
  // In stick it decays within 1e-3 of its duration. Measured by the speed of the law's curve, 1e5 of the drive's, the
  // rest of one long step was as good as nothing, at any tolerance, and held back the next slip by 1e-6 of the period.
  Model model;
  model.law = laws::find_law("thermal");
  model.lambda = 0.00022742250282415478;
  model.slider = {.mass = 0.00014409534320214445, .stiffness = 33189.36474331416, .damping = 0};
  model.drive = {.speed = 1.9031971397062264e-07, .normal_load = 0.024382164569351231, .force = 0.0};
  double before = 0;
  for (const double tolerance : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
    INFO("tolerance " << tolerance);
    const cycles::Cycle cycle = cycles::find_cycle(model, {.tolerance = tolerance, .multipliers = false});
    REQUIRE(cycle.outcome.complete());
    const double fraction = cycle.metrics.stick_fraction;
    if (before > 0) CHECK(std::abs(fraction - before) < 10 * tolerance);
    CHECK(std::abs(fraction - 0.4150668566) <= cycle.error.stick_fraction + 5e-10);
    before = fraction;
  }
}

TEST_CASE("the period is known within the error of the temperature that ends its stick", "[cycle][long]") {
  // The contact's temperature is known to 4e-9 and friction falls by 0.6 % of itself, so that the period is to 2e-7.
  auto model = slider_under("thermal", {0.35, 0.4, 0.01, 0.45, 0.1, 5e-7, 0.001, 0.008, 1.0, 1.0},
                            {0.000569151, 3.77351e6, 30.4797}, 0.00505213, 915500.0);
  model.lambda = 16806.3;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-5, .multipliers = false}),
             tight = cycles::find_cycle(model, {.tolerance = 1e-9, .multipliers = false});
  REQUIRE(loose.outcome.complete());
  REQUIRE(tight.outcome.complete());
  check_agreement(loose, tight,
                  {&cycles::Metrics::period, &cycles::Metrics::slip_rate_max, &cycles::Metrics::friction_mean});
}

TEST_CASE("decay of a state at rest is resolved, and with it the onset of slip", "[cycle]") {
  // The heat of slip decays by exp(-5.8) in a stick that one step takes, the same at tolerances from 2e-6 to 2e-9.
  auto model = slider_under(
      "thermal",
      {0.93084046621248262, 0.13948298149598148, 0.11210638802823165, 0.36839282340463181, 0.060295496625375471,
       1.8575978438167449e-10, 0.1272717609167266, 2.0904623934599618e-06, 1.0, 30.185415522677101},
      {2.7509047313101454e-14, 3942.3413034603705, 1.2577590538600791}, 0.00021529231376632042, 0.17160021956701227);
  model.lambda = 7.1117878336439553;
  const auto tight = cycles::find_cycle(model, {.tolerance = 1e-9, .multipliers = false});
  REQUIRE(tight.metrics.period > 0);
  for (const double tolerance : {1e-5, 1e-6, 1e-7, 1e-8}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance, .multipliers = false});
    REQUIRE(cycle.outcome.complete());
    check_agreement(cycle, tight,
                    {&cycles::Metrics::period, &cycles::Metrics::stick_fraction, &cycles::Metrics::friction_mean});
  }
}

TEST_CASE("heat that adds up by 5e-10 per period is extrapolated to its end", "[cycle]") {
  // Each period adds 5e-10 to a temperature that begins with nothing: changes differ by rounding alone.
  auto model =
      slider_under("thermal", {0.1772, 0.2661, 1.472e-6, 0.1436, 52.49, 0.005798, 0.002523, 2.2e-7, 1.0, 1.331},
                   {8.392e4, 1.537e5, 0}, 1.897e-5, 304.8);
  model.lambda = 7.849e4;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             tight = cycles::find_cycle(model, {.tolerance = 1e-8});
  REQUIRE(loose.outcome.complete());
  REQUIRE(tight.outcome.complete());
  CHECK(loose.metrics.slip_rate_mean == Approx(model.drive.speed.level()).epsilon(1e-6));
  check_agreement(loose, tight, {&cycles::Metrics::period});
}

TEST_CASE("extrapolation brings layers that warm up over thousands of periods to their cycle", "[cycle]") {
  Model model = slider_under("thermal-disc",
                             {0.9076, 0.1273, 0.004952, 0.3429, 0.4347, 0.002906, 0.0009944, 0.001713, 1.0, 0.0, 1.134},
                             {0.0007277, 6.097e6, 0}, 2.124e-6, 0.002186);
  model.lambda = 24.37;
  model.drive.force = -0.01649;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.stable);
  CHECK(std::abs(cycle.multipliers.front()) > 0.9999);  // 1e4 periods and more to forget a start
  CHECK(cycle.cost.steps < 100'000);
  // Friction so weak hardly moves the slider: in and out of rest it oscillates at its own frequency.
  const double period = 2 * std::numbers::pi * std::sqrt(model.slider.mass / model.slider.stiffness);
  CHECK(cycle.metrics.period == Approx(period).epsilon(2e-3));
}
