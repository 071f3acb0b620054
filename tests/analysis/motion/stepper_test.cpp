/// Steps of a given length against their own exact theory, and the limits of explicit ones.
#include "analysis/motion/stepper.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/steady/sliding_modes.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using namespace rosin::oscillators;
using Eigen::VectorXd;

namespace {

/// m = 2, k = 3 of the spring and 5 of a contact without friction that never opens: ω = 2.
Structure oscillator() {
  Structure structure;
  structure.M = Eigen::MatrixXd::Constant(1, 1, 2), structure.K = Eigen::MatrixXd::Constant(1, 1, 3);
  structure.C = Eigen::MatrixXd::Zero(1, 1);
  structure.names = {"displacement"};
  structure.contacts = {frictionless_contact(VectorXd::Ones(1),
                                             laws::normal_law(laws::LinearContact{.stiffness = 5, .lift_off = false}))};
  structure.contacts[0].normal_load = 0.0;
  return structure;
}

double displacement_after(const Stepping& stepping, double time) {
  const auto structure = oscillator();
  const StationForces contacts(structure);
  const auto stepper = make_stepper(structure, contacts, stepping, VectorXd::Ones(1), VectorXd::Zero(1));
  for (long k = 0, steps = std::lround(time / stepping.step); k < steps; ++k) REQUIRE(stepper->advance().complete());
  return stepper->coordinates()[0];
}

}  // namespace

TEST_CASE("average acceleration keeps the amplitude and slows the frequency as its theory says") {
  for (const double h : {0.01, 0.1, 1.0}) {
    const double omega = 2 / h * std::atan(2 * h / 2), t = 50 * h;
    CHECK(displacement_after({.step = h}, t) == Approx(std::cos(omega * t)).margin(1e-10));
  }
}

TEST_CASE("generalised-alpha and explicit steps converge with the second power of the step") {
  constexpr double t = 3, exact_step = 0.02;
  const double exact = std::cos(2 * t);
  for (const Stepping& scheme : {Stepping{Scheme::generalised_alpha, 0, 0.5}, Stepping{Scheme::explicit_steps}}) {
    Stepping coarse = scheme, fine = scheme;
    coarse.step = exact_step, fine.step = exact_step / 2;
    const double error = displacement_after(coarse, t) - exact, finer = displacement_after(fine, t) - exact;
    CHECK(error / finer == Approx(4).epsilon(0.02));
    CHECK(std::abs(finer) < 1e-3);
  }
  // With nothing taken from the fastest motion it is the midpoint rule, which keeps the energy.
  const double h = 0.5, omega = 2 / h * std::atan(h);
  CHECK(displacement_after({Scheme::generalised_alpha, h, 1}, 20) == Approx(std::cos(omega * 20)).margin(1e-10));
}

TEST_CASE("explicit steps of a block are bounded by its fastest vibration alone, and bear stick") {
  const auto longest = [&](const Structure& structure) {
    const StationForces contacts(structure);
    return longest_explicit_step(structure, contacts, analysis::steady::steady_sliding(structure, contacts));
  };
  const FlatBlock undamped{.lumped = true, .damped = false}, damped{.lumped = true};
  // 2/ω of the free block, 0.013747821, falls by what the contact adds to ω.
  CHECK(longest(undamped.structure()) == Approx(.013747821).epsilon(1e-4));
  CHECK(longest(damped.structure()) == Approx(.01278).epsilon(5e-4));

  const VectorXd at_rest = FlatBlock{}.mesh().rigid(0, -1, 0);
  const auto structure = damped.structure();
  const StationForces contacts(structure);
  const auto begin = [&](const Structure& of, double step) {
    return make_stepper(of, StationForces(of), {.scheme = Scheme::explicit_steps, .step = step}, at_rest,
                        VectorXd::Zero(of.size()));
  };
  CHECK_THROWS_WITH(begin(structure, 0.02), Catch::Contains("longer than 0.0127"));
  CHECK_THROWS_WITH(begin(FlatBlock{}.structure(), 1e-4), Catch::Contains("diagonal mass"));
  // A block that the belt takes along sticks at once, where friction stops a node within 0.95 ms.
  const auto stuck = make_stepper(structure, contacts, {Scheme::explicit_steps, 0.012, 0.8, 0.01}, at_rest,
                                  FlatBlock{}.mesh().rigid(1, 0, 0));
  for (int i = 0; i < 40; ++i) {
    REQUIRE(stuck->advance().complete());
    const VectorXd rate = contacts.rows() * stuck->velocities();
    for (const auto& contact : contacts.contacts()) CHECK(std::abs(1 - rate[contact.slip]) < 0.01);
  }
}

TEST_CASE("steps of a given length are refused where they would miss stops and stick") {
  const auto begin = [](const Structure& structure) {
    return make_stepper(structure, StationForces(structure), {.step = 0.1}, VectorXd::Ones(1), VectorXd::Zero(1));
  };
  auto with_stop = oscillator();
  with_stop.stops = {{.coordinate = 0, .at = 1}};
  CHECK_THROWS_WITH(begin(with_stop), Catch::Contains("end stops"));
  auto sticking = oscillator();
  sticking.contacts[0].tangential = VectorXd::Ones(1);
  sticking.contacts[0].law = laws::find_law("coulomb");
  CHECK_THROWS_WITH(begin(sticking), Catch::Contains("contact 1") && Catch::Contains("solver.smoothing"));
}
