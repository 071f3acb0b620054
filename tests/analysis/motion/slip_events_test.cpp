/// The catalogue of slip events, against stick–slip under Coulomb friction in closed form.
#include "analysis/motion/slip_events.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "laws/catalogue.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using rosin::tests::slider_under;

namespace {

Run run_from_rest(const Model& model, double duration, int samples) {
  RunOptions options;
  options.duration = duration;
  options.samples = samples;
  options.start.kind = Start::Kind::rest;
  options.tolerance = 1e-9;
  return run(model, options);
}

}  // namespace

TEST_CASE("slip events of Coulomb friction drop, last and return as in closed form", "[slip-events]") {
  const double mu_s = 0.4, mu_d = 0.3, N = 2, k = 1.09, m = 1, V = GENERATE(0.01, -0.01);
  auto model = slider_under("coulomb", {mu_s, mu_d}, {m, k, 0}, V, N);
  const auto events = slip_events(model, run_from_rest(model, 240, 24000));
  REQUIRE(events.onset.size() == 5);
  // About the balance at mu_d N the mass swings from +D to −D, where it meets the surface again: D = (mu_s − mu_d) N/k.
  const double speed = std::abs(V), w = std::sqrt(k / m), D = (mu_s - mu_d) * N / k;
  const double duration = (std::numbers::pi + 2 * std::atan(speed / (w * D))) / w;
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(events.force_drop[i] == Approx(std::copysign(2 * (mu_s - mu_d) * N, V)).epsilon(1e-10));
    CHECK(events.friction_drop[i] == Approx(events.force_drop[i] / N).epsilon(1e-15));
    CHECK(events.duration[i] == Approx(duration).epsilon(1e-10));
    CHECK(events.slip[i] == Approx(V * duration + std::copysign(2 * D, V)).epsilon(1e-10));
    CHECK(events.peak_slip_rate[i] == Approx(std::copysign(speed + std::hypot(w * D, V), V)).epsilon(1e-7));
  }
  CHECK(events.onset[0] == Approx(mu_s * N / (k * speed)).epsilon(1e-10));
  CHECK(std::isnan(events.recurrence[0]));
  for (std::size_t i = 1; i < 5; ++i) CHECK(events.recurrence[i] == Approx(2 * D / speed + duration).epsilon(1e-10));
  CHECK(events.fewest_samples > 300);
  CHECK(std::abs(events.duration[0] - duration) <= events.error.duration);
  CHECK(events.error.duration < 1e-12);
  CHECK(std::abs(events.peak_slip_rate[0] - std::copysign(speed + std::hypot(w * D, V), V)) <=
        events.error.peak_slip_rate);
  CHECK(events.error.peak_slip_rate < 1e-5);
}

TEST_CASE("slip events of a law that creeps lie where the slip rate is above the drive's, and are found in samples",
          "[slip-events]") {
  // Quasi-static: spring and friction are in balance, so that the drop is that of friction between its extremes.
  auto model = slider_under("ageing", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {1e-3, 200, 0}, 1e-3, 1);
  const auto motion = run_from_rest(model, 10, 50000);
  REQUIRE(motion.outcome.complete());
  const auto events = slip_events(model, motion);
  REQUIRE(events.onset.size() >= 2);
  const auto& x = motion.columns[0];
  const auto& slip_rate = motion.columns[2];
  for (std::size_t i = 0; i < events.onset.size(); ++i) {
    double low = 1e9, high = -1e9, fastest = 0;
    for (std::size_t n = 0; n < motion.time.size(); ++n)
      if (std::abs(motion.time[n] - events.onset[i] - events.duration[i] / 2) < events.duration[i] / 2 + 0.002) {
        low = std::min(low, x[n]), high = std::max(high, x[n]);
        fastest = std::max(fastest, slip_rate[n]);
      }
    CHECK(events.force_drop[i] == Approx(200 * (high - low)).epsilon(1e-3));
    CHECK(events.force_drop[i] > 0.01);
    CHECK(events.peak_slip_rate[i] >= fastest);
    CHECK(events.slip[i] == Approx(1e-3 * events.duration[i] + events.force_drop[i] / 200).epsilon(1e-12));
  }
}

TEST_CASE("errors of slip events found in samples cover what more samples change", "[slip-events]") {
  const auto model = slider_under("ageing", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {1e-3, 200, 0}, 1e-3, 1);
  const auto fine = slip_events(model, run_from_rest(model, 10, 50000));
  const auto events = slip_events(model, run_from_rest(model, 10, 10000));  // 1 ms, 16 samples in an event
  REQUIRE(events.onset.size() == fine.onset.size());
  for (std::size_t i = 0; i < events.onset.size(); ++i) {
    CHECK(std::abs(events.onset[i] - fine.onset[i]) <= events.error.onset);
    CHECK(std::abs(events.duration[i] - fine.duration[i]) <= events.error.duration);
    CHECK(std::abs(events.force_drop[i] - fine.force_drop[i]) <= events.error.force_drop);
    CHECK(std::abs(events.peak_slip_rate[i] - fine.peak_slip_rate[i]) <= events.error.peak_slip_rate);
  }
  CHECK(events.error.duration < 2e-3);
  CHECK(events.error.peak_slip_rate < 0.1);
  CHECK(slip_events(model, run_from_rest(model, 10, 300)).error.force_drop > 0.01);  // seen by a sample or none
}

TEST_CASE("steady sliding, a drive at rest and an imposed slip rate have no slip events", "[slip-events]") {
  auto model = slider_under("ageing", {0.6, 0.015, 0.010, 1e-5, 1e-6}, {1e-3, 200, 0}, 1e-5, 1);
  CHECK(slip_events(model, run_from_rest(model, 10, 1000)).onset.empty());
  model = slider_under("coulomb", {0.4, 0.3}, {1, 1.09, 0}, 0.0, 2);
  model.drive.force = Signal(Signal::Ramp{0, 0.1});
  CHECK(slip_events(model, run_from_rest(model, 20, 100)).onset.empty());
}
