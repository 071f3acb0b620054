/// Experiments on machines that are structures, against the slider, closed forms and steady curves.
#include "analysis/lab/machine.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/structure_at_contact.hpp"

using namespace rosin;
using namespace rosin::analysis::lab;

namespace {

const std::vector<Value> rock = {0.6, 0.010, 0.015, 1e-5, 1e-6};  // mu0, a, b, L, v0

Task slider_of(const char* experiment, const char* law, std::vector<Value> values, oscillators::Slider slider,
               double load) {
  auto task = task_for(find_experiment(experiment), laws::find_law(law)->with(std::move(values)));
  task.model.slider = slider;
  task.model.drive.normal_load = load;
  return task;
}
Task as_structure(Task task, oscillators::Structure structure) {
  task.structure = std::move(structure);
  return task;
}
/// Before a second mass that is held by a spring.
oscillators::Structure two_masses(const Task& task, oscillators::Slider second) {
  return oscillators::two_mass_belt({task.model.slider, second}, oscillators::contact_of(task.model), 0.0);
}
Result done(const Task& task, const char* experiment) {
  auto result = find_experiment(experiment).perform(task);
  INFO(result.outcome.detail);
  REQUIRE(result.outcome.complete());
  return result;
}
/// All readings agree within the errors that both state, and `more` of the value.
void check_alike(const Result& one, const Result& other, double more = 0) {
  for (const auto& reading : one.readings) {
    const auto& its = other.reading(reading.name);
    INFO(reading.name << " = " << reading.value << " ± " << reading.error << " and " << its.value << " ± "
                      << its.error);
    CHECK(std::isnan(reading.value) == std::isnan(its.value));
    if (std::isnan(reading.value)) continue;
    CHECK(std::abs(reading.value - its.value) <= reading.error + its.error + more * std::abs(its.value) + 1e-15);
  }
}

struct Setup {
  const char *experiment, *law;
  std::vector<Value> values;
  oscillators::Slider slider;
  double load;
  std::vector<std::pair<const char*, Value>> settings;
};
const std::vector<Setup>& machines() {
  static const std::vector<Setup> list = {
      {"velocity-step", "ageing", rock, {1, 1e4, 100}, 1, {}},
      {"velocity-step", "slip", rock, {1, 1e4, 100}, 2, {}},
      {"velocity-step", "stribeck", {0.4, 0.25, 0.05, 1.0, 0.5}, {1, 50, 2}, 1, {{"speeds", std::vector{0.2, 0.4}}}},
      {"slide-hold-slide", "ageing", rock, {1, 1e4, 100}, 1, {{"hold_times", std::vector<double>{1, 10, 100}}}},
      {"reciprocation", "ageing", rock, {1e-3, 1e5, 10}, 10, {}},
      {"reciprocation", "coulomb", {0.4, 0.3}, {1e-4, 1e4, 20}, 5, {}},
      {"spring-pulled", "coulomb", {0.4, 0.3}, {1, 1.09, 0.02}, 2, {}},
      {"spring-pulled", "ageing", rock, {1, 100, 0}, 1, {}},
      {"spring-pulled", "ageing", rock, {1, 2000, 10}, 1, {}}};
  return list;
}
Task task_of(const Setup& machine) {
  auto task = slider_of(machine.experiment, machine.law, machine.values, machine.slider, machine.load);
  if (std::string_view(machine.law) == "coulomb") task.model.drive.speed = 0.01;
  for (const auto& [name, value] : machine.settings) task.settings.set(name, value);
  return task;
}

}  // namespace

TEST_CASE("lab: a structure of one coordinate reads as the slider that it is", "[lab-machine]") {
  for (const auto& machine : machines()) {
    INFO(machine.experiment << " of " << machine.law);
    const auto task = task_of(machine);
    check_alike(done(as_structure(task, oscillators::one_slider(task.model)), machine.experiment),
                done(task, machine.experiment));
  }
}

TEST_CASE("lab: with a frame a million times stiffer a machine of two masses reads as the slider",
          "[lab-machine][long]") {
  for (const auto& machine : machines()) {
    INFO(machine.experiment << " of " << machine.law);
    const auto task = task_of(machine);
    const double k = 1e6 * machine.slider.stiffness, m = machine.slider.mass;
    check_alike(done(as_structure(task, two_masses(task, {m, k, std::sqrt(k * m)})), machine.experiment),
                done(task, machine.experiment), 1e-5);
  }
}

TEST_CASE("lab: between velocity steps a machine of two masses bears the law's steady friction", "[lab-machine]") {
  auto task = slider_of("velocity-step", "ageing", rock, {1, 1e4, 100}, 2);
  task.settings.set("speeds", std::vector<double>{1e-6, 1e-5, 3e-6});
  const auto result = done(as_structure(task, two_masses(task, {0.5, 2e4, 100})), "velocity-step");
  const auto steady = [&](double v) { return task.model.law->steady_friction({v, 2}).friction; };
  const auto& before = result.reading("friction_before");
  CHECK(std::abs(before.value - steady(1e-6)) <= before.error + 1e-14);
  const auto& change = result.reading("final_change");
  CHECK(std::abs(change.value - (steady(1e-5) - steady(1e-6))) <= change.error);
  CHECK(std::abs(result.tables.front().values[3][1] - (steady(3e-6) - steady(1e-5))) < 1e-6);
}

TEST_CASE("lab: the loop of a machine of two masses has the springs in series where the force passes zero",
          "[lab-machine]") {
  // Slow enough that inertia and dampers are out of it: 1/(1/k + 1/k₂ + 1/k_t).
  auto task = slider_of("reciprocation", "ageing", rock, {1e-3, 2e5, 20}, 10);
  task.model.contact_stiffness.tangential = 1e5;
  task.settings.set("frequency", 0.02);
  const auto result = done(as_structure(task, two_masses(task, {1e-3, 5e4, 20})), "reciprocation");
  CHECK(result.reading("contact_stiffness").value == Approx(1 / (1 / 2e5 + 1 / 5e4 + 1 / 1e5)).epsilon(2e-3));
}

TEST_CASE("lab: stick-slip of two masses has the cycle's period and the drop of the spring between them",
          "[lab-machine]") {
  auto task = slider_of("spring-pulled", "coulomb", {0.4, 0.3}, {1, 100, 1}, 20);
  task.model.drive.speed = 0.02;
  const auto structure = two_masses(task, {0.3, 400, 2});
  const auto weights = oscillators::spring_force(structure);
  CHECK(weights[0] == Approx(100).epsilon(1e-14));  // k (x − y)
  CHECK(weights[1] == Approx(-100).epsilon(1e-14));
  const auto result = done(as_structure(task, structure), "spring-pulled");
  analysis::motion::StructureModel model{structure, {}};
  model.start.kind = analysis::motion::Start::Kind::rest;
  const auto cycle = analysis::cycles::find_cycle(model, {.tolerance = 1e-10});
  REQUIRE(cycle.returns > 0);
  const auto& period = result.reading("period");
  CHECK(std::abs(period.value - cycle.metrics.at("period").value) <= period.error);
  // The record of several periods, sample by sample, shows the same drop.
  const auto &x = result.record.column("displacement"), &y = result.record.column("second_displacement");
  double low = infinity, high = -infinity;
  for (std::size_t i = x.size() / 2; i < x.size(); ++i)
    low = std::min(low, 100 * (x[i] - y[i])), high = std::max(high, 100 * (x[i] - y[i]));
  CHECK(result.reading("force_drop").value == Approx(high - low).epsilon(1e-3));
  CHECK(result.reading("force_drop").error < 1e-6);
}

TEST_CASE("lab: blocks in a row read by their total friction over the total load", "[lab-machine]") {
  // Two equal blocks that share one speed are one block of twice the mass, spring and load.
  auto task = slider_of("velocity-step", "ageing", rock, {1, 1e4, 100}, 1);
  const auto contact = oscillators::contact_of(task.model);
  const auto row = oscillators::chain({.mass = {1, 1},
                                       .coupling_stiffness = {500},
                                       .coupling_damping = {0},
                                       .pull_stiffness = {1e4, 1e4},
                                       .pull_damping = {100, 100}},
                                      {contact, contact});
  const auto together = done(as_structure(task, row), "velocity-step");
  check_alike(together, done(task, "velocity-step"));
  CHECK(together.record.column("friction_force").front() ==
        Approx(2 * together.record.column("friction_force_1").front()).epsilon(1e-12));
}

TEST_CASE("lab: a threshold in load is that at which the machine of two masses loses steady sliding", "[lab-machine]") {
  auto task = slider_of("spring-pulled", "ageing", rock, {1, 2000, 10}, 1);
  const auto structure = two_masses(task, {0.3, 6000, 5});
  const auto result = done(as_structure(task, structure), "spring-pulled");
  const double critical = result.reading("critical_load").value;
  for (const double part : {0.999, 1.001}) {
    auto loaded = structure;
    loaded.contacts[0].normal_load = part * critical;
    CHECK(analysis::steady::stability(loaded).stable == (part < 1));
  }
  // Both springs softer by one factor: the stiffness at the contact is k k₂/(k + k₂).
  const double stiffness = result.reading("critical_stiffness").value, factor = stiffness / 1500;
  for (const double part : {0.999, 1.001}) {
    auto softer = structure;
    softer.K *= part * factor;
    CHECK(analysis::steady::stability(softer).stable == (part > 1));
  }
}

TEST_CASE("lab: experiments on a block alone refuse machines with the reason", "[lab-machine]") {
  for (const auto& [name, reason] : {std::pair{"inclined-plane", "no frame holds it"},
                                     {"impulse", "swinging"},
                                     {"inverse", "rosin fit"},
                                     {"frequency-response", "rosin frf"}}) {
    auto task = task_for(find_experiment(name), laws::find_law("coulomb"));
    task.model.slider = {1, 1, 0};
    CHECK_THROWS_WITH(find_experiment(name).perform(as_structure(task, oscillators::one_slider(task.model))),
                      Catch::Contains(reason));
  }
}
