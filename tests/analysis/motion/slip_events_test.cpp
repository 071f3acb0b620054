/// Slip events and extremes of a run, against closed forms and whatever the samples are.
#include "analysis/motion/slip_events.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/motion/plane_run.hpp"
#include "analysis/motion/structure_run.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/structure.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using oscillators::FrictionContact, oscillators::Model;
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

/// Every number of a run that is no sample is the same from other samples, within the errors of both.
void check_alike(const Run& few, const Run& many) {
  REQUIRE(few.slips.onset.size() == many.slips.onset.size());
  CHECK(few.slips.contact == many.slips.contact);
  const auto& error = few.slips.error;
  const auto alike = [&](const std::vector<double>& a, const std::vector<double>& b, double most) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!std::isnan(a[i])) CHECK(std::abs(a[i] - b[i]) <= 2 * most);
  };
  alike(few.slips.onset, many.slips.onset, std::max(error.onset, many.slips.error.onset));
  alike(few.slips.duration, many.slips.duration, std::max(error.duration, many.slips.error.duration));
  alike(few.slips.force_drop, many.slips.force_drop, std::max(error.force_drop, many.slips.error.force_drop));
  alike(few.slips.slip, many.slips.slip, std::max(error.slip, many.slips.error.slip));
  alike(few.slips.peak_slip_rate, many.slips.peak_slip_rate,
        std::max(error.peak_slip_rate, many.slips.error.peak_slip_rate));
  alike(few.slips.recurrence, many.slips.recurrence, std::max(error.recurrence, many.slips.error.recurrence));
  REQUIRE(few.events.size() == many.events.size());
  for (std::size_t i = 0; i < few.events.size(); ++i) {
    CHECK(few.events[i].kind == many.events[i].kind);
    CHECK(std::abs(few.events[i].time - many.events[i].time) <= few.events[i].error + many.events[i].error);
  }
  for (const auto& [name, known] : few.metric_error) {
    CAPTURE(name, few.metrics.at(name), many.metrics.at(name), known);
    CHECK(std::abs(few.metrics.at(name) - many.metrics.at(name)) <= known + many.metric_error.at(name));
    if (!name.ends_with("_max") && !name.ends_with("_min")) continue;
    // no sample lies beyond
    const auto column =
        std::size_t(std::ranges::find(many.column_names, name.substr(0, name.size() - 4)) - many.column_names.begin());
    const auto [low, high] = std::ranges::minmax(many.columns[column]);
    if (name.ends_with("_max")) CHECK(high <= many.metrics.at(name));
    if (name.ends_with("_min")) CHECK(low >= many.metrics.at(name));
  }
}

/// Two coupled blocks on a belt.
StructureModel two_blocks(const char* law, double speed, double coupling) {
  FrictionContact contact;
  contact.law = laws::find_law(law);
  if (law == std::string("ageing")) contact.law = contact.law->with({0.6, 0.01, 0.05, 0.02, 0.1});
  contact.speed = speed;
  oscillators::Chain chain;
  chain.mass = {1, 1.5};
  chain.coupling_stiffness = {coupling}, chain.coupling_damping = {0.05};
  chain.pull_stiffness = {1, 0.8}, chain.pull_damping = {0.05, 0.05};
  return {oscillators::chain(chain, {contact, contact}), {}};
}

/// A run with few samples and one with a hundred times as many.
template <class Ask>
int check_samples(Ask ask) {
  constexpr int samples = 13;
  const Run few = ask(samples), many = ask(100 * samples);
  check_alike(few, many);
  return int(few.slips.onset.size());
}

}  // namespace

TEST_CASE("slip events of Coulomb friction drop, last and return as in closed form", "[slip-events]") {
  const double mu_s = 0.4, mu_d = 0.3, N = 2, k = 1.09, m = 1, V = GENERATE(0.01, -0.01);
  auto model = slider_under("coulomb", {mu_s, mu_d}, {m, k, 0}, V, N);
  const auto events = run_from_rest(model, 240, 3).slips;
  REQUIRE(events.onset.size() == 5);
  // About the balance at mu_d N the mass swings from +D to −D, where it meets the surface again: D = (mu_s − mu_d) N/k.
  const double speed = std::abs(V), w = std::sqrt(k / m), D = (mu_s - mu_d) * N / k;
  const double duration = (std::numbers::pi + 2 * std::atan(speed / (w * D))) / w;
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(events.force_drop[i] == Approx(std::copysign(2 * (mu_s - mu_d) * N, V)).epsilon(1e-10));
    CHECK(events.friction_drop[i] == Approx(events.force_drop[i] / N).epsilon(1e-15));
    CHECK(events.duration[i] == Approx(duration).epsilon(1e-10));
    CHECK(events.slip[i] == Approx(V * duration + std::copysign(2 * D, V)).epsilon(1e-10));
    CHECK(events.peak_slip_rate[i] == Approx(std::copysign(speed + std::hypot(w * D, V), V)).epsilon(1e-12));
  }
  CHECK(events.onset[0] == Approx(mu_s * N / (k * speed)).epsilon(1e-10));
  CHECK(std::isnan(events.recurrence[0]));
  for (std::size_t i = 1; i < 5; ++i) CHECK(events.recurrence[i] == Approx(2 * D / speed + duration).epsilon(1e-10));
  CHECK(std::abs(events.duration[0] - duration) <= events.error.duration);
  CHECK(events.error.duration < 1e-12);
  CHECK(std::abs(events.peak_slip_rate[0] - std::copysign(speed + std::hypot(w * D, V), V)) <=
        events.error.peak_slip_rate);
  CHECK(events.error.peak_slip_rate < 1e-12);
}

TEST_CASE("slip events of a law that creeps lie where the slip rate is above the drive's", "[slip-events]") {
  // Quasi-static: spring and friction are in balance, so that the drop is that of friction between its extremes.
  auto model = slider_under("ageing", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {1e-3, 200, 0}, 1e-3, 1);
  const auto motion = run_from_rest(model, 10, 50000);
  REQUIRE(motion.outcome.complete());
  const auto& events = motion.slips;
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

TEST_CASE("events and extremes of 50 random stick-slip runs do not depend on samples", "[slip-events]") {
  std::mt19937_64 random(20261128);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  int slips = 0, sliders = 0, structures = 0;
  for (int scene = 0; scene < 50; ++scene) {
    CAPTURE(scene);
    if (scene % 5 == 4) {  // two blocks on a belt
      auto model = two_blocks(scene % 2 ? "coulomb" : "ageing", uniform(0.1, 0.3), uniform(0.8, 1.5));
      model.start.kind = Start::Kind::given;
      model.start.coordinates = {uniform(-0.5, 0.5), uniform(-0.5, 0.5)}, model.start.velocities = {0.0, 0.0};
      slips += check_samples([&](int samples) {
        RunOptions options;
        options.duration = 30, options.samples = samples;
        return run_structure(model, options);
      });
      ++structures;
      continue;
    }
    const double V = std::pow(10, uniform(-6, -3)), N = std::pow(10, uniform(0, 6)), L = std::pow(10, uniform(-6, -4));
    const double a = uniform(0.005, 0.015), b = a + uniform(0.002, 0.01), critical = (b - a) * N / L;
    const double k = critical * uniform(0.3, 0.8), recurrence = 20 * (b - a) * N / (k * V);
    Model model;
    switch (scene % 5) {
      case 0:  // radiation damping
        model = slider_under("ageing", {0.6, a, b, L, 1e-6}, {0, k, a * N / (V * uniform(1e2, 1e6))}, V, N);
        break;
      case 1:
        model = slider_under("slip", {0.6, a, b, L, 1e-6}, {0, k, a * N / (V * uniform(1e2, 1e4))}, V, N);
        break;
      case 2: {  // inertia
        const double period = L / V * std::pow(10, uniform(-4, -2));
        model = slider_under("ageing", {0.6, a, b, L, 1e-6}, {k * period * period, k, 0}, V, N);
        break;
      }
      default:  // located switches, in closed form and by steps
        model = slider_under(scene % 2 ? "coulomb" : "stribeck",
                             scene % 2 ? std::vector<Value>{0.4, 0.3} : std::vector<Value>{0.4, 0.3, 0.1, 2.0, 0.0},
                             {1, 1, 0.02}, 0.05, 1);
    }
    const bool located = scene % 5 == 3;
    const int found = check_samples([&](int samples) {
      RunOptions options;
      options.duration = located ? 30 : 3 * recurrence;
      options.samples = samples;
      if (located) {
        options.start.kind = Start::Kind::rest;
      } else {
        options.start.kind = Start::Kind::given;
        options.start.slip_rate = 1.01 * V;
        options.start.states["theta"] = 2 * L / V;
      }
      return run(model, options);
    });
    slips += found, ++sliders;
  }
  CHECK(sliders == 40);
  CHECK(structures == 10);
  CHECK(slips > 100);
}

TEST_CASE("steady sliding, a drive at rest and an imposed slip rate have no slip events", "[slip-events]") {
  auto model = slider_under("ageing", {0.6, 0.015, 0.010, 1e-5, 1e-6}, {1e-3, 200, 0}, 1e-5, 1);
  CHECK(run_from_rest(model, 10, 1000).slips.onset.empty());
  model = slider_under("coulomb", {0.4, 0.3}, {1, 1.09, 0}, 0.0, 2);
  model.drive.force = Signal(Signal::Ramp{0, 0.1});
  CHECK(run_from_rest(model, 20, 100).slips.onset.empty());
}
