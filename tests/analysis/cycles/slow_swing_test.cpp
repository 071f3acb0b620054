/// Swings that friction changes by little in a turn: averaging says where they settle.
#include "analysis/cycles/slow_swing.hpp"

#include <boost/math/quadrature/tanh_sinh.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <tuple>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lanes/cycle_lanes.hpp"
#include "laws/catalogue.hpp"
#include "laws/formula.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::cycles;
using rosin::tests::slider_under;

namespace {

constexpr double v1 = 1e-3;  // m/s

/// Friction 2 s + g s³ + s⁵, s = v/v1, under a drive at v1.
Model quintic(double g, double load) {
  laws::FormulaDescription text;
  text.title = "Quintic";
  text.parameters = {{{"g", "1", {-10, 10}, "cubic term"}, g}, {{"v1", "m/s", {1e-6, 1}, "slip rate"}, v1}};
  text.define = {{"s", "v/v1"}};
  text.friction = "2*s + g*s*s*s + s*s*s*s*s";
  Model model;
  model.law = laws::make_formula(text);
  model.slider = {1, 1e4, 0};
  model.drive.speed = Signal(v1);
  model.drive.normal_load = Signal(load);
  return model;
}

/// The g with which a swing v = v1 (1 + A cos ωt) loses as much as it gains: ∮ μ cos = 0, term by term.
double balancing(double A) {
  const double cubic = 1.5 * A + 3.0 / 8 * std::pow(A, 3);
  const double quintic = 2.5 * A + 15.0 / 4 * std::pow(A, 3) + 5.0 / 16 * std::pow(A, 5);
  return -(A + quintic) / cubic;
}

void check_within_errors(const Cycle& a, const Cycle& b) {
  for (const auto& metric : metric_names()) {
    INFO(metric.name << " = " << a.metrics.*metric.member << " and " << b.metrics.*metric.member);
    CHECK(std::abs(a.metrics.*metric.member - b.metrics.*metric.member) <=
          a.error.*metric.member + b.error.*metric.member);
  }
}

}  // namespace

TEST_CASE("a swing that friction holds by any tiny part of its energy is that of averaging", "[cycle]") {
  for (const double load : {1e-8, 1e-14, 1e-20})
    for (const double A : {0.3, 0.5}) {
      const auto cycle = find_cycle(quintic(balancing(A), load), {.tolerance = 1e-9});
      INFO("load " << load << " N, amplitude " << A << ": " << cycle.outcome.detail);
      REQUIRE(cycle.outcome.complete());
      // Averaging errs by the load over V √(k m), 0.1 N.
      const double averaging = 10 * load / 0.1;
      CHECK(std::abs(cycle.metrics.slip_rate_max - v1 * (1 + A)) <= cycle.error.slip_rate_max + averaging * v1);
      CHECK(std::abs(cycle.metrics.slip_rate_min - v1 * (1 - A)) <= cycle.error.slip_rate_min + averaging * v1);
      CHECK(std::abs(cycle.metrics.period - 2 * std::numbers::pi / 100) <= cycle.error.period + averaging);
      CHECK(cycle.error.slip_rate_max < 1e-9 * v1);
      CHECK(cycle.stable);
      REQUIRE(cycle.multipliers.size() == 1);
      CHECK(cycle.multipliers.front().real() <= 1);
      CHECK(cycle.multipliers.front().real() < 1);
      CHECK(cycle.multipliers.front().real() > 1 - std::max(1e3 * load, 1e-15));
    }
}

TEST_CASE("a slow swing with memory is known as closely as it states, and lanes do not take another for it",
          "[cycle]") {
  auto model = slider_under(
      "slip",
      {1.4067829142199439, 0.0075378951491471904, 0.015299400689900112, 7.3609373891919615e-06, 4.0353420199519093e-07},
      {1e12, 289744.75808173593, 0}, 4.7433712131281019e-05, 2.5711048950654556e-05);
  model.lambda = 7367.800500481535;
  const auto loose = find_cycle(model, {.tolerance = 1e-6}), fine = find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.outcome.complete());
  check_within_errors(loose, fine);
  // Its friction turns over 1e-11 of its energy in a turn, and what lanes learn of that is noise.
  CHECK_FALSE(lanes::find_cycles(std::span(&model, 1), lanes::LaneCycleOptions{}).front().found);
}

TEST_CASE("slow decay onto stable sliding is told by the work of friction", "[cycle]") {
  auto model = slider_under("nagata",
                            {0.50893448773402317, 0.027848152067188409, 0.029401622605611563, 0.039647285619348188,
                             0.0014382887869551493, 4.8851002183921244},
                            {4.9533278732635306, 34917.19754352521, 0}, 7.6405503964093837, 0.0011870471651007758);
  model.lambda = 4.356364132475651;
  const auto cycle = find_cycle(model, {.tolerance = 1e-6});
  CHECK(cycle.outcome.ending == Ending::none_exists);
  CHECK(cycle.cost.steps < 30'000);
}

TEST_CASE("a swing that friction leaves alone is as its start made it", "[cycle]") {
  // At 2e7 times the drive's speed friction is all but gone, but for the reversals.
  const auto model =
      slider_under("nagata",
                   {1.4683989176222136, 0.019863932884529291, 0.14122638175513083, 1.0835290466085282e-05,
                    9.1203052950540763e-06, 1.4629049752668859},
                   {1.8576286272886724e-07, 0.052394871415031519, 0}, 0.10556429956323835, 103.03700542395521);
  const auto loose = find_cycle(model, {.tolerance = 1e-6}), fine = find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.complete());
  REQUIRE(fine.metrics.period > 0);
  const double natural = 2 * std::numbers::pi * std::sqrt(model.slider.mass / model.slider.stiffness);
  CHECK(std::abs(loose.metrics.period - natural) <= loose.error.period);
  CHECK(loose.metrics.slip_rate_max > 1e6 * model.drive.speed.level());
  check_within_errors(loose, fine);
  REQUIRE(loose.growth);
  CHECK(*loose.growth < 0);
  CHECK(*loose.growth > -1e-12);
  CHECK(loose.multipliers.empty());
}

TEST_CASE("swings that decay until they stick anywhere in a turn have no period", "[cycle]") {
  auto model = slider_under("two-state-ageing",
                            {0.23903861711645741, 0.0034371292166492846, 0.011679692199105949, 6.2655346110268572e-07,
                             0.0053447145936055341, 5.3029829719342596e-06, 1.9401243459371678e-07},
                            {5.337408891177422e-09, 9211.4464314540692, 0}, 0.0023689736001936369, 1.6776607678363287);
  model.lambda = 0.00023529815327932412;
  model.drive.force = Signal(-0.028642107369084364);
  const auto cycle = find_cycle(model, {.tolerance = 1e-6});
  CHECK(cycle.outcome.ending == Ending::none_exists);
  CHECK(cycle.outcome.detail.starts_with("no two periods are alike"));
}

TEST_CASE("a swing under a friction curve that jumps at rest is where averaging has it", "[cycle]") {
  // Friction of 1e-4 N under a swing of 1e8 N.
  const double mu_s = 1.2179750948391512, delta = 0.39241478123060325, V = 10000;
  const auto model =
      slider_under("hyperbolic", {mu_s, delta}, {871.75059824352911, 172365.45874251073, 0}, V, 0.00037603241471873775);
  // v = V (1 + A cos φ) reverses at cos φ = −1/A; the work of friction on the swing, over V N.
  const auto work = [&](double A) {
    const auto power = [&](double phi) {
      const double v = V * (1 + A * std::cos(phi));
      return (v > 0 ? 1 : -1) * mu_s / (1 + delta * std::abs(v)) * A * std::cos(phi);
    };
    using boost::math::quadrature::tanh_sinh;
    const double reversal = std::acos(-1 / A);
    return tanh_sinh<double>().integrate(power, 0.0, reversal) +
           tanh_sinh<double>().integrate(power, reversal, std::numbers::pi);
  };
  double low = 1 + 1e-6, high = 1.1;
  REQUIRE(work(low) < 0);
  REQUIRE(work(high) > 0);
  for (int k = 0; k < 60; ++k) (work(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
  for (const double tolerance : {1e-6, 1e-7}) {
    const auto cycle = find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.outcome.complete());
    CHECK(cycle.error.slip_rate_max < 1e-7 * V);
    CHECK(std::abs(cycle.metrics.slip_rate_max - V * (1 + low)) <= cycle.error.slip_rate_max);
    CHECK(std::abs(cycle.metrics.slip_rate_min - V * (1 - low)) <= cycle.error.slip_rate_min);
  }
}

TEST_CASE("bristles hold a swing where it just reverses, by a part in a million of it", "[cycle]") {
  // Friction that weakens feeds the swing while it does not reverse, and bristles that turn over take far more.
  for (const auto& [values, slider, V, load, lambda] :
       {std::tuple{std::vector<Value>{1e5, 100.0, 0.4, 0.4, 0.3, 1e-3},
                   oscillators::Slider{1291.2037744756979, 3990.1592523618679, 0}, 2.0911821943444129e-06,
                   1.2691199840409416e-05, 0.00037394185618600271},
        std::tuple{std::vector<Value>{481924.24350613513, 972.10407180162815, 0.64177628869902925, 0.9671011561315056,
                                      0.24027023439615292, 0.00045166959813563632},
                   oscillators::Slider{205320.10106722417, 739952.54749399831, 0}, 1.1928173024182704e-05,
                   0.00016299492931748545, 3.3562509517512895}}) {
    auto model = slider_under("lugre", values, slider, V, load);
    model.lambda = lambda;
    const auto loose = find_cycle(model, {.tolerance = 1e-6}), fine = find_cycle(model, {.tolerance = 1e-9});
    INFO(loose.outcome.detail << " " << fine.outcome.detail);
    REQUIRE(loose.outcome.complete());
    REQUIRE(fine.outcome.complete());
    check_within_errors(loose, fine);
    CHECK(fine.metrics.slip_rate_min < 0);
    CHECK(fine.metrics.slip_rate_min > -0.01 * V);
  }
}

TEST_CASE("a drift of 1e-8 a turn is no cycle of the lanes", "[cycle]") {
  auto model = slider_under("two-state-ageing",
                            {0.26378954909995916, 0.015991257283655889, 0.022304297650993767, 1.1757367013459664e-06,
                             0.0031422689430719692, 2.3172057126821229e-05, 3.7495467134180936e-07},
                            {1e12, 305244.50978578971, 0}, 4.4867088416326751e-06, 0.00071190525911582632);
  model.lambda = 3337.6845724028972;
  model.drive.force = Signal(0.00012518790730919961);
  const auto cycle = find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.metrics.slip_rate_min > 0);
  const auto lane = lanes::find_cycles(std::span(&model, 1), lanes::LaneCycleOptions{}).front();
  CHECK((!lane.found || std::abs(lane.metrics.slip_rate_max - cycle.metrics.slip_rate_max) <=
                            lane.error.slip_rate_max + cycle.error.slip_rate_max));
}

TEST_CASE("a swing whose turns seem to repeat themselves is judged by the work of friction", "[cycle]") {
  // At 1e10 times the drive's speed friction of this law is gone.
  const auto model =
      slider_under("slip",
                   {0.39594477928055893, 0.0049869322480481136, 0.043012041512821557, 4.0759035044994461e-05,
                    3.4745644024738923e-09},
                   {265.71463158452343, 42.142347349245199, 0}, 1.8410978058063196e-10, 426.64264308610768);
  const auto cycle = find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  REQUIRE(cycle.growth);
  CHECK(std::abs(*cycle.growth) < 1e-12);
  CHECK(cycle.error.period < 1e-6 * cycle.metrics.period);
  CHECK(std::abs(cycle.metrics.period - 2 * std::numbers::pi * std::sqrt(model.slider.mass / model.slider.stiffness)) <=
        cycle.error.period);
}

TEST_CASE("a swing that only a reversal beside it leads back to is no cycle", "[cycle]") {
  // Viscous friction all but cancels what weakens: swings that do not reverse stay as they are, larger ones come back
  // to the first that does not.
  auto model =
      slider_under("lugre-unscaled",
                   {11051.523394023357, 0.51761261803976, 0.00022553349059734087, 1.5540650131376541,
                    2.7040510423590589e-05, 1.7983280132036155},
                   {31702.296922197409, 0.0024509248419007606, 0}, 0.00044612435447018519, 0.52601861547461704);
  model.lambda = 0.79388451488734579;
  for (const double tolerance : {1e-6, 1e-9})
    CHECK_FALSE(find_cycle(model, {.tolerance = tolerance}).outcome.complete());
}
