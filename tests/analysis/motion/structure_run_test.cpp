/// Runs of structures: against the slider's, against closed forms, and in their balance of energy.
#include "analysis/motion/structure_run.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "laws/catalogue.hpp"
#include "laws/smoothing.hpp"
#include "oscillators/structure_system.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using rosin::oscillators::contact_of;
using rosin::oscillators::FrictionContact;
using rosin::oscillators::Model;
using rosin::oscillators::StructureSystem;

namespace {

const std::vector<double>& column(const Run& run, const std::string& name) {
  const auto at = std::find(run.column_names.begin(), run.column_names.end(), name);
  REQUIRE(at != run.column_names.end());
  return run.columns[std::size_t(at - run.column_names.begin())];
}
double error_of(const Run& run, const std::string& name) {
  const auto at = std::find(run.column_names.begin(), run.column_names.end(), name);
  return run.column_error[std::size_t(at - run.column_names.begin())];
}

RunOptions short_run(double duration, double tolerance) {
  RunOptions options;
  options.duration = duration, options.samples = 2 * int(duration), options.tolerance = tolerance;
  return options;
}

/// Three blocks that move as one: each on the slider's spring, and coupled to its neighbours.
StructureModel in_step(const Model& model) {
  const auto& s = model.slider;
  return {.structure = oscillators::chain({.mass = std::vector<double>(3, s.mass),
                                           .coupling_stiffness = {7, 3},
                                           .coupling_damping = {0.2, 0.1},
                                           .pull_stiffness = std::vector<double>(3, s.stiffness),
                                           .pull_damping = std::vector<double>(3, s.damping)},
                                          std::vector<FrictionContact>(3, contact_of(model))),
          .start = {}};
}

}  // namespace

TEST_CASE("blocks in step move as one slider, through stick, steps of the drive and states") {
  Model model;
  model.slider = {1, 2, 0.1};
  model.drive.speed = Signal(Signal::Steps{{{0, 0.1}, {6, 0.3}}});
  model.drive.normal_load = 2.0;
  const auto law = GENERATE("coulomb", "hyperbolic", "ageing", "lugre");
  model.law = laws::find_law(law);
  if (law == std::string("ageing")) model.law = model.law->with({0.6, 0.02, 0.01, 0.05, 0.1});
  if (law == std::string("lugre")) model.contact_stiffness = {};
  INFO(law);
  RunOptions options = short_run(20, 1e-8);
  options.start.kind = Start::Kind::rest;
  auto blocks = in_step(model);
  blocks.start.kind = Start::Kind::rest;
  const Run one = run(model, options), three = run_structure(blocks, options);
  INFO(one.outcome.detail);
  REQUIRE(one.outcome.complete());
  INFO(three.outcome.detail);
  REQUIRE(three.outcome.complete());
  for (const std::string name : {"displacement", "velocity", "slip_rate", "friction_force"})
    for (const char* block : {"_1", "_3"}) {
      const auto &a = column(one, name), &b = column(three, name + block);
      const double known = error_of(one, name) + error_of(three, name + block);
      REQUIRE(a.size() == b.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        INFO(name << block << " at " << one.time[i] << " s");
        CHECK(b[i] == Approx(a[i]).margin(3 * known));
      }
    }
  if (model.law->set_valued()) CHECK(three.events.size() == 3 * one.events.size());
  CHECK(three.metrics.at("energy_residual") < 1e-7);
}

TEST_CASE("a block drags a free second mass along: the second integral of friction moves both") {
  // The momentum of both is the impulse of friction, m V̇ of nothing else acting.
  StructureModel model;
  FrictionContact contact;
  contact.law = laws::find_law("coulomb")->with({0.3, 0.3});
  contact.speed = 50.0;  // faster than the masses ever get
  contact.normal_load = 2.0;
  model.structure = oscillators::two_mass_belt({{1, 4, 0.3}, {2, 0, 0}}, contact, 0.0);
  model.start.kind = Start::Kind::given;
  const Run run = run_structure(model, short_run(10, 1e-9));
  INFO(run.outcome.detail);
  REQUIRE(run.outcome.complete());
  const auto &x = column(run, "velocity"), &y = column(run, "second_velocity");
  for (std::size_t i = 0; i < run.time.size(); ++i)
    CHECK(x[i] + 2 * y[i] ==
          Approx(0.6 * run.time[i]).margin(error_of(run, "velocity") + 2 * error_of(run, "second_velocity")));
  CHECK(run.events.empty());
  CHECK(run.metrics.at("energy_residual") < 1e-9);
}

TEST_CASE("circulatory stiffness feeds a whirl, and the balance of energy counts its work") {
  StructureModel model;
  auto& s = model.structure;
  s.M = Eigen::Matrix2d::Identity();
  s.K = Eigen::Matrix2d{{1, 0.2}, {-0.2, 1}};
  s.C = Eigen::Matrix2d::Zero();
  s.names = {"displacement_1", "displacement_2"};
  model.start.kind = Start::Kind::given;
  model.start.coordinates = {1.0, 0.0};
  const Run run = run_structure(model, short_run(8, 1e-9));
  INFO(run.outcome.detail);
  REQUIRE(run.outcome.complete());
  // x₁ + i x₂ = z: z̈ = −(1 − 0.2i) z, from 1 at rest.
  const std::complex<double> w = std::sqrt(std::complex<double>(1, -0.2));
  const auto &x = column(run, "displacement_1"), &y = column(run, "displacement_2");
  for (std::size_t i = 0; i < run.time.size(); ++i) {
    const auto z = std::cos(w * run.time[i]);
    CHECK(x[i] == Approx(z.real()).margin(error_of(run, "displacement_1")));
    CHECK(y[i] == Approx(z.imag()).margin(error_of(run, "displacement_2")));
  }
  CHECK(run.metrics.at("energy_residual") < 1e-9);
}

TEST_CASE("a steady start stays steady, and is refused where nothing holds the structure") {
  FrictionContact contact;
  contact.law = laws::find_law("stribeck");
  contact.normal_load = 3.0;
  StructureModel model{.structure = oscillators::two_mass_belt({{1, 4, 5}, {2, 3, 5}}, contact, 0.5), .start = {}};
  const RunOptions options = short_run(5, 1e-8);
  const Run run = run_structure(model, options);
  INFO(run.outcome.detail);
  REQUIRE(run.outcome.complete());
  const auto& x = column(run, "second_displacement");
  CHECK(x.back() == Approx(x.front()).epsilon(1e-9));
  CHECK(run.remark.empty());
  auto falling = model;
  falling.structure.contacts[0].law = laws::find_law("hyperbolic");
  falling.structure.C.setZero();
  CHECK_THAT(run_structure(falling, options).remark, Catch::Contains("steady sliding is unstable"));
  model.structure = oscillators::two_mass_belt({{1, 4, 5}, {2, 0, 5}}, contact, 0.5);
  CHECK_THROWS_WITH(run_structure(model, options), Catch::Contains("no steady sliding"));
  RunOptions other = options;
  other.solver = "cvode";
  CHECK_THROWS_WITH(run_structure(model, other), Catch::Contains("solver 'cvode' does not serve a structure"));
}

TEST_CASE("flutter of the minimal model grows as its eigenvalue says, until the block sticks or lifts off") {
  // Hoffmann, Fischer, Allgaier & Gaul (2002), springs at 150° and 30°: s² = −2 ∓ √(1 − 4μ/3).
  constexpr double mu = 0.9, pi = std::numbers::pi;
  FrictionContact contact;
  contact.law = laws::find_law("coulomb")->with({mu, mu});
  contact.normal_load = 10.0;
  contact.speed = 2.0;
  StructureModel model;
  model.structure = oscillators::mode_coupling(
      {.springs = {{2.0 / 3 * (2 - std::sqrt(3.0)), 150 * pi / 180}, {2.0 / 3 * (2 + std::sqrt(3.0)), 30 * pi / 180}},
       .contact = laws::normal_law(laws::LinearContact{.stiffness = 4.0 / 3})},
      contact, 0.0);
  const auto still = StructureSystem(model.structure).steady(0);
  model.start.kind = Start::Kind::given;
  model.start.coordinates = {still[0] + 1e-3, still[1]};
  // Once the decaying mode has gone, each period of slip is e^(growth·period) times the one before.
  const auto w = std::sqrt(std::complex<double>(2, -std::sqrt(4 * mu / 3 - 1)));
  const double periods = 3 * 2 * pi / w.real();
  const auto follow = [&](double duration, std::vector<double> times) {
    RunOptions options;
    options.duration = duration, options.times = std::move(times), options.tolerance = 1e-8;
    return run_structure(model, options);
  };
  const Run run = follow(40, {20, 20 + periods});
  INFO(run.outcome.detail);
  REQUIRE(run.outcome.complete());
  const auto& y = column(run, "normal_displacement");
  CHECK(std::log((y[1] - still[1]) / (y[0] - still[1])) / periods == Approx(-w.imag()).epsilon(2e-3));
  CHECK(run.events.empty());
  CHECK(run.metrics.at("energy_residual") < 1e-9);
  const Run later = follow(200, {});
  CHECK_FALSE(later.events.empty());  // the growth ends in stick
  CHECK(later.metrics.at("normal_load_min") == 0);
  CHECK(later.metrics.at("energy_residual") < 1e-7);
}

TEST_CASE("errors of smoothed blocks hold although friction has a kink at each reversal", "[structures][smoothing]") {
  // m = (1, 2), k = (1, 0.5), coupling 0.4, belt 0.5, friction 1/(1 + |v|) (2/pi) arctan(v/0.01): an independent
  // integration of order 8, begun anew at every zero of a slip rate. At 1, 2, 5, 10, 20, 30 s.
  const double places[2][6] = {
      {0.49337386751, -0.50518520075, 0.90821482968, -0.05503692883, -0.03855105177, 0.58313323661},
      {-0.08873334876, 1.20103380909, 1.40424188649, 0.46448029702, -0.42970965420, -0.14939766886}};
  const double velocities[2][6] = {
      {-1.19369889551, -0.45380357641, 0.48229461084, 0.50462839674, -0.92077105365, 0.46920354871},
      {1.49850544950, 0.93365245791, -0.49528186580, 0.26277233716, 0.41121194131, -0.74355400493}};
  FrictionContact contact;
  contact.law = laws::smoothed(laws::find_law("hyperbolic")->with({1.0, 1.0}), {laws::Smoothing::Type::arctan, 0.01});
  contact.speed = 0.5;
  oscillators::Chain chain;
  chain.mass = {1, 2};
  chain.coupling_stiffness = {0.4}, chain.coupling_damping = {0};
  chain.pull_stiffness = {1, 0.5}, chain.pull_damping = {0, 0};
  StructureModel model{oscillators::chain(chain, {contact, contact}), {}};
  model.start.kind = Start::Kind::given;
  model.start.coordinates = {1.2, -1.5}, model.start.velocities = {0, 1.2};
  for (const double tolerance : {1e-6, 1e-8}) {
    RunOptions options;
    options.times = {1, 2, 5, 10, 20, 30}, options.duration = 30, options.tolerance = tolerance;
    const Run run = run_structure(model, options);
    REQUIRE(run.outcome.complete());
    for (const int block : {0, 1}) {
      const auto number = std::to_string(block + 1);
      const auto &x = column(run, "displacement_" + number), &v = column(run, "velocity_" + number);
      for (int i = 0; i < 6; ++i) {
        CAPTURE(tolerance, block, i);
        CHECK(std::abs(x[i] - places[block][i]) < error_of(run, "displacement_" + number));
        CHECK(std::abs(v[i] - velocities[block][i]) < error_of(run, "velocity_" + number));
      }
    }
  }
}

TEST_CASE("a jump of the drive frees a contact, and is told as its switch", "[structures]") {
  // A block at rest on a belt at rest, and from 2 s on pulled by twice its friction: x = (2 − 1)(1 − cos(t − 2)), which
  // comes to rest half a period later.
  Model model;
  model.law = laws::find_law("coulomb")->with({1.0, 1.0});
  model.slider = {1, 1, 0};
  model.drive = {.speed = 0.0, .normal_load = 1.0, .force = Signal(Signal::Steps{{{0, 0.0}, {2, 2.0}}})};
  StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = Start::Kind::rest;
  const auto run = run_structure(structure, short_run(8, 1e-8));
  REQUIRE(run.outcome.complete());
  REQUIRE(run.events.size() == 2);
  CHECK(run.events[0].kind == "slip");
  CHECK(run.events[0].time == 2);
  CHECK(run.events[1].kind == "stick");
  CHECK(std::abs(run.events[1].time - (2 + std::numbers::pi)) <= run.events[1].error);
  // A belt that slows down under a block at rest on it: slip of the block, listed with its onset.
  model.drive = {.speed = Signal(Signal::Steps{{{0, 0.5}, {1, 0.2}}}), .normal_load = 1.0, .force = 0.0};
  structure.structure = oscillators::one_slider(model);
  const auto slowed = run_structure(structure, short_run(2, 1e-8));
  REQUIRE(slowed.outcome.complete());
  REQUIRE(slowed.events.size() >= 2);
  CHECK(slowed.events[0].kind == "slip");
}

TEST_CASE("extremes count the start in the modes that it is in", "[structures]") {
  Model model;
  model.law = laws::find_law("coulomb")->with({0.5, 0.4});
  model.slider = {1, 1, 0};
  model.drive = {.speed = 0.1, .normal_load = 1.0, .force = 0.0};
  StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = Start::Kind::given;
  structure.start.coordinates = {-1.0}, structure.start.velocities = {0.5};  // faster than the belt
  const auto run = run_structure(structure, short_run(1, 1e-8));
  CHECK(run.metrics.at("friction_force_max") == Approx(-0.4));
}
