/// Runs that start in steady sliding, and rounding error of the balance that keeps them there.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/motion/run.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::tests::slider_under;

TEST_CASE("a run from unstable steady sliding stays there unless its steps leave that to rounding error", "[run]") {
  auto model = slider_under("ageing", {0.9507, 0.006369, 0.02047, 6.17e-6, 6.346e-11}, {0, 0.003073, 1.595e-7},
                            2.188e-6, 8.818e-5);
  model.lambda = 0.05035;
  motion::RunOptions options;
  options.duration = 3691;
  options.samples = 20;
  // Growth at steady sliding: one state without mass has the larger root of its characteristic equation,
  // (c + a N/V) λ s² + (k λ + (c + (a − b) N/V) V/L) s + k V/L = 0.
  const double N = model.drive.normal_load.level(), V = model.drive.speed.level(), lambda = model.lambda;
  const double a = 0.006369, b = 0.02047, rate = V / 6.17e-6;
  const auto& s = model.slider;
  const double p = (s.damping + a * N / V) * lambda;
  const double q = s.stiffness * lambda + (s.damping + (a - b) * N / V) * rate, r = s.stiffness * rate;
  const auto growth = fmt::format("{:.3g} 1/s", (-q + std::sqrt(q * q - 4 * p * r)) / (2 * p));
  // Nothing disturbs the slider: it stays.
  const auto steady = motion::run(model, options);
  CHECK(steady.outcome.complete());
  CHECK(steady.cost.steps == 0);
  CHECK_THAT(steady.remark, Catch::Contains(growth));
  CHECK(steady.columns[2].back() == Approx(model.drive.speed.level()).epsilon(1e-10));
  options.solver = "explicit";
  const auto unsure = motion::run(model, options);
  CHECK(unsure.outcome.ending == Ending::tolerance_not_met);
  CHECK_THAT(unsure.outcome.detail, Catch::Contains("unstable with " + growth) && Catch::Contains("rounding decides"));
  // Next to steady sliding the same motion is known.
  motion::RunOptions neighbour = options;
  neighbour.start.kind = motion::Start::Kind::given;
  neighbour.start.slip_rate = 1.01 * model.drive.speed.level();
  CHECK(motion::run(model, neighbour).outcome.complete());
}

TEST_CASE("a run that stays in steady sliding is exact", "[run]") {
  const double V = 8.808;
  const auto model = slider_under("coulomb", {0.6659, 0.5525}, {5.021e4, 439.3, 313.5}, V, 1.285);
  motion::RunOptions options;
  options.duration = 5.446e-7;
  options.start.kind = motion::Start::Kind::steady;
  const auto found = motion::run(model, options);
  REQUIRE(found.outcome.complete());
  for (const double velocity : found.columns[1]) CHECK(std::abs(velocity) <= 1e-15 * V);
}

TEST_CASE("rounding error of forces does not end a run that stays in steady sliding", "[run]") {
  // Rounding error of 19 N over the damping would be 0.6 % of the slip rate.
  auto model = slider_under("bowden-tabor", {2.167, 0.01226, 0.0231, 3.827e-6, 1.623e-7, 0.006445, 17.08},
                            {0.002869, 0.001592, 0.01894}, 3.377e-11, 9.36);
  model.lambda = 1.153e-6;
  motion::RunOptions options;
  options.duration = 0.001357;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::steady;
  const auto stays = motion::run(model, options);
  CHECK(stays.outcome.complete());
  CHECK(stays.columns[2].back() == Approx(model.drive.speed.level()).epsilon(1e-14));
}

TEST_CASE("rounding error of 1e-14 N does not move a slider of 1e-30 kg out of steady sliding", "[run]") {
  // Friction is constant, and so is the spring force but for rounding error, 1.4e-14 N, which makes sqrt(km) = 2.6e-14
  // N s/m oscillate by half a metre a second, ten million times the drive's speed.
  const auto model = slider_under("static-growth", {0.19, 0.0116, 1.89e-05, 0.107}, {1e-30, 682, 0}, 5.26e-8, 951.6);
  motion::RunOptions options;
  options.duration = 3.8e-15;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::steady;
  for (const char* solver : {"auto", "events"}) {
    options.solver = solver;
    const auto motion = motion::run(model, options);
    for (const double slip_rate : motion.columns[2]) CHECK(slip_rate == Approx(5.26e-8).epsilon(1e-12));
  }
}

TEST_CASE("the slip rate of a damped contact is known within rounding error of the forces", "[run]") {
  // Without mass c (V - v) = k x - F: rounding error of 13 N over 580 N s/m is 7e-7 of the drive's speed.
  auto model = slider_under("kato-tullis", {0.2112, 0.02056, 0.01895, 4.382e-6, 5.126e-6, 1.557e-8}, {0, 0.1254, 580.1},
                            4.419e-12, 65.83);
  model.contact_stiffness.tangential = 0.05041;
  model.contact_stiffness.damping = 33.67;
  motion::RunOptions options;
  options.duration = 1070.0;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::steady;
  options.solver = "collocation";
  for (const double tolerance : {1e-6, 1e-9}) {
    options.tolerance = tolerance;
    const auto motion = motion::run(model, options);
    for (const double slip_rate : motion.columns[2])
      CHECK(std::abs(slip_rate - model.drive.speed.level()) <= motion.column_error[2]);
  }
}

TEST_CASE("an integrated run from steady sliding states rounding error of its balance", "[run]") {
  // 5796 N, whose rounding error over sqrt(km) = 5e-11 N s/m is half of the drive's speed.
  const double V = 0.04651;
  auto model = slider_under("spinodal", {0.3425, 0.01153, 0.03541, 6.196e-7, 7.2e-7, 0.0001183, 15.49},
                            {7.158e-19, 0.003409, 9.895e-12}, V, 3.747e4);
  model.lambda = 0.5;
  model.contact_stiffness.tangential = 1.344e-7;
  model.contact_stiffness.damping = 3.506e-17;
  motion::RunOptions options;
  options.duration = 2.393e-6;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::steady;
  options.solver = "collocation";
  const auto motion = motion::run(model, options);
  constexpr std::size_t slip_rate = 2;
  REQUIRE(motion.column_names[slip_rate] == "slip_rate");
  for (const double v : motion.columns[slip_rate]) CHECK(std::abs(v - V) <= motion.column_error[slip_rate]);
}
