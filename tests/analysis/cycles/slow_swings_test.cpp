/// Free oscillations that friction hardly changes: amplitude growth of 1e-5 per period and less.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "tests/analysis/agreement.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::tests::check_agreement;
using rosin::tests::slider_under;

TEST_CASE("an amplitude that friction restores by 2e-5 per period is known within its errors", "[cycle]") {
  const auto model = slider_under("hyperbolic", {0.6782, 834.8}, {0.857, 15.95, 0}, 0.6115, 3.899e-5);
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-8});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.outcome.complete());
  check_agreement(loose, fine);
}

TEST_CASE("an amplitude far below what the load could hold is found, or the search for it ends", "[cycle]") {
  auto model = slider_under("stribeck", {0.41178, 0.21652, 4.033e-6, 1.2904, 0.0}, {21.077, 0.42496, 4.3532},
                            2.1446e-10, 0.0012246);
  model.drive.force = -0.010801;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.metrics.period > 0);
  CHECK(loose.metrics.slip_rate_max < 2 * model.drive.speed.level());
  check_agreement(loose, fine, {&cycles::Metrics::period});
}

TEST_CASE("friction of 5e-8 of the spring force leads reversing slip to an amplitude that touches rest",
          "[cycle][long]") {
  // Friction is 5e-8 of the spring's force. Where slip no longer reverses it does not change with the slip rate, and
  // leaves the amplitude alone: slip that touches rest has v = V (1 - cos wt).
  const double m = 0.0001345, k = 96.62, V = 2774.0;
  auto model = slider_under(
      "thermal-disc", {0.2609, 0.166, 0.07107, 0.8081, 0.03223, 0.009784, 0.005225, 0.006817, 1.0, 3.355e-5, 1.381},
      {m, k, 0}, V, 1.539e-5);
  model.lambda = 2675.0;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6, .multipliers = false});
  REQUIRE(cycle.outcome.complete());
  CHECK(std::abs(cycle.metrics.period - 2 * std::numbers::pi * std::sqrt(m / k)) <= cycle.error.period);
  CHECK(std::abs(cycle.metrics.slip_rate_max - 2 * V) <= cycle.error.slip_rate_max);
}

TEST_CASE("the amplitude of a neutral oscillation is that of the start, not of long steps", "[cycle]") {
  // The start is about to slip. Steps at 1e-6 let it slip at once, with half the amplitude that it has after healing.
  auto model = slider_under("two-state-ageing",
                            {0.231865, 0.00447166, 0.0148231, 0.000852614, 0.00890449, 0.020905, 1.10568e-11},
                            {1e12, 3845.65, 0}, 1.65833e-12, 6.44159e7);
  model.lambda = 2.41593;
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             tight = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  check_agreement(loose, tight, {&cycles::Metrics::slip_rate_max});
}

namespace {
/// Work of slip-distance friction per period and radian of a free oscillation v = V (1 + a cos τ), a > 1, over the
/// load: against the motion where positive. Friction begins anew at both reversals, where cos τ = −1/a.
double work_against_swing(double a, double mu_s, double mu_d, double d_c, double slip_per_radian) {
  const double half = std::acos(1 / a), pi = std::numbers::pi;
  double work = 4 * mu_d * std::sin(half);
  const auto add = [&](double sign, double from, double to) {
    const auto slipped = [&](double tau) {
      return slip_per_radian * std::abs(tau - from + a * (std::sin(tau) - std::sin(from)));
    };
    double low = from, high = to;
    if (slipped(to) < d_c) low = to;
    while (high - low > 1e-14 * high) {
      const double middle = 0.5 * (low + high);
      (slipped(middle) < d_c ? low : high) = middle;
    }
    constexpr int intervals = 4000;  // Simpson's rule
    const double width = (low - from) / intervals;
    for (int i = 0; i <= intervals; ++i) {
      const double tau = from + i * width, weight = i == 0 || i == intervals ? 1 : 2 + 2 * (i % 2);
      work += sign * (mu_s - mu_d) * (1 - slipped(tau) / d_c) * std::cos(tau) * weight * width / 3;
    }
  };
  add(1, pi + half, 3 * pi - half);
  add(-1, pi - half, pi + half);
  return work;
}
}  // namespace

TEST_CASE("amplitudes balance where the work of friction per period vanishes, at every tolerance", "[cycle][long]") {
  // Friction is 5e-10 and 9e-11 of the spring's force, and a period forgets 4e-9 and 2e-9 of its start.
  struct Case {
    double mu_s, mu_d, d_c, lambda, mass, stiffness, V, load;
  };
  for (const auto& [mu_s, mu_d, d_c, lambda, m, k, V, N] :
       {Case{1.18994, 4.94066e-324, 0.395596, 0.409567, 1e12, 1.61125e6, 0.000311844, 0.000186996},
        Case{0.529448, 0.191248, 0.0306126, 86.5383, 145410.0, 3018.62, 5.68722, 1.11633e-5}}) {
    auto model = slider_under("slip-distance", {mu_s, mu_d, d_c}, {m, k, 0}, V, N);
    model.lambda = lambda;
    double low = 1 + 1e-9, high = 1.5;
    while (high - low > 1e-15) {
      const double middle = 0.5 * (low + high);
      if (middle == low || middle == high) break;
      (work_against_swing(middle, mu_s, mu_d, d_c, V / (std::sqrt(k / m) * lambda)) < 0 ? low : high) = middle;
    }
    for (const double tolerance : {1e-5, 1e-9}) {
      const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance});
      REQUIRE(cycle.metrics.period > 0);
      CHECK(std::abs(cycle.metrics.slip_rate_max - V * (1 + low)) <= cycle.error.slip_rate_max);
      CHECK(cycle.error.slip_rate_max < 1e-5 * V);
    }
  }
}

TEST_CASE("friction that shows at the end of a period needs no search by its work", "[cycle]") {
  // It takes a hundredth of the energy at the lowest load, where the search by work took 9000 steps and more.
  for (const double load : {1e-8, 1e-7, 1e-6}) {
    const auto model = rosin::tests::bristol_board(load, 0.04);
    const auto loose = cycles::find_cycle(model, {.tolerance = 1e-3, .multipliers = false}),
               fine = cycles::find_cycle(model, {.tolerance = 1e-8, .multipliers = false});
    REQUIRE(loose.outcome.complete());
    REQUIRE(fine.outcome.complete());
    CHECK(loose.cost.steps < 3000);
    check_agreement(loose, fine);
  }
}
