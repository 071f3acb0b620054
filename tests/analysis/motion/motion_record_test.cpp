/// Extremes and slips from the dense output of steps.
#include "analysis/motion/motion_record.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using rosin::tests::slider_under;

namespace {

/// A peak of this width about 1, three samples of it in a step of length 2.
MotionRecord peaked(double width, const std::vector<double>& times) {
  MotionRecord record(1, 0, times);
  const double inside[] = {0.7, 1.2, 1.6};
  record.step(0, 2, inside, [=](double t, double* row) { *row = 1 / (1 + (t - 1) * (t - 1) / (width * width)); });
  return record;
}

}  // namespace

TEST_CASE("an extreme between the points of a step is found to rounding", "[motion-record]") {
  const std::vector<double> times = {0, 2};
  const auto record = peaked(0.5, times);
  CHECK(record.high(0) == Approx(1).epsilon(1e-14));
  CHECK(record.low(0) == Approx(0.2).epsilon(1e-14));
  CHECK(record.samples() == 1);  // that at the end of the step is due in the next
}

TEST_CASE("extremes of the forced linear oscillation are its amplitude, whatever the samples are", "[motion-record]") {
  // Slip that never reverses: x = mu N/k + X cos(w t - phase) from its own steady state, X = f/|k - m w² + i c w|.
  const double k = 1, m = 1, c = 0.1, w = 1.3, f = 2, mu_d = 0.3, N = 1;
  auto model = slider_under("coulomb", {0.4, mu_d}, {m, k, c}, 10.0, N);
  const double X = f / std::hypot(k - m * w * w, c * w);
  model.drive.force = Signal(Signal::Harmonics{0, {{f, w, 0}}});
  RunOptions options;
  options.duration = 200, options.samples = 2;
  options.start.kind = Start::Kind::given;
  const double phase = std::atan2(c * w, k - m * w * w);
  options.start.displacement = mu_d * N / k + X * std::cos(phase), options.start.velocity = X * w * std::sin(phase);
  for (const char* solver : {"auto", "events"}) {
    options.solver = solver;
    const Run found = run(model, options);
    CAPTURE(solver);
    REQUIRE(found.outcome.complete());
    constexpr double rounding = 2e-15;
    CHECK(std::abs(found.metrics.at("displacement_max") - mu_d * N / k - X) <=
          found.metric_error.at("displacement_max") + rounding);
    CHECK(std::abs(found.metrics.at("velocity_min") + X * w) <= found.metric_error.at("velocity_min") + rounding);
    CHECK(found.metric_error.at("displacement_max") < 1e-7 * X);
  }
}
