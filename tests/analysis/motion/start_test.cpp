/// Starts from rest, from a slip rate and in an unstable balance.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/motion/run.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::slider_under;

TEST_CASE("a start off the friction of its state keeps its transient at every tolerance", "[run]") {
  Model model = slider_under("spinodal", {0.8782, 0.06552, 0.1045, 8.543e-07, 3.583e-06, 0.0004357, 181.2},
                             {0.03411, 0.2609, 0}, 4.8e-06, 0.004235);
  model.lambda = 738.2;
  motion::RunOptions options;
  options.duration = 20.34;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 3.543e-05;
  options.tolerance = 1e-6;
  const auto loose = motion::run(model, options);
  options.tolerance = 1e-9;
  const auto tight = motion::run(model, options);
  REQUIRE(loose.outcome.complete());
  constexpr int slip_rate = 2;
  for (std::size_t i = 0; i < loose.time.size(); ++i)
    CHECK(std::abs(loose.columns[slip_rate][i] - tight.columns[slip_rate][i]) <=
          loose.column_error[slip_rate] + tight.column_error[slip_rate]);
}

TEST_CASE("the age of a contact without its clock is that of the slip rate at onset", "[run]") {
  const double V = 0.1808, L1 = 4.251e-7;
  Model model = slider_under("two-state-slip", {0.3283, 0.01239, 0.003228, L1, 0.003328, 6.278e-5, 5.683e-6},
                             {6755.0, 3.526e4, 9.342e8}, V, 398.0);
  model.lambda = 0;
  motion::RunOptions options;
  options.duration = 0.0214;
  options.start.kind = motion::Start::Kind::rest;
  const auto found = motion::run(model, options);
  REQUIRE(found.outcome.complete());
  CHECK(found.columns[5].front() == Approx(L1 / (1e-14 * V)).epsilon(1e-6));
}

TEST_CASE("forces balance to all digits at a start from a slip rate", "[run]") {
  // Friction that does not depend on the slip rate: m u' = k xi, xi' = V - u from xi = 0. Rounding error of the
  // friction force would accelerate so little mass by 10 m/s^2.
  const double m = 2.2e-14, k = 0.014, V = 4e-7, u0 = 3.7e-8, omega = std::sqrt(k / m);
  for (const double c : {0.0, 1e-12}) {
    const auto model = slider_under("loading-rate", {4.4, 2.7, 0.38, 0.4}, {m, k, c}, V, 2545.0);
    motion::RunOptions options;
    options.duration = 9e-6;
    options.samples = 20;
    options.tolerance = 1e-8;
    options.start.kind = motion::Start::Kind::given;
    options.start.slip_rate = u0;
    const auto motion = motion::run(model, options);
    REQUIRE(motion.outcome.complete());
    const double decay = c / (2 * m), ringing = std::sqrt(omega * omega - decay * decay);
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
      // w = u - V: m w'' + c w' + k w = 0 with w'(0) = 0.
      const double t = motion.time[i];
      const double w =
          (u0 - V) * std::exp(-decay * t) * (std::cos(ringing * t) + decay / ringing * std::sin(ringing * t));
      CHECK(std::abs(motion.columns[2][i] - (V + w)) < 1e-8 * V);
    }
  }
}

TEST_CASE("a contact starts from its friction in stick, not from friction that is all but gone in sliding", "[run]") {
  // 0.63 at a thousandth of the drive's speed, 4e-24 at it.
  const auto model = slider_under("spinodal", {0.6255, 0.01149, 0.1377, 7.401e-5, 0.003033, 1.437e-7, 8.079},
                                  {5.801e-10, 5511.0, 0.000114}, 36.31, 14.85);
  const double slow = 1e-3 * model.drive.speed.level();
  const double held = model.law->steady_friction({slow, model.drive.normal_load.level()}).friction;
  REQUIRE(held > 0.1);
  motion::RunOptions options;
  options.duration = 1e-9;
  options.samples = 1;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = slow;
  const auto found = motion::run(model, options);
  REQUIRE(found.outcome.complete());
  CHECK(found.columns[4].front() == Approx(held).epsilon(1e-9));
}

TEST_CASE("a start in an unstable balance is left as the drive loads it, not as rounding error does", "[run]") {
  // Friction falls with the slip rate at 2e11 1/s, and the drive loads the spring: slip runs away until the damper
  // holds what friction has lost, c w = N (mu(u) - mu_inf), which then decays with k/c.
  const double u = 9.148e-6, V = 0.002313, N = 1.714e7;
  const double k = 2344.0, c = 4.577e4, mu_inf = 0.35;
  const auto model = slider_under("two-exponential", {mu_inf, 0.4, 0.01, 0.45, 0.1}, {0.003595, k, c}, V, N);
  motion::RunOptions options;
  options.duration = 0.01676;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = u;
  const double lost = N * (0.4 * std::exp(-u / 0.01) + 0.45 * std::exp(-u / 0.1));
  for (const double tolerance : {1e-6, 1e-7, 1e-8, 1e-9}) {
    options.tolerance = tolerance;
    const auto motion = motion::run(model, options);
    REQUIRE(motion.outcome.complete());
    CHECK(motion.time.front() == 0);
    CHECK(motion.columns[2].front() == Approx(u));
    CHECK(motion.columns[2].back() ==
          Approx(V + (u - V + lost / c) * std::exp(-k / c * options.duration)).epsilon(1e-6));
  }
  // A drive slower than the slip unloads the spring: slip stops.
  auto slower = model;
  slower.drive.speed = Signal(1e-7);
  for (const double tolerance : {1e-6, 1e-9}) {
    options.tolerance = tolerance;
    CHECK(motion::run(slower, options).columns[2].back() == 0);
  }
}

TEST_CASE("rounding error does not bring slip to rest that falling friction accelerates", "[run]") {
  // At 4e-16 m/s friction falls with the slip rate at 2e16 1/s and nothing but the drive, faster than the slip, decides
  // that slip runs away: to where the damper holds what friction has lost, c v = N (mu(start) - mu(v)).
  const double u = 3.766e-16, V = 1.64e-12, N = 0.7953;
  const double k = 7609.0, c = 1.103e5, m = 9.964e-5;
  auto model = slider_under("kato-tullis", {0.6, 0.01, 0.015, 1e-5, 1e-6, 1e-8}, {m, k, c}, V, N);
  model.lambda = 0;
  motion::RunOptions options;
  options.duration = 1e-4;  // the spring has hardly unloaded: k/c is 0.07 1/s
  options.samples = 2;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = u;
  const auto friction = [&](double v) { return model.law->steady_friction({v, N}).friction; };
  double v = 1e-6;
  for (int i = 0; i < 100; ++i) v = N * (friction(u) - friction(v)) / c;
  for (const double tolerance : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-11}) {
    options.tolerance = tolerance;
    const auto motion = motion::run(model, options);
    REQUIRE(motion.outcome.complete());
    CHECK(motion.columns[2].back() == Approx(v).epsilon(1e-4));
  }
}

TEST_CASE("slip that its own weakening carries away agrees with BDF", "[run]") {
  // Without its clock the friction curve falls with slip rate, and a slider of so little mass leaves slow slip within
  // 1e-7 s. BDF in the natural unknowns has to agree.
  auto model = slider_under("two-state-ageing", {0.6, 0.01, 0.009, 2e-6, 0.006, 4e-5, 1e-6}, {4.005, 1.27e-5, 0.08768},
                            6.55e-5, 0.001135);
  model.lambda = 0;
  motion::RunOptions options;
  options.duration = 3.356;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 8.494e-9;
  options.tolerance = 1e-6;
  const auto found = motion::run(model, options);
  REQUIRE(found.outcome.complete());
  options.solver = "cvode";
  options.tolerance = 1e-9;
  const auto other = motion::run(model, options);  // known to somewhat less than asked
  for (std::size_t c = 0; c < found.columns.size(); ++c)
    for (std::size_t i = 0; i < found.columns[c].size(); ++i)
      CHECK(std::abs(found.columns[c][i] - other.columns[c][i]) <= found.column_error[c] + other.column_error[c]);
}

TEST_CASE("a start from rest creeps at 1e-14 of the drive's speed, whatever friction is in steady sliding", "[run]") {
  // 2e4 times as much friction holds at 1e-14 of the drive's speed as at 1e-3 of it.
  const double V = 0.0193, N = 23.18;
  auto model =
      slider_under("nagata", {0.3198, 0.03539, 0.1555, 2.528e-6, 5.395e-7, 5.003}, {4387.0, 4.015e4, 1.685e5}, V, N);
  model.lambda = 0;
  motion::RunOptions options;
  options.duration = 0.01226;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::rest;
  const auto found = motion::run(model, options);
  REQUIRE(found.outcome.complete());
  constexpr std::size_t slip_rate = 2, phi = 5;
  CHECK(found.columns[slip_rate][0] == Approx(1e-14 * V).epsilon(1e-8));
  CHECK(std::abs(found.columns[phi][0] - model.law->steady({1e-14 * V, N})[0]) <= found.column_error[phi]);
}
