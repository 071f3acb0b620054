/// Runs of a plane slider: events and errors as stated, and algorithms with their true errors.
#include "analysis/motion/plane_run.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"
#include "laws/smoothing.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::motion;

namespace {
PlaneModel pushed() {
  const auto harmonic = [](double mean, double amplitude, double w) {
    return Signal(Signal::Harmonics{mean, {{amplitude, w, 0}}});
  };
  return {{3, {400, 200}, {2, 2}, 0.4, 0.4, {0, 0}, harmonic(20, 4, 50), {harmonic(5, 2, 10), harmonic(4, 1, 20)}},
          {0, 0},
          {0.001, 0.001}};
}
}  // namespace

TEST_CASE("a run in the plane has its fifteen events, and states errors that hold", "[plane]") {
  RunOptions options;
  options.times = {0.1, 0.7, 1.2, 1.85, 2};
  options.duration = 2;
  const Run found = run_plane(pushed(), options);
  REQUIRE(found.outcome.complete());
  REQUIRE(found.events.size() == 15);
  CHECK(std::abs(found.events[8].time - 1.247454147038) < 1e-9);
  CHECK(std::abs(found.events[8].displacement_y - 0.001273219646673) < 1e-11);
  CHECK(found.metrics.at("event_time_error") < 1e-8);
  const double x[] = {0.000671846366827, 0.00143700860911, 0.00166499014506, 0.00218206885822, 0.00235749054385};
  for (int i = 0; i < 5; ++i) CHECK(std::abs(found.columns[0][i] - x[i]) < found.column_error[0] + 1e-14);
  CHECK(found.column_error[0] < 1e-10);
  CHECK(found.metrics.at("stick_time") == Approx(1.49947762174).epsilon(1e-9));
}

TEST_CASE("algorithms in the plane state their true errors", "[plane]") {
  RunOptions options;
  options.duration = 2;
  options.samples = 200;
  const Run exact = run_plane(pushed(), options);
  options.solver = GENERATE("o-fbfm", "r-fbfm", "aabg-sdfm", "cfm");
  INFO(options.solver);
  const Run stepped = run_plane(pushed(), options);
  double largest = 0;
  for (std::size_t i = 0; i < exact.time.size(); ++i)
    largest = std::max(largest, std::abs(exact.columns[0][i] - stepped.columns[0][i]));
  CHECK(stepped.column_error[0] == Approx(largest).epsilon(1e-3));
  CHECK(stepped.column_error[0] < 1e-3);
  // The path goes on in the first quadrant: velocities are never negative but by what the algorithm gets wrong in
  // stick.
  CHECK(stepped.metrics.at("velocity_x_min") > -1e-3);
  options.solver = "events";
  CHECK_THROWS_WITH(run_plane(pushed(), options), Catch::Contains("does not serve a plane slider"));
}

TEST_CASE("friction that rises or falls with speed is followed in the plane to the digits of others", "[plane]") {
  // States of an independent integration of order 8, which met no stop.
  struct Case {
    double mu_s, mu_d, v_s, damping, ky, belt, w;
    std::array<double, 2> force, start, velocity;
    double at_10[4], at_80[4];
  };
  const Case cases[] = {{0.25,
                         0.4,
                         0.3,
                         0.02,
                         1.7,
                         0,
                         0.7,
                         {1, 0.8},
                         {1, 0},
                         {0, 0.5},
                         {1.93599214293, 0.28717963911, -0.25315718274, 0.31913014031},
                         {0.86029831750, -0.49218505439, 1.13306958223, 0.27683944066}},
                        {0.5,
                         0.3,
                         0.2,
                         0,
                         2.3,
                         0.4,
                         1.2,
                         {0.6, 0.9},
                         {0.5, -0.3},
                         {0, 0},
                         {-1.58104632950, -0.98195048009, 0.27785726678, 1.21656857894},
                         {0.87171876061, 1.04753435061, 1.17840278584, 0.11574642097}}};
  for (const auto& c : cases) {
    const auto harmonic = [&](double amplitude, double phase) {
      return Signal(Signal::Harmonics{0, {{amplitude, c.w, phase}}});
    };
    PlaneModel model{{1,
                      {1, c.ky},
                      {c.damping, c.damping},
                      c.mu_s,
                      c.mu_s,
                      {c.belt, 0},
                      1.0,
                      {harmonic(c.force[0], 0), harmonic(c.force[1], -std::acos(0.0))}},
                     c.start,
                     c.velocity,
                     laws::find_law("stribeck")->with({c.mu_s, c.mu_d, c.v_s, 1.0, 0.0})};
    RunOptions options;
    options.times = {10, 80}, options.duration = 80, options.tolerance = 1e-9;
    const Run run = run_plane(model, options);
    REQUIRE(run.outcome.complete());
    CHECK(run.events.empty());
    CHECK(std::abs(run.metrics.at("energy_residual")) < 1e-11);
    for (int i = 0; i < 4; ++i) {
      CAPTURE(c.mu_s, i);
      CHECK(std::abs(run.columns[i][0] - c.at_10[i]) < run.column_error[i] + 5e-12);
      CHECK(std::abs(run.columns[i][1] - c.at_80[i]) < run.column_error[i] + 5e-12);
      CHECK(run.column_error[i] < 1e-10);
    }
    options.solver = "cfm";
    CHECK_THROWS_WITH(run_plane(model, options), Catch::Contains("is for Coulomb friction; law 'stribeck' depends"));
  }
}

TEST_CASE("along one axis the plane slider sticks and slips as the slider does, friction rising and falling",
          "[plane]") {
  for (const double mu_d : {0.2, 0.7}) {
    CAPTURE(mu_d);
    const Signal force(Signal::Harmonics{0, {{1, 0.7, 0.3}}});
    const auto law = laws::find_law("stribeck")->with({0.4, mu_d, 0.3, 1.0, 0.0});
    PlaneModel plane{{1, {1, 2}, {0.05, 0}, 0.4, 0.4, {0.1, 0}, 1.0, {force, 0.0}}, {0.9, 0}, {0, 0}, law};
    oscillators::Model line{.law = law};
    line.slider = {1, 1, 0.05};
    line.drive = {0.1, 1.0, force};
    RunOptions options;
    options.duration = 30, options.samples = 300, options.tolerance = 1e-9;
    const Run in_plane = run_plane(plane, options);
    options.start = {.kind = Start::Kind::given, .displacement = 0.9, .velocity = 0};
    const Run on_line = run(line, options);
    REQUIRE(in_plane.outcome.complete());
    REQUIRE(on_line.outcome.complete());
    REQUIRE(in_plane.events.size() == on_line.events.size());
    CHECK(in_plane.events.size() > 5);
    for (std::size_t i = 0; i < in_plane.events.size(); ++i) {
      CHECK(in_plane.events[i].kind == on_line.events[i].kind);
      CHECK(std::abs(in_plane.events[i].time - on_line.events[i].time) < 1e-8);
    }
    for (std::size_t i = 0; i < on_line.time.size(); ++i) {
      CHECK(std::abs(in_plane.columns[0][i] - on_line.columns[0][i]) < 1e-9);
      CHECK(std::abs(in_plane.columns[2][i] - on_line.columns[1][i]) < 1e-9);
    }
    CHECK(std::abs(in_plane.metrics.at("energy_residual")) < 1e-10);
  }
}

TEST_CASE("along one axis smoothed friction moves the plane slider as it does the slider", "[plane][smoothing]") {
  for (const auto type :
       {laws::Smoothing::Type::tanh, laws::Smoothing::Type::linear, laws::Smoothing::Type::parabolic}) {
    CAPTURE(int(type));
    const Signal force(Signal::Harmonics{0, {{1, 0.7, 0.3}}});
    const auto law = laws::smoothed(laws::find_law("hyperbolic"), {type, 0.02});
    PlaneModel plane{{1, {1, 2}, {0.05, 0}, 0, 0, {0.1, 0}, 1.0, {force, 0.0}}, {0.9, 0}, {0, 0}, law};
    oscillators::Model line{.law = law};
    line.slider = {1, 1, 0.05};
    line.drive = {0.1, 1.0, force};
    RunOptions options;
    options.duration = 20, options.samples = 200, options.tolerance = 1e-9;
    const Run in_plane = run_plane(plane, options);
    options.start = {.kind = Start::Kind::given, .displacement = 0.9, .velocity = 0};
    const Run on_line = run(line, options);
    REQUIRE(in_plane.outcome.complete());
    REQUIRE(on_line.outcome.complete());
    for (std::size_t i = 0; i < on_line.time.size(); ++i) {
      CHECK(std::abs(in_plane.columns[0][i] - on_line.columns[0][i]) <
            in_plane.column_error[0] + on_line.column_error[0] + 1e-12);
      CHECK(std::abs(in_plane.columns[2][i] - on_line.columns[1][i]) <
            in_plane.column_error[2] + on_line.column_error[1] + 1e-12);
    }
    CHECK(in_plane.column_error[0] < 1e-9);
    CHECK(std::abs(in_plane.metrics.at("energy_residual")) < 1e-10);
  }

  // Let go without a force: the springs alone tell how fast it will be.
  PlaneModel released{{1, {1, 1}, {0, 0}, 0, 0, {0, 0}, 1.0, {}}, {1, 0.5}, {0, 0}};
  released.law = laws::smoothed(laws::find_law("coulomb")->with({0.1, 0.1}), {laws::Smoothing::Type::tanh, 1e-3});
  RunOptions options;
  options.duration = 20, options.samples = 2;
  const Run run = run_plane(released, options);
  REQUIRE(run.outcome.complete());
  CHECK(std::abs(run.metrics.at("energy_residual")) < 1e-9);
  CHECK(run.columns[1][1] == Approx(run.columns[0][1] / 2).epsilon(1e-9));  // along the line on which it was let go
}
