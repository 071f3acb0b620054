/// Elastic-perfectly-plastic contacts (Jenkins elements): resonance, hysteresis, several in parallel, loads that vary.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/lyapunov.hpp"
#include "analysis/cycles/section_map.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::cycles;
using motion::Start;
using motion::StructureModel;
using oscillators::Model;

namespace {

constexpr double friction = 0.2, spring = 0.25;  // N, N/m

Signal cosine(double mean, double amplitude, double angular_frequency, double phase = 0) {
  return Signal(Signal::Harmonics{mean, {{amplitude, angular_frequency, phase}}});
}

/// 1 kg on 0.75 N/m and 0.02 N s/m, driven near resonance.
Model damper() {
  Model model;
  model.law = laws::find_law("coulomb")->with({friction, friction});
  model.contact_stiffness.tangential = spring;
  model.slider = {.mass = 1, .stiffness = 0.75, .damping = 0.02};
  model.drive = {.speed = 0.0, .normal_load = 1.0, .force = cosine(0, 0.1, 0.95)};
  return model;
}

StructureModel from_rest(oscillators::Structure structure) {
  StructureModel model{std::move(structure), {}};
  model.start.kind = Start::Kind::rest;
  return model;
}

StructureCycle cycle_of(const Model& model) { return find_cycle(from_rest(oscillators::one_slider(model)), {}); }
double value(const StructureCycle& cycle, const std::string& name) { return cycle.metrics.at(name).value; }
double error(const StructureCycle& cycle, const std::string& name) { return cycle.metrics.at(name).error; }

}  // namespace

TEST_CASE("a friction damper resonates as the independent solution does, and its loop is that of the amplitude",
          "[dry-spring]") {
  const auto cycle = cycle_of(damper());
  REQUIRE(cycle.outcome.complete());
  const double X = value(cycle, "displacement_amplitude");
  CHECK(std::abs(X - 1.0821910804) < error(cycle, "displacement_amplitude") + 5e-11);
  CHECK(error(cycle, "displacement_amplitude") < 1e-8);
  CHECK(std::abs(value(cycle, "friction_work") - 4 * friction * (X - friction / spring)) <
        error(cycle, "friction_work") + 4 * friction * error(cycle, "displacement_amplitude"));
  // It sticks from each reversal until the spring has gone from one limit to the other.
  CHECK(std::ranges::count(cycle.events, "stick", &motion::RunEvent::kind) == 2);
  CHECK(std::ranges::count(cycle.events, "slip", &motion::RunEvent::kind) == 2);
  CHECK(cycle.symmetry == "symmetric");
  CHECK(cycle.stable);
}

TEST_CASE("the derivative of a period of a friction damper is that of neighbouring periods", "[dry-spring]") {
  const auto cycle = cycle_of(damper());
  SectionMap map(oscillators::one_slider(damper()));
  const auto there = map.follow(cycle.start, 1e-11, 1, true);
  constexpr double aside = 1e-5;
  for (std::size_t i = 0; i < cycle.start.size(); ++i) {
    auto ahead = cycle.start, behind = cycle.start;
    ahead[i] += aside, behind[i] -= aside;
    const auto after = map.follow(ahead, 1e-12, 1, false).y, before = map.follow(behind, 1e-12, 1, false).y;
    for (std::size_t k = 0; k < after.size(); ++k)
      CHECK(there.derivative(Eigen::Index(k), Eigen::Index(i)) ==
            Approx((after[k] - before[k]) / (2 * aside)).margin(2e-6));
  }
}

TEST_CASE("friction dampers under a load that varies move as by Verlet's method with return mapping", "[dry-spring]") {
  // 2e4, 4e4 and 8e4 steps in each of 600 periods, whose differences fall to 1e-8 m.
  auto model = damper();
  model.drive.normal_load = cosine(1, 0.3, 0.95, 1);
  const auto of_constant_stiffness = cycle_of(model);
  REQUIRE(of_constant_stiffness.outcome.complete());
  CHECK(std::abs(value(of_constant_stiffness, "displacement_max") - 1.13910351) < 2e-8);
  CHECK(std::abs(value(of_constant_stiffness, "displacement_min") + 1.08494519) < 2e-8);
  model.contact_stiffness = {.per_load = spring};
  const auto of_stiffness_by_load = cycle_of(model);
  REQUIRE(of_stiffness_by_load.outcome.complete());
  CHECK(std::abs(value(of_stiffness_by_load, "displacement_max") - 1.07271982) < 3e-8);
  CHECK(std::abs(value(of_stiffness_by_load, "displacement_min") + 1.07869736) < 3e-8);
}

TEST_CASE("a damper beside the spring makes it relax in slip", "[dry-spring]") {
  // F = the spring's force k e + c u up to the limit, c de/dt = F - k e: Runge and Kutta's fourth order with 4e4 steps
  // in each of 500 periods, which differ by 1e-9 m from 2e4.
  auto model = damper();
  model.contact_stiffness.damping = 0.02;
  const auto cycle = cycle_of(model);
  REQUIRE(cycle.outcome.complete());
  CHECK(std::abs(value(cycle, "displacement_amplitude") - 0.961430073) < 3e-9);
}

TEST_CASE("parallel elements on one coordinate dissipate what each would", "[dry-spring]") {
  auto structure = oscillators::one_slider(damper());
  const auto element = structure.contacts.front();
  structure.contacts.clear();
  double work = 0;
  for (int i = 1; i <= 4; ++i) {
    structure.contacts.push_back(element);
    structure.contacts.back().stiffness.tangential = 0.05;
    structure.contacts.back().normal_load = 0.05 * i;
  }
  const auto cycle = find_cycle(from_rest(structure), {});
  REQUIRE(cycle.outcome.complete());
  const double X = value(cycle, "displacement_amplitude");
  for (int i = 1; i <= 4; ++i) work += 4 * 0.01 * i * std::max(X - 0.2 * i, 0.0);
  CHECK(work > 0);
  CHECK(std::abs(value(cycle, "friction_work") - work) < error(cycle, "friction_work") + 1e-8);
  CHECK(value(cycle, "stick_fraction_1") < value(cycle, "stick_fraction_4"));
}

TEST_CASE("below its limit a friction damper is a spring, and beyond it adds none", "[dry-spring]") {
  auto model = damper();
  model.drive.force = 0.0, model.slider.damping = 0;
  const auto frequency = [&] {
    double highest = 0;
    for (const auto& z : steady::stability(oscillators::one_slider(model)).eigenvalues)
      highest = std::max(highest, z.imag());
    return highest;
  };
  CHECK(std::abs(frequency() - std::sqrt(0.75 + spring)) < 1e-12);
  model.drive.speed = 0.1;
  CHECK(std::abs(frequency() - std::sqrt(0.75)) < 1e-12);
}
