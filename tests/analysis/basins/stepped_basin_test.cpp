/// Basins of a slider in the plane: by steps, each start followed to the end of its motion.
#include <catch2/catch.hpp>

#include "analysis/basins/basin.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::basins;

TEST_CASE("a plane slider under a small force stays where it is put within the limit of friction, or is moved",
          "[plane]") {
  // Rest needs |k x| + |f| ≤ μ N = 8: within 0.015 of the middle under 2 N on springs of 400 N/m.
  motion::PlaneModel model;
  const Signal force(Signal::Harmonics{0, {{2, 10, 0}}});
  model.mass = {3, {400, 400}, {2, 2}, 0.4, 0.4, {0, 0}, 20, {force, Signal(0.0)}};
  const auto oscillator = motion::stepped(model);
  REQUIRE(oscillator.starts[0].name == "displacement_x");
  BasinTask task;
  for (const double x : {0.0, 0.014, 0.016, 0.2})
    task.starts.push_back(oscillator.start_at(std::vector<std::optional<double>>{x, {}, {}, {}}));
  const auto found = find_basins(oscillator, task);
  REQUIRE(found.outcome.complete());
  // Whatever moves comes to rest within the limit, from just outside by slips that grow ever smaller: a force below it
  // moves nothing for good.
  REQUIRE(found.basins.size() == 1);
  CHECK(found.basins[0].attractor.kind == Attractor::Kind::rest);
  CHECK(found.basins[0].share == 1);
  CHECK(found.labels == std::vector<int>{0, 0, 0, 0});

  model.mass.force[0] = Signal(Signal::Harmonics{0, {{12, 10, 0}}});
  const auto moved = motion::stepped(model);
  const auto cycles = find_basins(moved, task);
  REQUIRE(cycles.basins.size() == 1);
  CHECK(cycles.basins[0].attractor.kind == Attractor::Kind::cycle);
  CHECK(cycles.basins[0].attractor.metrics.at("period").value == Approx(2 * 3.14159265358979 / 10));
  CHECK(cycles.basins[0].attractor.metrics.at("period").error < 1e-6);
}
