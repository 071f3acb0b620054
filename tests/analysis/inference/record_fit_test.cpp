/// Fits of records whose motion was sampled, counted in steps, or lost for a while: the numbers that made them lie in
/// their intervals.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "analysis/inference/fit.hpp"
#include "analysis/inference/recorded_slip_rate.hpp"
#include "core/random.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;
using oscillators::Model;
using tests::slider_under;

namespace {

const oscillators::Slider any_slider{.mass = 1, .stiffness = 1, .damping = 0};
constexpr double N = 100;

Model lugre(double mu_s, double mu_d, double v_s, double sigma0, double sigma1, double sigma2) {
  return slider_under("lugre", {sigma0, sigma1, sigma2, mu_s, mu_d, v_s}, any_slider, 1, N);
}
const Model truth = lugre(0.3, 0.2, 0.02, 2000, 2, 0.5), start = lugre(0.4, 0.25, 0.04, 1000, 1, 0.2);
const std::vector<std::string> all = {"law.mu_s", "law.mu_d", "law.v_s", "law.sigma0", "law.sigma1", "law.sigma2"};

/// Three sines that reverse slip some ten times a second.
double displacement(double t) {
  return 4e-3 * std::sin(9 * t) + 1.5e-3 * std::sin(23 * t + 1) + 4e-4 * std::sin(41 * t + 2);
}
double slip_rate(double t) {
  return 4e-3 * 9 * std::cos(9 * t) + 1.5e-3 * 23 * std::cos(23 * t + 1) + 4e-4 * 41 * std::cos(41 * t + 2);
}

/// Friction each `spacing` for 4 s with noise of 0.02 N, of a motion known twenty times more densely.
Measurement friction(double spacing) {
  Measurement m;
  m.kind = Measurement::Kind::record, m.name = "record", m.normal_load = N, m.in_force = true;
  constexpr int finer = 20;
  const int samples = int(std::lround(4 / spacing));
  for (int i = 0; i <= finer * samples; ++i) {
    const double t = spacing / finer * i;
    m.history.time.push_back(t), m.history.slip_rate.push_back(slip_rate(t)), m.history.normal_load.push_back(N);
    if (i % finer == 0) m.x.push_back(t);
  }
  m.y = predict(truth, m).y;
  const auto white = white_noise(m.y.size(), 3);
  for (std::size_t i = 0; i < m.y.size(); ++i) m.y[i] += 0.02 * white[i];
  m.history = {};
  return m;
}
/// The same, with the motion as it is recorded at its times.
Measurement with_displacement(Measurement m, const std::vector<double>& recorded) {
  m.history.time = m.x;
  m.history.normal_load.assign(m.x.size(), N);
  m.history.recorded = recorded_motion(m.x, recorded);
  m.history.slip_rate = m.history.recorded.after;
  return m;
}

Measurement::History with_slip_rate(const std::vector<double>& time, const std::function<double(double)>& rate) {
  std::vector<double> recorded;
  for (const double t : time) recorded.push_back(rate(t));
  return recorded_slip_rate(time, recorded, std::vector<double>(time.size(), N));
}

void check_within(const Fit& found, double errors) {
  for (const auto& parameter : found.parameters) {
    const double right = truth.get(parameter.path);
    INFO(parameter.path << " " << parameter.value << " +- " << parameter.standard_error << " for " << right);
    CHECK(std::abs(parameter.value - right) < errors * parameter.standard_error);
    CHECK(parameter.standard_error < 0.1 * right);
  }
}
bool warned(const Fit& found, const std::string& text) {
  return std::ranges::any_of(found.warnings, [&](const auto& w) { return w.find(text) != std::string::npos; });
}

}  // namespace

TEST_CASE("dampers come back from exact displacements at any rate", "[record-fit][long]") {
  for (const double spacing : {0.004, 0.002, 0.001}) {
    INFO("samples each " << spacing << " s");
    auto m = friction(spacing);
    std::vector<double> recorded;
    for (const double t : m.x) recorded.push_back(displacement(t));
    m = with_displacement(m, recorded);
    const auto found = fit(start, {m}, {.parameters = all});
    REQUIRE(found.outcome.complete());
    check_within(found, 3);
    CHECK(found.parameters[4].standard_error < 0.01);
  }
}

TEST_CASE("steps of an encoder are smoothed, and counted in the errors", "[record-fit]") {
  auto m = friction(0.002);
  std::vector<double> recorded;
  constexpr double step = 1e-6;
  for (const double t : m.x) recorded.push_back(step * std::round(displacement(t) / step));
  m = with_displacement(m, recorded);
  CHECK(m.history.recorded.resolution == Approx(step));
  const auto found = fit(start, {m}, {.parameters = all});
  REQUIRE(found.outcome.complete());
  check_within(found, 3);
  auto exact = m;
  exact.history.recorded.noise = exact.history.recorded.resolution = 0;
  const auto uncounted = fit(start, {exact}, {.parameters = all});  // it may withhold its intervals
  CHECK(!(uncounted.parameters[3].standard_error >= found.parameters[3].standard_error));
}

TEST_CASE("a slip rate of differences over one side is said to be late, and a clock finds by how much",
          "[record-fit][long]") {
  const double spacing = 0.002;
  auto m = friction(spacing);
  m.history = with_slip_rate(m.x, [&](double t) { return (displacement(t) - displacement(t - spacing)) / spacing; });
  const auto found = fit(start, {m}, {.parameters = all});
  CHECK(warned(found, "clock_offset = true"));
  m.terms.clock_offset = true;
  const auto timed = fit(start, {m}, {.parameters = all});
  REQUIRE(timed.outcome.complete());
  CHECK(timed.parameters.back().value == Approx(-spacing / 2).epsilon(0.1));
  CHECK_FALSE(warned(timed, "clock_offset = true"));
}

TEST_CASE("points whose friction hangs on the motion while rows are missing are left out", "[record-fit]") {
  auto m = friction(0.002);
  // 20 rows are lost at each of two places, one of them where slip reverses.
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < m.x.size(); ++i)
    if (!(i > 500 && i <= 520) && !(i > 1000 && i <= 1020)) kept.push_back(i);
  auto lost = m;
  lost.x.clear(), lost.y.clear();
  for (const auto i : kept) lost.x.push_back(m.x[i]), lost.y.push_back(m.y[i]);
  lost.history = with_slip_rate(lost.x, slip_rate);
  lost.history.gaps = {500, 980};
  const auto found = fit(start, {lost}, {.parameters = all});
  REQUIRE(found.outcome.complete());
  check_within(found, 3);
}
