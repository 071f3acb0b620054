/// Sweeps along one parameter: against motions by other integrators, and thresholds and borders in closed form.
#include "analysis/planes/sweep.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/steady/stability.hpp"
#include "core/stop.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::planes;
using oscillators::Model;
using Record = SweepOptions::Record;

namespace {

std::function<analysis::motion::StructureModel(double)> over(const std::string& parameter, Model model) {
  return [=](double value) {
    analysis::motion::StructureModel structure{oscillators::one_slider(model.with(parameter, value)), {}};
    structure.start.kind = analysis::motion::Start::Kind::rest;
    return structure;
  };
}
std::function<analysis::motion::StructureModel(double)> over_belt_speed(const Model& model) {
  return over("drive.speed", model);
}

/// m = k = 1 under a load of 1 N.
Model block_on_belt(const char* law, std::vector<Value> parameters, double damping) {
  Model model;
  model.law = laws::find_law(law)->with(parameters);
  model.slider = {1, 1, damping};
  model.drive.normal_load = 1.0;
  return model;
}

/// x″ + x + 1/(1 + 3|v|) sgn v = cos(2 t)/2: Awrejcewicz, Grzelczyk & Pyryev (2008), J. Vibroengineering 10 (4).
Model forced_belt() {
  auto model = block_on_belt("hyperbolic", {1.0, 3.0}, 0);
  model.drive.force = Signal(Signal::Harmonics{0, {{0.5, 2, 0}}});
  return model;
}

/// Friction 0.5 + 0.5 e^(−|v|/0.5), damping 0.1: sliding is stable above 0.5 ln 10 = 1.1513, and up to 1.8366
/// stick-slip exists beside it (where the slip that begins at the end of stick just reaches the belt's speed again, by
/// an independent Runge-Kutta integration of order 4).
Model two_attractors() { return block_on_belt("stribeck", {1.0, 0.5, 0.5, 1.0, 0.0}, 0.1); }

SweepOptions along(double from, double to, int points) {
  SweepOptions options;
  options.axis = make_axis("drive.speed", from, to, points, false, {});
  return options;
}

double range_of(const SweepPoint& point) {
  const auto [low, high] = std::ranges::minmax(point.columns[0]);
  return high - low;
}

}  // namespace

TEST_CASE("a sweep meets the forced motion of period three, and the irregular one", "[sweep]") {
  auto options = along(0.1, 0.4, 2);
  options.keep = 60, options.tolerance = 1e-10;
  const auto result = sweep(over_belt_speed(forced_belt()), options);
  REQUIRE(result.outcome.complete());
  REQUIRE(result.up.size() == 2);
  REQUIRE(result.column_names[1] == "velocity");
  const auto& regular = result.up[0];
  CHECK(regular.recurrence == 3);
  REQUIRE(regular.columns[0].size() == 60);
  // DOP853 and RKF78 agree to 1e-12.
  const double place[] = {0.145709098504, 0.389727402283, 0.687405390551}, speed[] = {-0.263099317854, 0.1, 0.1};
  std::array<bool, 3> found{};
  for (std::size_t i = 57; i < 60; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(regular.columns[0][i] - place[k]) < 1e-10) {
        CHECK(std::abs(regular.columns[1][i] - speed[k]) < 1e-10);
        found[k] = true;
      }
  CHECK((found[0] && found[1] && found[2]));
  // The largest Lyapunov exponent is 0.073 there.
  const auto& irregular = result.up[1];
  CHECK(irregular.recurrence == 0);
  auto sorted = irregular.columns[0];
  std::ranges::sort(sorted);
  for (std::size_t i = 1; i < sorted.size(); ++i) CHECK(sorted[i] - sorted[i - 1] > 1e-8);
}

TEST_CASE("values that begin anew are the same motions in lanes and one by one", "[sweep]") {
  auto options = along(0.1, 0.5, 9);
  options.anew = true, options.transient = 5, options.keep = 4;
  const auto family = over_belt_speed(forced_belt());
  const auto in_lanes = sweep(family, options);
  // A functional keeps a structure out of lanes, and changes nothing of its motion.
  const auto alone = sweep(
      [&](double speed) {
        auto model = family(speed);
        model.structure.functionals.push_back({"double", "m", Eigen::VectorXd::Constant(1, 2)});
        return model;
      },
      options);
  REQUIRE(in_lanes.column_names == std::vector<std::string>{"displacement", "velocity", "slip_rate", "friction_force",
                                                            "friction_coefficient", "acceleration"});
  int stuck = 0;
  for (std::size_t i = 0; i < in_lanes.up.size(); ++i) {
    REQUIRE(in_lanes.up[i].columns[0].size() == 4);
    for (std::size_t n = 0; n < 4; ++n) {
      const auto& here = in_lanes.up[i].columns;
      const auto& there = alone.up[i].columns;
      // Irregular motions part.
      for (std::size_t c = 0; c < here.size(); ++c) CHECK(here[c][n] == Approx(there[c][n]).margin(1e-6));
      stuck += here[2][n] == 0;
    }
  }
  CHECK(stuck > 4);
}

TEST_CASE("extrema of a forced motion are its turning points", "[sweep]") {
  auto options = along(0.1, 0.11, 2);
  options.record = Record::extrema, options.keep = 3;
  const auto result = sweep(over_belt_speed(forced_belt()), options);
  const auto& columns = result.up[0].columns;
  REQUIRE(columns[0].size() >= 2);
  for (const double velocity : columns[1]) CHECK(std::abs(velocity) < 1e-9);
  // It sticks on the belt at 0.1119 m, and leaves it at 0.7879 m: it turns outside.
  CHECK(std::ranges::min(columns[0]) < 0.1118);
  CHECK(std::ranges::max(columns[0]) > 0.7879);
}

TEST_CASE("sliding and stick-slip beside each other: a sweep keeps to the one that it came from", "[sweep]") {
  auto options = along(0.95, 2, 43);
  options.down = true, options.record = Record::extrema, options.transient = 100, options.keep = 4;
  const auto result = sweep(over_belt_speed(two_attractors()), options);
  REQUIRE(result.outcome.complete());
  REQUIRE(result.thresholds.size() == 1);
  CHECK(std::abs(result.thresholds[0].value - 1.15129254649702) < 1e-13);
  CHECK_FALSE(result.thresholds[0].onset);
  for (std::size_t i = 0; i < options.axis.values.size(); ++i) {
    const double speed = options.axis.values[i];
    INFO(speed);
    constexpr double wide = 1, still = 0.1;
    if (speed < 1.1) CHECK(range_of(result.down[i]) > wide);
    if (speed < 1.78) CHECK(range_of(result.up[i]) > wide);
    if (speed > 1.2) CHECK(range_of(result.down[i]) < still);
    if (speed > 1.84) CHECK(range_of(result.up[i]) < still);
  }
}

TEST_CASE("metrics of a sweep carry the motion on as sections do", "[sweep]") {
  auto options = along(1, 2, 21);
  options.down = true, options.record = Record::metrics, options.metrics = {"displacement_max", "stick_fraction"};
  const auto result = sweep(over_belt_speed(two_attractors()), options);
  options.anew = true;  // at rest on the belt, from which stick-slip follows as long as there is any
  const auto anew = sweep(over_belt_speed(two_attractors()), options);
  REQUIRE(result.outcome.complete());
  const auto& highest = result.metrics[0];
  for (std::size_t i = 0; i < options.axis.values.size(); ++i) {
    const double speed = options.axis.values[i];
    INFO(speed);
    const auto &up = result.up[i].metrics, &down = result.down[i].metrics;
    if (speed < 1.76) CHECK(highest.value(up) > 1 - 0.1 * speed);  // where stick ends
    if (speed < 1.76) CHECK(std::abs(highest.value(anew.up[i].metrics) - highest.value(up)) < 1e-7);
    if (speed < 1.1) CHECK(down.regime == Regime::cycle);
    if (speed > 1.16) CHECK(down.regime == Regime::stable);
    if (speed > 1.16) CHECK(std::isnan(highest.value(down)));
    if (speed > 1.84) CHECK(up.regime == Regime::stable);
    CHECK(anew.down[i].metrics.regime == anew.up[i].metrics.regime);
  }
}

TEST_CASE("a sweep does not depend on the number of threads", "[sweep]") {
  auto options = along(0.3, 0.5, 6);
  options.down = true, options.transient = 20, options.keep = 10;
  for (const bool anew : {false, true}) {
    options.anew = anew;
    options.threads = 1;
    const auto one = sweep(over_belt_speed(forced_belt()), options);
    options.threads = 3;
    const auto three = sweep(over_belt_speed(forced_belt()), options);
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(one.up[i].columns == three.up[i].columns);
      CHECK(one.down[i].columns == three.down[i].columns);
    }
  }
}

TEST_CASE("a sweep that is asked to stop keeps the values that are done", "[sweep]") {
  auto options = along(0.3, 0.5, 6);
  options.transient = 5, options.keep = 5;
  std::stop_source source;
  const Listening listening(source.get_token());
  SweepHooks hooks;
  hooks.progress = [&](std::size_t done, std::size_t total) {
    CHECK(total == 6);
    if (done == 2) source.request_stop();
  };
  const auto result = sweep(over_belt_speed(forced_belt()), options, hooks);
  CHECK(result.outcome.ending == Ending::interrupted);
  CHECK(result.up[1].done);
  CHECK_FALSE(result.up[2].done);
}

TEST_CASE("a slider without mass is swept by its cycles", "[sweep]") {
  // Quasi-static, ageing law, radiation damping D = ησ... of AUTO-07p: T V/L at k/kc = 0.9 and 0.8, D = 1e-6.
  Model model;
  model.law = laws::find_law("ageing")->with({0.6, 0.010, 0.015, 1e-6, 1e-6});
  model.slider = {0, 4500, 1};
  model.drive.normal_load = 1.0, model.drive.speed = 1e-6;
  SweepOptions options;
  options.axis = make_axis("oscillator.stiffness", 4000, 4500, 2, false, {});
  options.record = Record::metrics, options.metrics = {"period"};
  const auto result = sweep(over(options.axis.parameter, model), options);
  REQUIRE(result.outcome.complete());
  CHECK(std::abs(result.metrics[0].value(result.up[0].metrics) - 22.048104111) < 1e-7);
  CHECK(std::abs(result.metrics[0].value(result.up[1].metrics) - 19.516047457) < 1e-7);
}

TEST_CASE("a sweep of a slider marks where steady sliding loses its stability, in closed form", "[sweep]") {
  Model model;
  model.law = laws::find_law("ageing")->with({0.6, 0.010, 0.015, 1e-6, 1e-6});
  model.slider = {1, 4500, 0};
  model.drive.speed = 1e-6;
  const auto critical = analysis::steady::critical_load(model);
  REQUIRE(critical);
  SweepOptions options;
  options.axis = make_axis("drive.normal_load", 0.8 * critical->normal_load, 1.2 * critical->normal_load, 3, false, {});
  options.record = Record::metrics, options.metrics = {"period"};
  const auto result = sweep(over(options.axis.parameter, model), options);
  REQUIRE(result.thresholds.size() == 1);
  const auto& threshold = result.thresholds.front();
  CHECK(threshold.onset);
  CHECK(std::abs(threshold.value - critical->normal_load) <= threshold.error + 1e-14 * critical->normal_load);
  CHECK(threshold.angular_frequency == Approx(critical->angular_frequency).epsilon(1e-9));
  CHECK(result.up.front().metrics.regime == Regime::stable);
  CHECK(result.up.back().metrics.regime == Regime::cycle);
}

TEST_CASE("a value at which nothing moves says so, and leaves the others", "[sweep]") {
  auto options = along(0, 0.5, 2);
  options.record = Record::metrics, options.metrics = {"stick_fraction"};
  const auto result = sweep(over_belt_speed(two_attractors()), options);
  REQUIRE(result.outcome.complete());
  CHECK(result.up[0].why.find("nothing drives") != std::string::npos);
  CHECK(result.up[1].why.empty());
  CHECK(result.thresholds_left_out.empty());
  options.axis.values = {0, 0};
  CHECK(sweep(over_belt_speed(two_attractors()), options).outcome.ending == Ending::none_exists);
}
