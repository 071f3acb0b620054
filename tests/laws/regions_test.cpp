/// Friction by regions: continuous at their borders, and periods that others computed.
#include "laws/regions.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis;

namespace {

oscillators::Model block_on_belt(double width, double speed) {
  oscillators::Model model;
  model.law = laws::by_regions(laws::preset(*laws::find_law("hyperbolic"), "leine"), width);
  model.slider = {.mass = 1, .stiffness = 1, .damping = 0};
  model.drive = {.speed = speed, .normal_load = 1.0, .force = 0.0};
  return model;
}

}  // namespace

TEST_CASE("friction by regions has no jump at a border", "[laws][smoothing]") {
  constexpr double width = 1e-2, limit = 1.5, aside = 1e-12;
  const auto friction = [&](double v, double holding) {
    return laws::region_friction(v, width, std::copysign(limit, v), holding).force;
  };
  for (const double holding : {-3.0, -1.4, -0.2, 0.0, 0.7, 1.4, 2.5})
    for (const double v : {-width, 0.0, width})
      CHECK(std::abs(friction(v + aside * width, holding) - friction(v - aside * width, holding)) < 1e-10);
  for (const double v : {-0.9 * width, -0.1 * width, 0.3 * width, 0.8 * width})
    for (const double holding : {-limit, limit})
      CHECK(std::abs(friction(v, holding * (1 + aside)) - friction(v, holding * (1 - aside))) < 1e-10);
  CHECK(friction(0, 0.7) == 0.7);  // what would hold holds
  CHECK(friction(1.1 * width, 0.7) == limit);
}

TEST_CASE("periods of a block under friction by regions are those of others", "[laws][smoothing]") {
  // Runge and Kutta's method of order 7(8) with events at the borders, which two step controls agree on to 1e-9.
  struct Row {
    double width, speed, period, accuracy;
  };
  for (const auto& [width, speed, period, accuracy] :
       {Row{1e-2, 0.2, 12.15631777, 6e-9}, Row{1e-3, 0.2, 12.02425646, 6e-9}, Row{1e-4, 0.2, 12.00374232, 1e-8},
        Row{1e-2, 0.1, 18.131572069, 2e-9}, Row{1e-3, 0.1, 17.913268027, 2e-9}}) {
    motion::StructureModel model{oscillators::one_slider(block_on_belt(width, speed)), {}};
    model.start.kind = motion::Start::Kind::rest;
    const auto cycle = cycles::find_cycle(model, {});
    CAPTURE(width, speed);
    REQUIRE(cycle.outcome.complete());
    CHECK(std::abs(cycle.metrics.at("period").value - period) < accuracy + cycle.metrics.at("period").error);
  }
}

TEST_CASE("a block at rest under a steady force stays where it is", "[laws][smoothing]") {
  auto model = block_on_belt(1e-2, 0);
  model.drive.force = 0.8;
  motion::StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = motion::Start::Kind::rest;
  motion::RunOptions options;
  options.duration = 1000, options.samples = 5;
  const auto run = motion::run_structure(structure, options);
  REQUIRE(run.outcome.complete());
  CHECK(std::abs(run.columns[0].back()) < 1e-12);
}

TEST_CASE("friction by regions is refused where no force is known that would hold", "[laws][smoothing]") {
  CHECK_THROWS_WITH(laws::by_regions(laws::find_law("ageing"), 1e-3), Catch::Contains("takes set-valued laws"));
  auto structure = oscillators::one_slider(block_on_belt(1e-3, 0.2));
  structure.contacts.push_back(structure.contacts.front());
  CHECK_THROWS_WITH(structure.check(), Catch::Contains("the contact alone acts along its coordinate"));
}
