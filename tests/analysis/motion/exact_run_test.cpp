/// Runs in closed form: chosen where they apply, and equal to located events on smooth steps, a method of its own.
#include "analysis/motion/exact_run.hpp"

#include <catch2/catch.hpp>

#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::motion;
using rosin::tests::slider_under;

TEST_CASE("the closed form and located events agree on belts, steps, ramps, tables and harmonics", "[exact]") {
  struct Case {
    const char* what;
    const char* law;
    std::vector<Value> values;
    oscillators::Slider slider;
    oscillators::Drive drive;
  };
  const auto harmonic = [](double mean, double amplitude, double w) {
    return Signal(Signal::Harmonics{mean, {{amplitude, w, 0.3}, {amplitude / 3, 2.7 * w, 1}}});
  };
  const auto c = GENERATE_COPY(
      Case{"belt", "coulomb", {0.4, 0.3}, {1, 1.09, 0}, {0.1, 2.0, 0.0}},
      Case{"heavy damper", "coulomb", {0.4, 0.3}, {1, 1, 5}, {0.1, 2.0, harmonic(0, 3, 0.7)}},
      Case{"critical damper", "coulomb", {0.4, 0.3}, {1, 1, 2}, {0.1, harmonic(2, 1, 3), harmonic(0, 3, 0.7)}},
      Case{"shaken surface", "coulomb", {0.4, 0.3}, {1, 4, 0.1}, {harmonic(0, 0.5, 1.5), 2.0, 0.0}},
      Case{"steps", "coulomb", {0.4, 0.2}, {1, 4, 0.1}, {Signal(Signal::Steps{{{0, 0.1}, {7, -0.2}}}), 2.0, 0.5}},
      Case{"table and ramp",
           "coulomb",
           {0.4, 0.2},
           {1, 4, 0.1},
           {Signal(Signal::Table{{1, 5, 9, 12}, {0, 0.3, -0.3, 0.1}}), 2.0, Signal(Signal::Ramp{0, 0.3})}},
      Case{"resonance", "coulomb", {0.2, 0.1}, {1, 1, 0}, {0.0, 1.0, Signal(Signal::Harmonics{0, {{0.5, 1, 0}}})}},
      Case{"viscous", "stribeck", {0.3, 0.3, 0.01, 2.0, 0.2}, {1, 1, 0.05}, {0.5, 2.0, harmonic(0, 2, 0.8)}});
  INFO(c.what);
  auto model = slider_under(c.law, c.values, c.slider, 0, 1);
  model.drive = c.drive;
  RunOptions options;
  options.duration = 20;
  options.samples = 200;
  options.tolerance = 1e-9;
  options.start.kind = Start::Kind::rest;
  Run exact = run(model, options);
  std::erase_if(exact.events, [](const auto& event) { return event.time == 7; });  // the surface jumps: no switch
  options.solver = "events";
  Run located = run(model, options);
  std::erase_if(located.events, [](const auto& event) { return event.time == 12; });  // a kink met in stick
  REQUIRE(exact.outcome.complete());
  CHECK(exact.solver == "exact");
  REQUIRE(located.outcome.complete());
  REQUIRE(exact.events.size() == located.events.size());
  CHECK(exact.events.size() > 2);
  for (std::size_t i = 0; i < exact.events.size(); ++i) {
    CHECK(exact.events[i].kind == located.events[i].kind);
    CHECK(std::abs(exact.events[i].time - located.events[i].time) < 1e-8);
    CHECK(std::abs(exact.events[i].displacement - located.events[i].displacement) < 1e-8);
  }
  for (std::size_t column = 0; column < 2; ++column)  // friction jumps at events
    for (std::size_t i = 0; i < exact.time.size(); ++i)
      CHECK(std::abs(exact.columns[column][i] - located.columns[column][i]) <=
            exact.column_error[column] + located.column_error[column]);
  CHECK(exact.column_error[0] < 1e-12);
  CHECK(std::abs(exact.metrics.at("energy_residual")) < 1e-12);
  CHECK(exact.metrics.at("stick_time") == Approx(located.metrics.at("stick_time")).epsilon(1e-7));
}

TEST_CASE("where there is no closed form, the reason is given", "[exact]") {
  RunOptions options;
  options.duration = 1;
  options.start.kind = Start::Kind::rest;
  const Run events = run(slider_under("hyperbolic", {1.0, 3.0}, {1, 1, 0}, 0.2, 1), options);
  CHECK(events.solver == "events");
  CHECK_THAT(events.why, Catch::Contains("not linear in the slip rate"));
  auto viscous = slider_under("stribeck", {0.3, 0.3, 0.01, 2.0, 0.2}, {1, 1, 0}, 0.2, 1);
  viscous.drive.normal_load = Signal(Signal::Harmonics{1, {{0.5, 1, 0}}});
  CHECK_THAT(run(viscous, options).why, Catch::Contains("the load varies"));
  options.solver = "exact";
  CHECK_THROWS_WITH(run(viscous, options), Catch::Contains("no closed form here"));
  CHECK_THROWS_WITH(run(slider_under("coulomb", {0.4, 0.3}, {1, 0, 0}, 0.2, 1), options),
                    Catch::Contains("a mass and a spring"));
  CHECK_THROWS_WITH(run(slider_under("coulomb", {0.4, 0.3}, {1e-20, 1e20, 0}, 0.2, 1), options),
                    Catch::Contains("beyond what the clock resolves"));
  options.solver = "tr-sdfm";
  CHECK_THROWS_WITH(run(viscous, options), Catch::Contains("for Coulomb friction"));
}

TEST_CASE("an algorithm's run states its true error", "[algorithms]") {
  auto model = slider_under("coulomb", {0.4, 0.23}, {1, 400, 1}, 0, 9.8);
  model.drive.normal_load = Signal(Signal::Harmonics{9.8, {{5, 15, 0}}});
  model.drive.force = Signal(Signal::Harmonics{0, {{3, 10, 0}}});
  RunOptions options;
  options.duration = 2;
  options.start.kind = Start::Kind::given;
  options.start.displacement = 0.1;
  options.start.velocity = 0.0;
  const Run exact = run(model, options);
  options.solver = GENERATE("cfm", "o-fbfm", "r-fbfm", "aabg-sdfm", "tr-sdfm", "vlfm", "svlfm", "meijaard");
  const Run stepped = run(model, options);
  INFO(options.solver);
  REQUIRE(stepped.outcome.complete());
  double largest = 0;
  for (std::size_t i = 0; i < exact.time.size(); ++i)
    largest = std::max(largest, std::abs(exact.columns[0][i] - stepped.columns[0][i]));
  CHECK(stepped.column_error[0] == Approx(largest).epsilon(1e-3));
  CHECK(stepped.column_error[0] < (options.solver == "meijaard" ? 1e-10 : 3e-3));
  CHECK(stepped.metrics.at("friction_work") == Approx(exact.metrics.at("friction_work")).epsilon(0.03));
  options.algorithm.step = 1e-9;
  CHECK_THROWS_WITH(run(model, options), Catch::Contains("more than 5000000"));
}
