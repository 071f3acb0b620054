/// Rounding error of forces in slip rates and displacements of a run.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "analysis/motion/run.hpp"
#include "analysis/steady/stability.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::slider_under;

TEST_CASE("BDF says that rounding error of large forces exceeds the step of its spring", "[run]") {
  auto model = slider_under("kato-tullis", {0.9968, 0.00498, 0.006639, 0.00314, 2.173e-9, 1.951e-5},
                            {0.0004656, 0.08124, 0.3355}, 2.724e-9, 6.737e4);
  model.lambda = 0.003308;
  model.contact_stiffness.per_load = 1.3e-8;
  motion::RunOptions options;
  options.duration = 25;
  options.samples = 3;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 4.783e-9;
  options.solver = "cvode";
  options.tolerance = 1e-7;
  // From balance, displacements count from there; but rounding error of friction, 67321 N, is 4e-11 m/s under the
  // damper.
  const auto balanced = motion::run(model, options);
  CHECK(balanced.outcome.ending == Ending::tolerance_not_met);
  CHECK(balanced.columns[2].size() == 4);
  CHECK(balanced.column_error[2] > 2e-11);
  options.start.displacement = 840000;
  CHECK(motion::run(model, options).outcome.ending == Ending::tolerance_not_met);
}

TEST_CASE("steps do not shrink for rounding error of friction", "[run][long]") {
  // Strongly damped bristles behind a spring of the contact: its slip rate follows from forces that all but cancel.
  auto ringing = slider_under(
      "lugre",
      {47123276.27293966, 1052080.9142623376, 21.547450703531883, 10.0, 0.88590215526711946, 0.61002136645827743},
      {1.0014621995500535e-14, 130911.579123317, 0}, 3230.41973343274, 298.39034593200432);
  ringing.lambda = 16513.358136026385;
  ringing.contact_stiffness.tangential = 1189995190.1570506;
  motion::RunOptions options;
  options.duration = 5.4679170009281394e-09;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 10828.256210590782;
  options.tolerance = 1e-6;
  const auto motion = motion::run(ringing, options);
  REQUIRE(motion.outcome.complete());
  CHECK(motion.cost.steps < 10'000);
  options.tolerance = 1e-9;
  const auto close = motion::run(ringing, options);
  REQUIRE(close.columns.size() == motion.columns.size());
  for (std::size_t k = 0; k < close.columns.size(); ++k) {
    if (close.column_names[k] != "acceleration")  // the difference of forces
      CHECK(close.column_error[k] < 1e-7 * std::abs(close.columns[k].back()));
    CHECK(std::abs(close.columns[k].back() - motion.columns[k].back()) <=
          close.column_error[k] + motion.column_error[k]);
  }
  // A slider without mass settles on the curve of steady sliding.
  auto settling = slider_under("lugre",
                               {795563.86770700081, 46.946609182762494, 0.044017741349862645, 0.37323245323618881,
                                0.15706007236119504, 0.0062692422433029728},
                               {0, 74486.984666924778, 0}, 7.3841493792349458e-07, 3.7982055862614805);
  options.duration = 0.016982851366555602;
  options.start.slip_rate = 1.1119268843040756e-08;
  for (const double tolerance : {1e-6, 1e-9}) {
    options.tolerance = tolerance;
    const auto settled = motion::run(settling, options);
    REQUIRE(settled.time.back() == options.duration);
    CHECK(settled.cost.steps < 2'000);
    CHECK(settled.columns[3].back() == Approx(steady::steady_sliding(settling).friction_force).epsilon(1e-7));
    CHECK(settled.column_error[3] < 1e-7 * settled.columns[3].back());
  }
}

TEST_CASE("rounding error of forces over the damping is in the stated error of the slip rate", "[run]") {
  // c v = F - k x with 2218 N on either side: rounding error of friction, 4.5e-13 N, is 1e-7 m/s.
  auto model = slider_under("spinodal", {1.07, 0.03524, 0.05082, 9.278e-8, 8.208e-7, 0.001004, 14.53},
                            {1e-20, 0.09551, 4.534e-6}, 0.08195, 2228.0);
  model.lambda = 3.247e-6;
  model.contact_stiffness.tangential = 0.0005922;
  motion::RunOptions options;
  options.duration = 6.08e-7;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 0.0006245;
  for (const double tolerance : {1e-4, 1e-6, 1e-9}) {
    options.tolerance = tolerance;
    const auto motion = motion::run(model, options);
    REQUIRE(motion.columns[2].size() == 21);
    const double digit = 0.5 * std::numeric_limits<double>::epsilon() * motion.columns[3].back();
    CHECK(motion.column_error[1] > digit / model.slider.damping);
    CHECK(motion.column_error[2] > digit / model.slider.damping);
  }
}

TEST_CASE("the error of a spring's displacement is that of the friction that it bears", "[run]") {
  // k x = F. The two states ring about steady sliding, which long steps damp.
  const double k = 2000;
  const auto model = slider_under("two-state-ageing", {0.6, 0.01, 0.009, 2e-6, 0.006, 4e-5, 1e-6}, {0, k, 0}, 1e-6, 1);
  motion::RunOptions options;
  options.duration = 3e4;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 1.1e-6;
  options.solver = "collocation";
  for (const double tolerance : {1e-4, 1e-6}) {
    options.tolerance = tolerance;
    const auto motion = motion::run(model, options);
    REQUIRE(motion.outcome.complete());
    CHECK(motion.column_error[0] == Approx(motion.column_error[3] / k).epsilon(1e-3));
  }
}

TEST_CASE("slip rates that follow from friction or from forces agree between solvers", "[run][long]") {
  // Explicit steps at two tolerances share their last step, in which slip sets in.
  const auto loading = slider_under("kato-tullis", {0.7379, 0.003532, 0.02848, 0.03634, 4.573e-8, 0.0005811},
                                    {0, 0.01323, 0.003369}, 4.004e-6, 1.11e-5);
  motion::RunOptions options;
  options.duration = 217.8;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::rest;
  options.tolerance = 1e-6;
  constexpr std::size_t slip_rate = 2;
  const auto compared = [&](const Model& model, const char* one, const char* another) {
    options.solver = one;
    const auto first = motion::run(model, options);
    options.solver = another;
    const auto second = motion::run(model, options);
    REQUIRE(first.columns[slip_rate].size() == second.columns[slip_rate].size());
    for (std::size_t i = 0; i < first.columns[slip_rate].size(); ++i)
      CHECK(std::abs(first.columns[slip_rate][i] - second.columns[slip_rate][i]) <=
            first.column_error[slip_rate] + second.column_error[slip_rate]);
  };
  compared(loading, "explicit", "collocation");
  // BDF behind a contact damper, with a deflection of 5e-5 m to its tolerance and 1e-10 m/s.
  auto damped = slider_under("bowden-tabor", {1.322, 0.1033, 0.1462, 1.254e-7, 1.646e-6, 0.01514, 316.8},
                             {0, 1.04e5, 0}, 9.099e-10, 173.6);
  damped.lambda = 4.105e-6;
  damped.contact_stiffness.tangential = 2.119e6;
  damped.contact_stiffness.damping = 9.406e5;
  options.duration = 2.652e-6;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 1.451e-10;
  compared(damped, "collocation", "cvode");
  // BDF of a damper against a contact spring, whose 11 N and 15306 N change by less than rounding error in each step.
  auto still = slider_under("bowden-tabor", {0.5612, 0.03379, 0.09113, 0.009842, 1.44e-6, 0.002248, 0.0483},
                            {0, 596.4, 4.966}, 6.126e-5, 20.47);
  still.lambda = 8.481e-5;
  still.contact_stiffness.tangential = 1131.0;
  options.duration = 1.36e-6;
  options.start.slip_rate = 1.112e-6;
  compared(still, "collocation", "cvode");
  auto inert = slider_under("slip", {0.5478, 0.02092, 0.03282, 3.951e-5, 5.286e-6}, {1.835, 7.584e4, 4.923e5}, 2.753e-9,
                            2.155e4);
  inert.lambda = 0.004851;
  inert.contact_stiffness.tangential = 2.909e5;
  inert.drive.force = Signal(6850.0);
  options.duration = 0.02841;
  options.start.slip_rate = 6.201e-12;
  compared(inert, "collocation", "cvode");
}

TEST_CASE("a strong damper leaves the displacement to rounding error of forces, and it is integrated", "[run]") {
  // 0.1 N of friction and of drag leave 5e-10 N to the spring. The slider moves at (N mu)/c, less the part that the
  // spring holds.
  const double c = 2.872e14, k = 5.092e4, N = 0.1754, V = 8.003e-9;
  auto model = slider_under("prz", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {0, k, c}, V, N);
  model.lambda = 2747.0;
  motion::RunOptions options;
  options.duration = 22.95;
  options.samples = 200;
  options.start.kind = motion::Start::Kind::rest;
  double end[2], error[2];
  for (int i = 0; i < 2; ++i) {
    options.solver = i == 0 ? "explicit" : "collocation";
    const auto result = motion::run(model, options);
    const auto &x = result.columns[0], &mu = result.columns[4];
    double slipped = 0;
    for (std::size_t i = 1; i < x.size(); ++i)
      slipped += 0.5 * N * (mu[i] + mu[i - 1]) / c * options.duration / double(x.size() - 1);
    CHECK(x.back() - x.front() == Approx(slipped).epsilon(1e-3));
    end[i] = x.back(), error[i] = result.column_error[0];
  }
  CHECK(std::abs(end[0] - end[1]) <= error[0] + error[1]);
}

TEST_CASE("a spring of stiffness -0 is none", "[run]") {
  motion::RunOptions options;
  options.duration = 1e5;
  options.samples = 5;
  options.start.kind = motion::Start::Kind::rest;
  const auto with = [&](double stiffness) {
    return motion::run(slider_under("hyperbolic", {0.1325, 40.75}, {2702.0, stiffness, 0.0007219}, 0.00075, 13.72),
                       options);
  };
  const auto none = with(0.0), minus = with(-0.0);
  CHECK(minus.columns == none.columns);
  CHECK(minus.column_error == none.column_error);
}
