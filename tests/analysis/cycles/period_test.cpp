/// One period of several slips, of slip and ringing, or of a slider whose mass hardly counts.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/return_map.hpp"
#include "analysis/motion/run.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::slider_under;

TEST_CASE("slips that are long and short in alternation are one period together", "[cycle]") {
  Model model = slider_under("loading-rate", {2.90006, 0.213815, 0.0238988, 0.151722}, {0.92819, 0.0197213, 0},
                             0.0111913, 0.018693);
  model.lambda = 20.5359;
  model.drive.force = -0.0025138;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.stable);
  motion::RunOptions options;
  options.duration = 4000;
  options.start.kind = motion::Start::Kind::rest;
  const auto history = motion::run(model, options);
  std::vector<double> onsets;
  for (const auto& event : history.events)
    if (event.kind == "slip") onsets.push_back(event.time);
  REQUIRE(onsets.size() > 20);
  const auto last = onsets.end() - 1;
  CHECK(std::abs((last[0] - last[-1]) / (last[-1] - last[-2]) - 1) > 0.01);
  CHECK(last[0] - last[-2] == Approx(cycle.metrics.period).epsilon(1e-5));
}

TEST_CASE("ringing that decays until slip sticks is one period with the stick", "[cycle][long]") {
  Model model = slider_under("nagata", {0.230584, 0.0350439, 0.107343, 0.941433, 2.64271e-5, 1.43995},
                             {1e12, 45639.2, 0}, 4.77799e-10, 394443.0);
  model.lambda = 0.0528484;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.stable);
  // A history shows a slip, of a million seconds, where the spring relaxes between two samples.
  motion::RunOptions options;
  options.start.kind = motion::Start::Kind::rest;
  options.duration = 4.5 * cycle.metrics.period;
  options.samples = 9000;
  options.tolerance = 1e-6;
  const auto history = motion::run(model, options);
  const auto& x = history.columns[0];
  const double highest = *std::max_element(x.begin(), x.end());
  std::vector<double> slips;
  for (std::size_t i = 1; i < x.size(); ++i)
    if (x[i] < x[i - 1] - 0.2 * highest) slips.push_back(history.time[i]);
  REQUIRE(slips.size() > 3);
  CHECK(slips.back() - slips[slips.size() - 2] == Approx(cycle.metrics.period).epsilon(2e-3));
}

TEST_CASE("a period that was taken twice is halved at every tolerance", "[cycle][long]") {
  const auto ringing = slider_under("two-state-slip", {0.6, 0.01, 0.009, 2e-6, 0.006, 4e-5, 1e-6},
                                    {0.000712276, 1.80965, 0}, 1.31257e-6, 0.0118167);
  auto on_a_spring =
      slider_under("bowden-tabor", {0.973961, 0.0538642, 0.0933284, 1.62811e-7, 4.30437e-6, 0.00195118, 641.635},
                   {22.4456, 4.91149e6, 0}, 0.129451, 9940.56);
  on_a_spring.lambda = 0.0725197;
  on_a_spring.contact_stiffness.per_load = 66319.7;
  for (const auto& model : {ringing, on_a_spring}) {
    const double period = cycles::find_cycle(model, {.tolerance = 1e-8}).metrics.period;
    REQUIRE(period > 0);
    for (const double tolerance : {1e-6, 1e-7, 1e-9})
      CHECK(cycles::find_cycle(model, {.tolerance = tolerance}).metrics.period == Approx(period).epsilon(1e-7));
  }
}

TEST_CASE("a cycle that sticks and rings is found where periods return to it", "[cycle]") {
  // A slip at 10¹⁴ of the drive's speed, and an oscillation of ringing after it, in each period: derivatives along the
  // motion are all rounding, and those across it are known.
  auto model = slider_under("ageing", {1.455, 0.004217, 0.04052, 3.119e-6, 6.515e-6}, {4.278e-11, 0.002424, 1.595e-8},
                            5.146e-7, 18.14);
  model.lambda = 0.0004601;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  CHECK(cycle.stable);
  REQUIRE(!cycle.multipliers.empty());
  CHECK(std::abs(cycle.multipliers.front()) < 0.5);  // or it would not have been brought back
  cycles::ReturnMap map(model);
  auto y = map.stick(model.drive.speed.level());
  double slip = 0, stick = 0;
  for (int k = 0; k < 10; ++k) {
    const auto period = map.follow(y, 1e-9, 1, k > 0);
    REQUIRE(period.outcome.complete());
    y = period.end;
    slip = stick, stick = period.duration;
  }
  CHECK(std::abs(slip + stick - cycle.metrics.period) <= cycle.error.period);
  CHECK(cycle.error.period < 1e-3 * cycle.metrics.period);
}

TEST_CASE("oscillations that the steps of a cycle pass over are in its errors", "[cycle][long]") {
  // After each slip the slider rings 9000 times on the contact's spring by 6e-6 of the drive's speed, which steps at
  // 1e-6 damp. Followed, at 1e-9, the highest slip rate is this.
  auto model =
      slider_under("spinodal", {0.369, 0.0349, 0.0489, 9e-7, 1e-6, 0.001, 90.0},
                   {49558.422170782775, 0.0019034295765088254, 0}, 1.1161395570247673e-07, 7.127200594067653e-11);
  model.lambda = 1;
  model.contact_stiffness.per_load = 0.0031585467498261763;
  model.contact_stiffness.damping_per_load = 2.077412518398718;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6, .multipliers = false});
  REQUIRE(cycle.metrics.period > 0);
  const double off = std::abs(cycle.metrics.slip_rate_max - 1.11614323588e-07);
  CHECK(off <= cycle.error.slip_rate_max);
  CHECK(cycle.error.slip_rate_max < 1e-5 * cycle.metrics.slip_rate_max);
}

TEST_CASE("ringing that has not settled is no period", "[cycle][long]") {
  // Bristles ring through a stick of 1.3e5 s; some tolerances lead to the period, others into the ringing.
  auto model = slider_under("lugre-unscaled",
                            {87003.063654146448, 48.93714158799623, 0.056977483195458402, 2.6970777677349216,
                             2.6006464118931034, 0.0025318565129216655},
                            {17.521398449556834, 0.41052201123182408, 0}, 2.8895594693799769e-05, 8.0256716221472217);
  model.lambda = 0.099251069469069739;
  model.drive.force = -9.9024557879678277;
  for (const double tolerance : {1e-5, 1e-6}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance, .multipliers = false});
    CHECK(cycle.error.period <= 0.1 * cycle.metrics.period);
    if (cycle.outcome.complete())
      CHECK(cycle.metrics.period == Approx(128373.971).epsilon(1e-5));
    else
      CHECK(cycle.metrics.period == 0);
  }
}

TEST_CASE("a slider so damped that its mass hardly counts moves as one without", "[cycle]") {
  // The inertia is a rounding error of the force balance: at v = V the derivative of the return map was not finite,
  // or had multipliers at random.
  for (const double stiffness : {1900.0, 2027.8}) {
    INFO("stiffness " << stiffness << ", the Hopf point is at 2028.1");
    const auto cycle_with = [&](double mass) {
      return cycles::find_cycle(slider_under("ageing", {0.40972, 0.0043016, 0.0059392, 3.4967e-6, 5.9856e-7},
                                             {mass, stiffness, 14575.0}, 5.8853e-11, 4.3305),
                                {.tolerance = 1e-7});
    };
    const auto heavy = cycle_with(0.0033754), light = cycle_with(0);
    REQUIRE(heavy.outcome.complete());
    REQUIRE(light.outcome.complete());
    CHECK(heavy.stable);
    CHECK(heavy.metrics.period == Approx(light.metrics.period).epsilon(1e-7));
    CHECK(heavy.metrics.slip_rate_max == Approx(light.metrics.slip_rate_max).epsilon(1e-7));
    CHECK(heavy.metrics.loop_area == Approx(light.metrics.loop_area).epsilon(1e-6));
    REQUIRE(!heavy.multipliers.empty());
    CHECK(std::abs(heavy.multipliers.front()) ==
          Approx(std::abs(light.multipliers.front())).epsilon(1e-6).margin(1e-6));
  }
}
