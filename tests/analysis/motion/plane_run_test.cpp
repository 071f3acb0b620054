/// Runs of a plane slider: events and errors as stated, and algorithms with their true errors.
#include "analysis/motion/plane_run.hpp"

#include <catch2/catch.hpp>
#include <cmath>

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
