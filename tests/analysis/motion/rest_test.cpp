/// Slip that touches or passes rest in a run, and laws without a continuous way through it.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "analysis/motion/motion_end.hpp"
#include "analysis/motion/run.hpp"
#include "laws/catalogue.hpp"
#include "tests/analysis/healing_at_rest.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::tests::healing_at_rest;
using rosin::tests::slider_under;

TEST_CASE("friction of a law that weakens down to rest is without bound there once its state is gone", "[run]") {
  CHECK(motion::unbounded_at_rest(*laws::find_law("ageing"), 1));
  CHECK(!motion::unbounded_at_rest(*laws::find_law("spinodal"), 1));
  CHECK(!motion::unbounded_at_rest(*laws::find_law("ageing")->with("b", 0.005), 1));
  CHECK(!motion::unbounded_at_rest(*laws::find_law("coulomb"), 1));
}

TEST_CASE("bristles without their deflection jump at rest", "[run]") {
  CHECK(motion::jumps_at_rest(*laws::find_law("lugre"), 1));
  CHECK(motion::jumps_at_rest(*laws::find_law("dahl"), 1));
  CHECK(!motion::jumps_at_rest(*laws::find_law("ageing"), 1));
  CHECK(!motion::jumps_at_rest(*laws::find_law("ageing")->with("b", 0.005), 1));
  CHECK(!motion::jumps_at_rest(*laws::find_law("spinodal"), 1));
  CHECK(!motion::jumps_at_rest(*laws::find_law("coulomb"), 1));
}

TEST_CASE("grazing slip of contacts that remember comes to rest at every tolerance, or its error says that it may",
          "[run]") {
  // At its lowest slip is as good as at rest for a few seconds of an oscillation of a day, then for milliseconds of
  // one of a tenth of a second: rest or none decides the state of the contact.
  struct Scene {
    double mu_s, mu_d, d_c, lambda, k, m, V, N, duration, slip_rate;
  };
  const Scene scene = GENERATE(Scene{1.241, 0.7258, 0.1601, 54.12, 5357.0, 1e12, 4.997e-7, 18.93, 2.831e6, 4.414e-6},
                               Scene{0.8144, 0.1728, 7.868e-5, 3.393, 2.907, 0.0007752, 0.001683, 1.103e-5, 0.2836, 0});
  auto model =
      slider_under("slip-distance", {scene.mu_s, scene.mu_d, scene.d_c}, {scene.m, scene.k, 0}, scene.V, scene.N);
  model.lambda = scene.lambda;
  motion::RunOptions options;
  options.duration = scene.duration;
  options.samples = 20;
  options.start.kind = scene.slip_rate > 0 ? motion::Start::Kind::given : motion::Start::Kind::rest;
  options.start.slip_rate = scene.slip_rate;
  options.tolerance = 1e-11;
  const auto sure = motion::run(model, options);
  REQUIRE(sure.outcome.complete());
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
    options.tolerance = tolerance;
    const auto motion = motion::run(model, options);
    INFO("tolerance " << tolerance << ", " << motion.events.size() << " events");
    REQUIRE(motion.columns[0].size() == 21);
    for (std::size_t c = 0; c < motion.columns.size(); ++c)
      for (std::size_t i = 0; i < motion.time.size(); ++i)
        CHECK(std::abs(motion.columns[c][i] - sure.columns[c][i]) <= motion.column_error[c] + sure.column_error[c]);
  }
}

TEST_CASE("healing in the moment of a reversal is followed", "[run]") {
  // Through rest the load makes the slip rate rise by dv/dt, and healing adds 2 v_c/(lambda dv/dt) to the age.
  const auto model = healing_at_rest();
  const double v_c = 3.689e-11, age = 4.4e-9, v = -1e-6;
  const double N = model.drive.normal_load.level(), V = model.drive.speed.level(), k = model.slider.stiffness;
  const double creep = model.law->slip_rate(1e-6, N, std::vector{age}) / 1e-6;  // m/s per unit of friction, near rest
  const double slope = creep * k * V / N;
  motion::RunOptions options;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = v;
  options.start.displacement = (v / creep * N - model.slider.damping * V) / k;
  options.start.states["theta"] = age;
  options.duration = 2 * std::abs(v) / slope;
  options.samples = 1;
  for (const char* solver : {"collocation", "cvode"}) {
    options.solver = solver;
    const auto found = motion::run(model, options);
    REQUIRE(found.columns[2].size() == 2);
    CHECK(found.columns[2].back() == Approx(-v).epsilon(1e-2));
    REQUIRE(found.column_names[5] == "theta");
    CHECK(found.columns[5].back() - age == Approx(2 * v_c / (model.lambda * slope)).epsilon(2e-3));
  }
}
