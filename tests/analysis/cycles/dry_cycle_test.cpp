/// Stick–slip under Coulomb friction in closed form.
#include "analysis/cycles/dry_cycle.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/motion/exact_run.hpp"
#include "analysis/steady/stability.hpp"
#include "laws/catalogue.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::cycles;

namespace {

Model coulomb(double mu_s, double mu_d, oscillators::Slider slider, double speed, double load, double force = 0) {
  Model model = rosin::tests::slider_under("coulomb", {mu_s, mu_d}, slider, speed, load);
  model.drive.force = force;
  return model;
}

}  // namespace

TEST_CASE("the undamped cycle is that of the textbook", "[dry-cycle]") {
  // Slip lasts (2/ω)(π − arctan(ω Δ/V)), stick 2 Δ/V, with Δ = N (μs − μd)/k; the highest slip rate is
  // V + √(V² + (ω Δ)²).
  for (const double speed : {1e-9, 1e-3, 1.0, 1e4})
    for (const double load : {1e-6, 1.0, 1e5}) {
      const double m = 0.7, k = 350, omega = std::sqrt(k / m), delta = load * 0.1 / k;
      const Cycle cycle = find_cycle(coulomb(0.4, 0.3, {m, k, 0}, speed, load, 0.2 * load), {.tolerance = 1e-12});
      REQUIRE(cycle.outcome.complete());
      const double slip = 2 / omega * (std::numbers::pi - std::atan(omega * delta / speed)), stick = 2 * delta / speed;
      const auto& [M, E] = std::pair(cycle.metrics, cycle.error);
      CHECK(M.period == Approx(slip + stick).epsilon(1e-14));
      CHECK(M.stick_fraction == Approx(stick / (slip + stick)).epsilon(1e-12));
      CHECK(M.slip_rate_max == Approx(speed + std::hypot(speed, omega * delta)).epsilon(1e-14));
      CHECK(M.friction_min == Approx(0.2).epsilon(1e-9));
      CHECK(M.friction_max == 0.4);
      CHECK(M.friction_mean ==
            Approx(0.3).epsilon(1e-10));  // the drive gains no momentum: the force is that of sliding
      CHECK(M.slip_rate_mean == speed);
      CHECK(E.period <= 1e-13 * M.period);
      CHECK(cycle.cost.steps == 0);
      CHECK(cycle.stable);
      CHECK(cycle.section_displacement == Approx((0.4 * load + 0.2 * load) / k).epsilon(1e-12));
    }
}

TEST_CASE("damped and viscous cycles are those that events lead to", "[dry-cycle]") {
  // From stick, event after event, by the closed form that runs use.
  int cycles = 0, none = 0;
  for (const double damping : {0.0, 1e-3, 0.03, 0.5, 5.0})
    for (const double viscous : {0.0, 0.02, 1.0})
      for (const double speed : {1e-4, 1e-2, 0.3, 3.0}) {
        INFO(damping << ' ' << viscous << ' ' << speed);
        const solvers::stick_slip::DryOscillator oscillator{2, 800, damping, 0.5, 0.2, viscous, speed, 4.0, -0.3};
        solvers::stick_slip::Exact<long double> exact(oscillator);
        exact.start(0, 0, speed);
        std::vector<double> onsets, stops;
        const long double end = 20 * (2 * std::numbers::pi / 20 + 2 * 4 * 0.3 / 800 / speed);
        double fastest = 0;
        while (exact.time() < end && onsets.size() < 4) {
          (void)exact.advance(end);
          for (int i = 0; i <= 400 && exact.direction() == 1 && onsets.size() > 1; ++i) {
            const auto t = exact.time_before() + (exact.time() - exact.time_before()) * i / 400;
            fastest = std::max(fastest, double(exact.at(t).slip_rate));
          }
          if (exact.direction() == 0 && exact.upcoming() == 1) onsets.push_back(double(exact.time()));
          if (exact.direction() == 1 && exact.upcoming() == 0) stops.push_back(double(exact.time()));
        }
        const auto cycle = find_dry_cycle(oscillator, {});
        REQUIRE(cycle.has_value() == (onsets.size() == 4));
        ++(cycle ? cycles : none);
        if (!cycle) continue;
        const auto& M = cycle->metrics;
        CHECK(M.period == Approx(onsets[3] - onsets[2]).epsilon(1e-12));
        CHECK(M.stick_fraction * M.period == Approx(onsets[3] - stops.back()).epsilon(1e-10));
        CHECK(M.slip_rate_max == Approx(fastest).epsilon(1e-4));  // of samples
        CHECK(M.slip_rate_max >= fastest * (1 - 1e-14));
        // The impulse of all forces over a period vanishes: that of the spring by the mean displacement of the orbit.
        CHECK(cycle->orbit.front().displacement == Approx(cycle->orbit.back().displacement).epsilon(1e-10));
        CHECK(cycle->orbit.back().time == Approx(M.period).epsilon(1e-12));
        CHECK(cycle->error.stick_fraction < 1e-12);
      }
  CHECK(cycles > 20);
  CHECK(none > 10);
}

TEST_CASE("the least of friction makes its cycle too", "[dry-cycle]") {
  // Slip comes to rest by 10⁻¹⁸ of its speed.
  const Model model = coulomb(0.4, 0.3, {0.13, 9.8e6, 0}, 17.4, 5e-4);
  const Cycle cycle = find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.metrics.stick_fraction * cycle.metrics.period == Approx(2 * 5e-4 * 0.1 / 9.8e6 / 17.4).epsilon(1e-9));
  // None where friction in motion is as large as at rest, none without friction in motion.
  CHECK(find_cycle(coulomb(0.3, 0.3, {1, 1, 0}, 1, 1), {}).outcome.ending == Ending::none_exists);
  const auto reverses = motion::dry_oscillator(coulomb(0.3, 0.0, {1, 1, 0}, 1, 1));
  CHECK_FALSE(find_dry_cycle(std::get<solvers::stick_slip::DryOscillator>(reverses), {}));
}

TEST_CASE("slip that has made a turn without rest is not followed any further", "[dry-cycle]") {
  // A damped slider on a falling curve, whose swing from stick takes hundreds of turns to die out.
  Model model = rosin::tests::slider_under("stribeck", {0.4, 0.3, 0.01, 2.0, 0.0}, {1, 3e4, 0.05}, 0.05, 0.01);
  REQUIRE(steady::stability(model).stable);
  for (const double tolerance : {1e-3, 1e-6}) {
    const Cycle cycle = find_cycle(model, {.tolerance = tolerance});
    CHECK(cycle.outcome.ending == Ending::none_exists);
    CHECK(cycle.cost.steps < 2000);
  }
}

TEST_CASE("a slip that swings nearly free comes to rest where the closed form says, however light the load",
          "[dry-cycle]") {
  // Kato's law whose static friction does not grow is Coulomb's. Damping takes a third of what stick has stored.
  for (const double damping : {0.0, 5e-4})
    for (const double load : {0.5, 1e-2, 1e-4, 1e-6, 1e-9}) {
      const auto kato =
          rosin::tests::slider_under("kato-growth", {0.4, 0.4, 0.1, 0.5, 0.3}, {1, 1, damping * load * load}, 1, load);
      const auto coulomb = rosin::tests::slider_under("coulomb", {0.4, 0.3}, {1, 1, damping * load * load}, 1, load);
      const auto found = find_cycle(kato, {.tolerance = 1e-8}), exact = find_cycle(coulomb, {.tolerance = 1e-8});
      CAPTURE(load, damping);
      REQUIRE(found.outcome.complete());
      REQUIRE(exact.outcome.complete());
      CHECK(exact.cost.steps == 0);
      if (damping == 0) CHECK(std::abs(found.metrics.friction_min - 0.2) <= found.error.friction_min);
      for (const auto& metric : metric_names()) {
        CAPTURE(metric.name);
        CHECK(std::abs(found.metrics.*metric.member - exact.metrics.*metric.member) <=
              found.error.*metric.member + exact.error.*metric.member);
      }
    }
}

TEST_CASE("a run through many such stops keeps to the closed form, either way", "[run]") {
  for (const double speed : {1.0, -1.0})
    for (const double load : {0.1, 1e-5}) {
      motion::RunOptions options;
      options.duration = 60;
      options.samples = 50;
      options.start.kind = motion::Start::Kind::rest;
      options.tolerance = 1e-8;
      const auto found = motion::run(
          rosin::tests::slider_under("kato-growth", {0.4, 0.4, 0.1, 0.5, 0.3}, {1, 1, 0}, speed, load), options);
      const auto exact =
          motion::run(rosin::tests::slider_under("coulomb", {0.4, 0.3}, {1, 1, 0}, speed, load), options);
      CAPTURE(load, speed);
      CHECK(found.solver == "events");
      CHECK(exact.solver == "exact");
      CHECK(found.events.size() == exact.events.size());
      for (std::size_t c = 0; c < 2; ++c) {
        CHECK(found.column_error[c] < 1e-6);
        for (std::size_t i = 0; i < found.columns[c].size(); ++i)
          CHECK(std::abs(found.columns[c][i] - exact.columns[c][i]) <= found.column_error[c] + 1e-12);
      }
    }
}
