/// Friction under a bow from the forces at the ends of the string: Helmholtz motion in closed form, and simulated
/// motions.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/lab/experiment.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::lab;
using oscillators::BowedString;

namespace {

Task string_task(const BowedString& string, const char* law, std::vector<Value> values = {}) {
  auto of = laws::find_law(law);
  if (!values.empty()) of = of->with(std::move(values));
  auto task = task_for(find_experiment("inverse"), of);
  auto& model = task.string.emplace();
  model.string = string;
  model.law = of;
  model.speed = {Signal(0.1)}, model.load = {Signal(1.0)};
  return task;
}

/// Without losses, whole samples between the ends and the bow.
BowedString ideal() {
  BowedString string;
  string.frequency = 100, string.impedance = 0.5, string.bow_position = 0.1;
  string.quality = INFINITY, string.corner_rounding = 0, string.torsion.reset();
  string.delays = oscillators::DelayLine::integer, string.sample_rate = 20000;
  return string;
}

double bow_motion(double from_bridge, double periods) { return periods - std::floor(periods + 1e-9) + from_bridge; }

}  // namespace

TEST_CASE("inverse: the end forces of Helmholtz motion tell the speed of the bow, of the slip, and friction",
          "[lab][string]") {
  // Waves of the motion with one corner: o(t) = V/β (t/T − ½) away from the bow towards the bridge, −o(t − βT) towards
  // the nut, each with a constant; the force on an end is 2 Z₀ times the wave that arrives (Raman 1918).
  constexpr double V = 0.1, beta = 0.1, T = 0.01, Z = 0.5, F = 0.3;
  const auto sawtooth = [](double t) { return V / beta * bow_motion(-0.5, t / T); };
  auto task = string_task(ideal(), "coulomb", {0.8, 0.3});
  auto& forces = task.end_forces.emplace();
  for (int i = 0; i <= 800; ++i) {
    const double t = i / 20000.0, t1 = 0.5 * beta * T, t2 = 0.5 * (1 - beta) * T;
    forces.bridge.time.push_back(t), forces.nut.time.push_back(t);
    forces.bridge.value.push_back(2 * Z * sawtooth(t - t1) + 0.9 * F);
    forces.nut.value.push_back(-2 * Z * sawtooth(t - t2 - beta * T) + 0.1 * F);
  }
  const auto result = find_experiment("inverse").perform(task);
  CHECK(result.reading("sticking_velocity").value == Approx(V).epsilon(1e-12));
  CHECK(result.reading("slipping_velocity").value == Approx(V * (1 - 1 / beta)).epsilon(1e-12));
  CHECK(result.reading("force_apart").value < 1e-12);
  int slips = 0;
  constexpr std::size_t two_periods = 400;
  const auto& velocity = result.record.column("velocity");
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    const bool slip = velocity[i] < 0;
    slips += slip && i < two_periods;
    CHECK(std::abs(velocity[i] - (slip ? V * (1 - 1 / beta) : V)) < 1e-12);
    CHECK(std::abs(result.record.column("friction_force")[i] - F) < 1e-12);
  }
  CHECK(slips == beta * two_periods);
  task.end_forces->nut.time[3] += 1e-5;
  CHECK_THROWS_WITH(find_experiment("inverse").perform(task), Catch::Contains("same times"));
}

TEST_CASE("inverse: noise of both end forces leaves as much in the friction of a string without losses",
          "[lab][string]") {
  auto task = string_task(ideal(), "coulomb", {0.8, 0.3});
  task.settings.set("duration", 0.5);
  const auto clean = find_experiment("inverse").perform(task);
  CHECK(clean.reading("error_max").value < 1e-12);
  CHECK(clean.reading("velocity_error_max").value < 1e-12);
  CHECK(clean.reading("coverage").value > 0.99);
  // f = f_b(t + t₁) + f_n(t − t₂) and f_b(t − t₁) + f_n(t + t₂): means of four readings of variance σ² each; the two
  // expressions of v have (1/2Z₀)² 2σ² each.
  constexpr double sigma = 0.01;
  task.sensor.noise = {{"bridge_force", sigma}, {"nut_force", sigma}};
  const auto noisy = find_experiment("inverse").perform(task);
  CHECK(noisy.reading("error_rms").value == Approx(sigma).epsilon(0.03));
  CHECK(noisy.reading("force_apart").value == Approx(sigma).epsilon(0.03));
  CHECK(noisy.reading("velocity_error_rms").value == Approx(sigma / (2 * 0.5)).epsilon(0.03));
  CHECK(noisy.reading("coverage").value > 0.99);
}

TEST_CASE("inverse: a cello string with losses, torsion and heat is reconstructed through its first periods",
          "[lab][string]") {
  auto task = string_task({}, "thermal");
  task.string->speed = {Signal(Signal::Ramp{0, 1.8})};
  task.string->load = {Signal(1.5)};
  const auto result = find_experiment("inverse").perform(task);
  REQUIRE(result.outcome.complete());
  INFO(result.reading("error_rms").value << " N rms, " << result.reading("error_max").value << " N, velocity "
                                         << result.reading("velocity_error_rms").value);
  CHECK(result.reading("error_rms").value < 1e-3 * result.reading("force_max").value);
  CHECK(result.reading("velocity_error_rms").value < 1e-3);
  CHECK(result.reading("coverage").value > 0.98);  // not beside jumps of friction
}

TEST_CASE("inverse: of which strings it cannot be told, and why", "[lab][string]") {
  const auto refused = [](const Task& task, const char* why) {
    CHECK_THROWS_WITH(find_experiment("inverse").perform(task), Catch::Contains(why));
  };
  auto task = string_task({}, "thermal");
  task.string->string.bow.contacts = 2;
  refused(task, "oscillator.bow.contacts");
  task = string_task({}, "thermal");
  task.string->string.body = {{300, 0.1, 30}};
  refused(task, "oscillator.body");
  task = string_task({}, "thermal");
  task.settings.set("samples", 1000.0);
  refused(task, "lab.samples has no effect on a string");
  task = string_task({}, "thermal");
  task.settings.set("duration", 0.05);
  refused(task, "too short");
  CHECK_THROWS_WITH(find_experiment("velocity-step").perform(string_task({}, "thermal")),
                    Catch::Contains("is no experiment on a string"));
}
