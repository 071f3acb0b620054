/// Periodic motion of bowed strings, against Helmholtz motion in closed form.
#include "analysis/strings/string_cycle.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/strings/plane.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::strings;
using Catch::Matchers::Contains;

namespace {

/// The string of Raman's model, of whole delays and without losses.
BowedStringModel raman(double load) {
  BowedStringModel model;
  auto& string = model.string;
  string.sample_rate = 1e5;
  string.frequency = string.sample_rate / 500;
  string.bow_position = 0.1;
  string.quality = oscillators::BowedString::none;
  string.corner_rounding = 0;
  string.torsion.reset();
  string.delays = oscillators::DelayLine::integer;
  model.law = laws::find_law("two-exponential");
  model.speed.signal = Signal(0.1);
  model.load.signal = Signal(load);
  model.start = oscillators::StringStart::helmholtz;
  return model;
}

}  // namespace

TEST_CASE("Helmholtz motion has the period of the string, and slips for a part beta of it", "[string]") {
  const double V = 0.1;
  const auto model = raman(0.8);
  const double T = model.string.period(), beta = model.string.bow_position;
  const auto cycle = string_cycles(std::span(&model, 1), 60, {}, 1).front();
  INFO(cycle.outcome.detail);
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.regime == StringRegime::helmholtz);
  const auto within = [](const StringPeriod::Measure& measure, double wanted, double most) {
    CHECK(std::abs(measure.value - wanted) <= measure.error + 1e-9 * std::abs(wanted));
    CHECK(measure.error <= most * std::abs(wanted));
  };
  within(cycle.period.period, T, 1e-9);
  within(cycle.period.slips, 1, 1e-9);
  within(cycle.period.stick_fraction, 1 - beta, 5e-3);
  within(cycle.period.slip_distance, V * T, 5e-2);
  within(cycle.period.bridge_force, 2 * model.string.impedance * V / beta, 5e-2);
}

TEST_CASE("a string keeps the motion that it has while the bow's force goes up and down", "[string]") {
  // 0.14 N lies between Schelleng's limits of 0.02 and 0.72 N, where Helmholtz motion lasts if it is there; from rest
  // the string comes to two slips a period, and to one only under more.
  BowedStringModel model;
  model.string.bridge_resistance = 55;
  model.law = laws::find_law("two-exponential");
  model.speed.signal = Signal(0.05);
  model.load.signal = Signal(0.14);
  const auto limits = schelleng_limits(model, 0.05);
  CHECK(limits.least < 0.14);
  CHECK(limits.most > 0.35);
  const std::vector<double> ways[] = {{0.14, 0.35, 0.14}, {0.35, 0.35, 0.35}};
  const auto cycles = string_cycles_along(model, &BowedStringModel::load, ways, 80, {});
  CHECK(cycles[0][0].regime == StringRegime::double_slip);
  CHECK(cycles[0][1].regime == StringRegime::helmholtz);
  CHECK(cycles[0][2].regime == StringRegime::helmholtz);
  REQUIRE(cycles[0][2].outcome.complete());
  CHECK(cycles[0][2].period.bridge_force.value > 1.4 * cycles[0][0].period.bridge_force.value);
  // A bow that changes nothing goes on as one that is not asked in between: the first stage is a string by itself.
  const auto alone = string_cycles(std::span(&model, 1), 80, {}, 1).front();
  CHECK(cycles[0][0].period.bridge_force.value == alone.period.bridge_force.value);
  CHECK(cycles[0][0].period.period.value == alone.period.period.value);
  for (int k : {0, 1, 2})
    CHECK(cycles[1][k].period.period.value == Approx(cycles[1][0].period.period.value).epsilon(2e-3));
}

TEST_CASE("motions that do not repeat themselves, and bows that change, have no period", "[string]") {
  auto sliding = raman(1e-3);
  sliding.start = oscillators::StringStart::rest;
  sliding.string.quality = 20;
  const auto none = string_cycles(std::span(&sliding, 1), 60, {}, 1).front();
  CHECK(none.outcome.ending == Ending::none_exists);
  CHECK(std::isnan(none.period.period.value));
  auto changing = raman(0.8);
  changing.speed.signal = {};
  changing.speed.approach = {0, 0.1, 0.01};
  CHECK_THROWS_WITH(string_cycles(std::span(&changing, 1), 60, {}, 1), Contains("drive.speed"));
}
