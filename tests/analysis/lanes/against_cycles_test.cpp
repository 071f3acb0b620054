/// Lanes against single cycles: stick, rounding error, coexistence and healing.
#include <catch2/catch.hpp>
#include <cmath>
#include <span>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lanes/cycle_lanes.hpp"
#include "tests/analysis/agreement.hpp"
#include "tests/analysis/healing_at_rest.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::check_agreement;
using rosin::tests::healing_at_rest;
using rosin::tests::slider_under;

TEST_CASE("slip at 1e13 times the drive's speed comes to rest in lanes, not beyond it", "[cycle-lanes]") {
  // Rounding error of the slip rate is a thousandth of the drive's speed, and must not be taken for slip backwards.
  auto model = slider_under(
      "thermal",
      {0.721416, 0.399381, 0.00215767, 0.315043, 0.0332599, 1.03297e-7, 0.00338496, 0.0156718, 1.0, 0.146846},
      {3.14185e-5, 0.038854, 0}, 8.05888e-8, 2097.48);
  model.drive.force = -10.3515;
  const auto lanes = lanes::find_cycles(std::span(&model, 1), {1e-6, 0.1, {"slip_rate_min", "slip_rate_max"}})[0];
  REQUIRE(lanes.found);
  CHECK(lanes.metrics.slip_rate_min == 0);
  const auto alone = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(alone.outcome.complete());
  CHECK(std::abs(lanes.metrics.slip_rate_max - alone.metrics.slip_rate_max) < lanes.error.slip_rate_max);
}

TEST_CASE("lanes do not take a cycle that repels by 1e-3 per period for the one that attracts", "[cycle-lanes]") {
  Model model =
      slider_under("flash-heating", {1.08869, 0.00850946, 0.0394552, 4.5991e-6, 2.41202e-6, 0.116437, 0.0466556},
                   {3.43103e11, 13509.1, 19994.9}, 1.43428e-9, 0.000948619);
  model.lambda = 0.227068;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-8});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.stable);
  lanes::LaneCycleOptions options;
  options.metrics = {"slip_rate_max"};
  const auto lane = lanes::find_cycles(std::span(&model, 1), options).front();
  if (lane.found) check_agreement(lane, cycle, {&cycles::Metrics::slip_rate_max});
}

TEST_CASE("lanes follow slip that the load brings back from stick", "[cycle-lanes]") {
  // Steps of an hour raise the slip rate from 1e-15 to 1e-6 of the drive's speed at once.
  auto model = slider_under("flash-heating", {0.9808, 0.007369, 0.05385, 2.434e-5, 0.04527, 0.08658, 0.1165},
                            {5.229e7, 2.205e6, 0}, 3.281e-5, 1.924e6);
  model.lambda = 368.5;
  const auto truth = cycles::find_cycle(model, {.tolerance = 1e-9, .multipliers = false});
  for (const double tolerance : {1e-5, 1e-6, 1e-7}) {
    const auto lanes = lanes::find_cycles(std::span(&model, 1), {tolerance, 0.1, {"stick_fraction_001"}});
    REQUIRE(lanes.front().found);
    CHECK(lanes.front().tries < 6000);
    check_agreement(lanes.front(), truth, {&cycles::Metrics::stick_fraction_001, &cycles::Metrics::period});
  }
}

TEST_CASE("lanes sum the loop of heated contacts, whose steady curve bends at rest, to the tolerance",
          "[cycle-lanes]") {
  const auto model =
      slider_under("thermal", {0.7466, 0.1467, 0.01865, 0.1861, 0.06399, 3.28e-7, 0.0001132, 0.00354, 0.5451, 0.1924},
                   {0.2161, 1673.0, 0.008468}, 0.003504, 233.1);
  const auto sure = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(sure.outcome.complete());
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    const auto lane = lanes::find_cycles(std::span(&model, 1), {tolerance, 0.1, {"loop_area"}}).front();
    REQUIRE(lane.found);
    check_agreement(lane, sure, {&cycles::Metrics::loop_area});
  }
}

TEST_CASE("lanes take no neutral oscillation for attracted, however much its states change", "[cycle-lanes]") {
  // Friction of 1e-15 of the spring's force: the slip that began the oscillation made its amplitude. The state, 30
  // decades from that of steady sliding, is forgotten in a period.
  auto model = slider_under("spinodal", {0.2933, 0.02059, 0.1363, 1e-10, 8.868e-11, 2.973e-8, 5.917},
                            {13.11, 1.547e6, 0}, 3.577e-12, 1.65);
  model.lambda = 170.6;
  const auto found = lanes::find_cycles(std::span(&model, 1), lanes::every_metric());
  CHECK(!found.front().found);
}

TEST_CASE("lanes follow healing in the moment of a reversal", "[cycle-lanes]") {
  const auto model = healing_at_rest();
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-9, .multipliers = false});
  const auto lane = lanes::find_cycles(std::span(&model, 1), lanes::every_metric()).front();
  REQUIRE(cycle.outcome.complete());
  REQUIRE(lane.found);
  check_agreement(lane, cycle);
}

TEST_CASE("a cycle asked alone is a lane's where that is enough, and has the metrics of collocation", "[cycle-lanes]") {
  // Weak friction, the middle of the plane, long stick.
  const auto [load, lambda] = GENERATE(std::pair(1e-8, 0.04), std::pair(1e-4, 10.0), std::pair(0.1, 0.01));
  const auto model = tests::bristol_board(load, lambda);
  const auto truth = cycles::find_cycle(model, {.tolerance = 1e-10});
  REQUIRE(truth.outcome.complete());
  for (const double tolerance : {1e-3, 1e-6}) {
    const auto alone = lanes::find_cycle(model, lanes::every_metric(tolerance));
    REQUIRE(alone.outcome.complete());
    CHECK(alone.orbit.empty());
    CHECK(alone.stable);
    CHECK(alone.section_displacement == Approx(truth.section_displacement).epsilon(10 * tolerance));
    CHECK(alone.cost.steps < (tolerance == 1e-3 ? 4000 : 9000));
    check_agreement(alone, truth);
  }
  CHECK(lanes::find_cycle(model, lanes::every_metric(1e-9)).orbit.size() > 0);  // beyond a lane
}

TEST_CASE("what is asked alone and no lane serves is answered all the same", "[cycle-lanes]") {
  auto massless = tests::bristol_board(1e-4, 10);
  massless.slider.mass = 0;
  massless.slider.damping = 1;
  auto backwards = tests::bristol_board(1e-4, 10);
  backwards.drive.speed = -1e-5;
  for (const auto& model : {massless, backwards}) {
    const auto alone = lanes::find_cycle(model, lanes::every_metric()), truth = cycles::find_cycle(model);
    REQUIRE(alone.outcome.ending == truth.outcome.ending);
    if (truth.outcome.complete()) check_agreement(alone, truth);
  }
  const auto stable = lanes::find_cycle(tests::bristol_board(1e-6, 90), lanes::every_metric());
  CHECK(stable.outcome.ending == Ending::none_exists);
  CHECK_THROWS_AS(lanes::find_cycle(massless, {1e-6, 0.1, {"stick_fracton"}}), InputError);
}
