/// Extrapolation and refinement of the return map where its derivative is weak, steep or all rounding error.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/cycle.hpp"
#include "tests/analysis/agreement.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::tests::check_agreement;
using rosin::tests::slider_under;

TEST_CASE("a cycle that the budget does not let refine keeps its errors", "[cycle]") {
  auto model = slider_under("kato-tullis", {0.6, 0.01, 0.015, 1e-5, 1e-6, 1e-8}, {1.396, 0.002097, 0.07223}, 6.169e-12,
                            0.001117);
  model.lambda = 1330.0;
  model.contact_stiffness.tangential = 0.0009398;
  model.contact_stiffness.damping = 11.68;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(cycle.metrics.period > 0);
  CHECK(cycle.error.period < 1e-6 * cycle.metrics.period);
  if (!cycle.outcome.complete()) CHECK(cycle.outcome.ending == Ending::tolerance_not_met);
}

TEST_CASE("a derivative that is all rounding error does not lead the refinement away", "[cycle]") {
  auto model =
      slider_under("flash-heating", {0.7, 0.016, 0.02, 2e-5, 1e-6, 0.13, 0.17}, {0.00241, 0.01878, 0}, 0.02085, 60.39);
  model.lambda = 2354.0;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.outcome.complete());
  check_agreement(loose, fine, {&cycles::Metrics::period});
  CHECK(loose.stable);
}

TEST_CASE("a refinement that scatters by rounding error keeps its derivative", "[cycle]") {
  // A return forgets 3e-5 of its start: its change does not tell how far the cycle is.
  auto model =
      slider_under("prz", {1.254, 0.004262, 0.01483, 2.122e-8, 0.0002131}, {6.559e6, 3.661e5, 0}, 0.4957, 0.06267);
  model.lambda = 3.613e5;
  model.drive.force = 0.001892;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  CHECK(fine.error.friction_mean < 1e-8);
  check_agreement(loose, fine);
}

TEST_CASE("a derivative taken again in rounding error does not replace one that attracts", "[cycle]") {
  const auto model = slider_under("flash-heating", {0.7, 0.016, 0.02, 2e-5, 1e-6, 0.13, 0.17},
                                  {0.85314, 3.4683e6, 2.1675e8}, 0.0038371, 3.9205e10);
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.outcome.complete());
  check_agreement(loose, fine, {&cycles::Metrics::period});
  CHECK(loose.error.period < 1e-6 * loose.metrics.period);
}

TEST_CASE("slips that amplify the errors of steps are searched for cycles at a tighter tolerance", "[cycle][long]") {
  auto model = slider_under("lugre", {9.747e7, 190.8, 0.1149, 5.686, 0.00433, 0.001016}, {8.945e-6, 0.3487, 0},
                            0.0009806, 0.001144);
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-7});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.outcome.complete());
  check_agreement(loose, fine, {&cycles::Metrics::period, &cycles::Metrics::loop_area});
}

TEST_CASE("slips that extrapolation brings to their cycle are of one kind", "[cycle][long]") {
  auto model = slider_under("thermal-disc", {0.35, 0.4, 0.01, 0.45, 0.1, 0.001, 0.001, 0.008, 1.0, 0.0, 1.0},
                            {1.37e-12, 2.9e5, 1.49e-5}, 0.000184, 0.00653);
  model.lambda = 0.000413;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6, .multipliers = false});
  REQUIRE(loose.outcome.complete());
  const auto tight = cycles::find_cycle(model, {.tolerance = 1e-7, .multipliers = false});
  REQUIRE(tight.outcome.complete());
  check_agreement(loose, tight, {&cycles::Metrics::period});
}

TEST_CASE("a cycle that attracts by 1e-4 per period is known within the distance that periods leave", "[cycle]") {
  // A return forgets 1.4e-4 of its start, and near the cycle its derivative leads astray.
  auto model = slider_under("nagata",
                            {0.91450116723011265, 0.10441709552557386, 0.16769210153783226, 0.018078792317291092,
                             1.8241963678963656e-11, 0.70911948747994413},
                            {0.0024979418265944869, 2408.8429288165016, 0.021842935281251641}, 7.7446440075672582e-09,
                            0.56049674929720084);
  model.lambda = 1;
  model.contact_stiffness.tangential = 1.1483358888960824;
  model.contact_stiffness.damping = 7.8581543726552604e-05;
  model.drive.force = Signal(-0.00090387140240405517);
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             tight = cycles::find_cycle(model, {.tolerance = 1e-9});
  check_agreement(loose, tight);
}

TEST_CASE("a point that extrapolation brings near its cycle is taken for it", "[cycle]") {
  // Slips at 3e9 V of a slider without mass; and oscillations at 36 V.
  auto relaxing = slider_under("ageing", {0.202013, 0.0171813, 0.0288953, 1.0015e-5, 0.000505467}, {0, 89.9913, 0},
                               1.11792e-5, 3.30773e-6);
  relaxing.lambda = 4.25927e-5;
  auto swinging = slider_under("two-state-ageing", {0.6, 0.01, 0.009, 2e-6, 0.006, 4e-5, 1e-6},
                               {0.0006519, 5.96595e6, 0}, 0.0497139, 4640.73);
  swinging.lambda = 0.138708;
  // Slip passes v = V four times in a period; a neighbouring motion may pass once more.
  auto recoiling = slider_under("slip", {0.852243, 0.00605959, 0.0227661, 5.73324e-9, 2.4211e-6},
                                {0, 24.235, 3.08171e-7}, 1.27484e-5, 0.155875);
  recoiling.lambda = 4.44677e-6;
  recoiling.contact_stiffness.tangential = 4.55007;
  recoiling.contact_stiffness.damping = 0.000396213;
  for (const auto& model : {relaxing, swinging, recoiling}) {
    const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
               tight = cycles::find_cycle(model, {.tolerance = 1e-9});
    REQUIRE(loose.outcome.complete());
    REQUIRE(tight.metrics.period > 0);
    CHECK(loose.stable);
    CHECK(std::abs(loose.metrics.slip_rate_mean - model.drive.speed.level()) <= loose.error.slip_rate_mean);
    check_agreement(loose, tight,
                    {&cycles::Metrics::period, &cycles::Metrics::slip_rate_max, &cycles::Metrics::friction_mean});
  }
}
