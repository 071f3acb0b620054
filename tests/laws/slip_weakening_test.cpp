/// Slip weakening: one onset at the static coefficient, and dynamic friction for good after it.
#include <catch2/catch.hpp>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("slip-weakening: the first slip spends the strength", "[laws][slip-weakening]") {
  oscillators::Model model;
  model.law = laws::find_law("slip-weakening")->with("d_c", 1e-3);
  model.slider = {.mass = 1, .stiffness = 1, .damping = 1};
  model.drive = {0.01, 2.0, 0.0};
  analysis::motion::RunOptions options;
  options.duration = 200;
  options.samples = 20;
  options.start.kind = analysis::motion::Start::Kind::rest;
  const auto run = analysis::motion::run(model, options);
  REQUIRE(run.outcome.complete());
  REQUIRE(!run.events.empty());
  CHECK(run.events[0].kind == "slip");
  CHECK(run.events[0].time == Approx((0.4 * 2 - 0.01) / 0.01).epsilon(1e-10));  // k V t + c V = mu_s N
  CHECK(run.columns[4].front() == Approx(0.005));  // at rest on the drive the damper alone pulls: c V/N
  CHECK(run.columns[4].back() == Approx(0.3).epsilon(1e-9));
  CHECK(run.columns[5].back() == Approx(2e-3).epsilon(1e-6));

  CHECK(analysis::cycles::find_cycle(model).outcome.ending == Ending::none_exists);

  // A contact that stopped within d_c holds what its slip has left of the strength, on either side.
  const auto& law = *model.law;
  CHECK(law.static_limit(2, std::vector{4e-4}) == Approx(0.36));
  CHECK(law.after_stop(std::vector{4e-4}) == std::vector{4e-4});
  CHECK(law.friction({-1, 2}, std::vector{4e-4}) == Approx(-0.36));
}
