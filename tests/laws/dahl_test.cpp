/// Dahl: force against displacement in closed form, and its independence of speed.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/motion/run.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("dahl: force yields exponentially with displacement, at any speed", "[laws][dahl]") {
  // dmu/dx = sigma0 (1 - mu/mu_d sgn v): mu = mu_d (1 - exp(-sigma0 x/mu_d)) from rest, whatever the speed.
  const auto law = laws::find_law("dahl");
  for (const double v : {1e-6, 1e-2})
    for (const double x : {1e-7, 3e-6, 2e-5}) {
      const double mu = 0.3 * (1 - std::exp(-1e5 * x / 0.3)), z = mu / 1e5;
      CHECK(1e5 * law->rate({v, 1}, std::vector{z})[0] / v == Approx(1e5 * (1 - mu / 0.3)).epsilon(1e-9).margin(1e-6));
    }
}

TEST_CASE("dahl: a slider pulled from rest follows the force-displacement curve", "[laws][dahl]") {
  // The contact's force at the end is that of the displacement between slider and drive, slipped in one direction.
  oscillators::Model model;
  model.law = laws::find_law("dahl")->with("sigma0", 100.0);
  model.slider = {.mass = 0.01, .stiffness = 100, .damping = 10};  // overdamped: slip never reverses
  model.drive = {1e-3, 2.0, 0.0};
  analysis::motion::RunOptions options;
  options.duration = 10;
  options.samples = 20;
  options.start.kind = analysis::motion::Start::Kind::rest;
  const auto run = analysis::motion::run(model, options);
  REQUIRE(run.outcome.complete());
  for (std::size_t i = 0; i < run.time.size(); ++i) {
    const double slipped = 1e-3 * run.time[i] - run.columns[0][i];
    CHECK(run.columns[4][i] == Approx(0.3 * (1 - std::exp(-100 * slipped / 0.3))).epsilon(1e-7).margin(1e-9));
  }
}
