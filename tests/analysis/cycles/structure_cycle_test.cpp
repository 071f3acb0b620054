/// Periodic motions of structures: against closed forms, an independent integrator, and differences of the map.
#include "analysis/cycles/structure_cycle.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/section_map.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::cycles;
using analysis::motion::Start;
using analysis::motion::StructureModel;
using oscillators::Model;

namespace {

Signal cosine(double amplitude, double angular_frequency) {
  return Signal(Signal::Harmonics{0, {{amplitude, angular_frequency, 0}}});
}

StructureModel from_rest(oscillators::Structure structure) {
  StructureModel model{std::move(structure), {}};
  model.start.kind = Start::Kind::rest;
  return model;
}

/// m = k = 1, no damper, under Coulomb friction.
Model dry_oscillator(double static_friction, double kinetic_friction) {
  Model model;
  model.law = laws::find_law("coulomb")->with({static_friction, kinetic_friction});
  model.slider = {1, 1, 0};
  model.drive.speed = 0.0, model.drive.normal_load = 1.0;
  return model;
}

double value(const StructureCycle& cycle, const std::string& name) { return cycle.metrics.at(name).value; }
double error(const StructureCycle& cycle, const std::string& name) { return cycle.metrics.at(name).error; }

}  // namespace

TEST_CASE("forced response with dry friction has Den Hartog's amplitude, and stops where the closed form stops") {
  struct Row {
    double frequency, static_friction, kinetic_friction, amplitude, stick, multiplier;
  };
  // Pieces in closed form, ends with 30 digits.
  const Row rows[] = {{0.7, 0.3, 0.3, 1.88569985, 0, 0.50980108},
                      {0.5, 0.6, 0.6, 1.25159434003394, 0.2189294553114, 0.037629913626},
                      {0.5, 0.7, 0.5, 1.34095387715457, 0.2586875927881, 0.21695464853},
                      {0.1, 0.5, 0.5, 0.499884599212611, 0.585788164971, 0.038555033142}};
  for (const auto& row : rows) {
    INFO(row.frequency << ' ' << row.static_friction);
    auto model = dry_oscillator(row.static_friction, row.kinetic_friction);
    model.drive.force = cosine(1, row.frequency);
    const auto cycle = find_cycle(from_rest(oscillators::one_slider(model)), {});
    REQUIRE(cycle.outcome.complete());
    CHECK(cycle.returns == 1);
    CHECK(cycle.symmetry == "symmetric");
    CHECK(std::abs(value(cycle, "displacement_max") - row.amplitude) < error(cycle, "displacement_max") + 5e-9);
    CHECK(error(cycle, "displacement_max") < 1e-8);
    CHECK(std::abs(value(cycle, "stick_fraction") - row.stick) < error(cycle, "stick_fraction") + 1e-12);
    REQUIRE_FALSE(cycle.multipliers.empty());
    CHECK(std::abs(std::abs(cycle.multipliers.front()) - row.multiplier) < 1e-8);
    CHECK(cycle.stable);
  }
}

TEST_CASE("a block on a belt sticks and slips with the closed form's period, and forgets all disturbances") {
  auto model = dry_oscillator(1, 0.6);
  model.drive.speed = 0.2;
  const auto cycle = find_cycle(from_rest(oscillators::one_slider(model)), {});
  REQUIRE(cycle.outcome.complete());
  const double excess = 0.4, V = 0.2;
  const double slip = 2 * std::numbers::pi - 2 * std::atan(excess / V), stick = 2 * excess / V;
  CHECK(std::abs(value(cycle, "period") - slip - stick) < error(cycle, "period") + 1e-13);
  CHECK(value(cycle, "displacement_max") == Approx(0.6 + std::hypot(excess, V)).epsilon(1e-9));
  REQUIRE(cycle.events.size() == 2);
  REQUIRE(cycle.multipliers.size() == 1);
  CHECK(std::abs(cycle.multipliers[0]) < 1e-9);
}

TEST_CASE("multipliers through stick, release and reversal are those of differences of the map") {
  // Three periods of the force, two sticks; and two masses of which one sticks and a force jumps at release.
  auto model = dry_oscillator(1, 1);
  oscillators::Structure structure;
  std::vector<double> y;
  int returns = 1;
  SECTION("a force that falls with slip rate: release without a jump") {
    model.law = laws::find_law("hyperbolic")->with({1.0, 3.0});
    model.drive.speed = 0.1, model.drive.force = cosine(0.5, 2);
    structure = oscillators::one_slider(model);
    y = {0.145709098504, 0.1 + 0.263099317854};
    returns = 3;
  }
  SECTION("kinetic below static friction: release with a jump, masses shared") {
    model.law = laws::find_law("coulomb")->with({0.5, 0.3});
    auto contact = contact_of(model);
    contact.speed = 0.1;
    structure = oscillators::two_mass_belt({{1, 1, 0.05}, {0.8, 1.5, 0.03}}, contact, cosine(0.4, 0.9));
    structure.M(0, 1) = structure.M(1, 0) = 0.2;
    y = {0.2, 0.1, 0.25, 0.1};
  }
  SectionMap map(structure);
  const auto there = map.follow(y, 1e-13, returns, true);
  REQUIRE(there.outcome.ending == Ending::event);
  const int n = int(y.size());
  constexpr double aside = 1e-6;
  for (int k = 0; k < n; ++k) {
    auto ahead = y, behind = y;
    ahead[k] += aside, behind[k] -= aside;
    const auto a = map.follow(ahead, 1e-14, returns, false).y, b = map.follow(behind, 1e-14, returns, false).y;
    for (int i = 0; i < n; ++i) {
      INFO(i << ' ' << k);
      CHECK(there.derivative(i, k) == Approx((a[i] - b[i]) / (2 * aside)).margin(3e-6));
    }
  }
}

TEST_CASE("two masses under rate-and-state friction have the limit cycle of an independent integrator") {
  Model model;
  model.law = laws::find_law("ageing");
  auto values = model.law->values();
  const auto set = [&](const std::string& name, double v) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (model.law->parameters()[i].name == name) values[i] = v;
  };
  set("mu0", 0.6), set("a", 0.02), set("b", 0.035), set("L", 0.1), set("v0", 0.1);
  model.law = model.law->with(values);
  model.drive.speed = 0.1, model.drive.normal_load = 3.8;
  const auto chain = oscillators::chain({{1, 1}, {0.5}, {0}, {1, 1.5}, {0, 0}}, {contact_of(model), contact_of(model)});
  const auto cycle = find_cycle(from_rest(chain), {});
  REQUIRE(cycle.outcome.complete());
  CHECK(value(cycle, "period") == Approx(7.84336700935).epsilon(1e-10));
  CHECK(value(cycle, "displacement_1_max") == Approx(2.1448410018).epsilon(1e-9));
  REQUIRE(cycle.multipliers.size() == 5);
  CHECK(cycle.multipliers[0].real() == Approx(0.8116420).epsilon(1e-6));
  CHECK(std::abs(cycle.multipliers[1] - std::complex(-0.3953056, 0.0828212)) < 2e-7);
}

TEST_CASE("a drive without a period, none at all, and motions that grow or die out are told apart") {
  auto model = dry_oscillator(0.3, 0.3);
  CHECK_THROWS_WITH(find_cycle(from_rest(oscillators::one_slider(model)), {}),
                    Catch::Contains("nothing drives the structure"));
  model.drive.force = Signal(Signal::Harmonics{0, {{1, 1, 0}, {1, std::sqrt(2.0), 0}}});
  CHECK_THROWS_WITH(find_cycle(from_rest(oscillators::one_slider(model)), {}), Catch::Contains("no common period"));
  model.drive.force = Signal(Signal::Ramp{0, 1});
  CHECK_THROWS_WITH(find_cycle(from_rest(oscillators::one_slider(model)), {}), Catch::Contains("has no period"));
  // At resonance friction holds amplitudes of the force below 4/π of itself only.
  model.drive.force = cosine(0.5, 1);
  const auto grows = find_cycle(from_rest(oscillators::one_slider(model)), {.tolerance = 1e-6});
  CHECK(grows.outcome.ending == Ending::unbounded);
  // Friction that rises with slip rate: steady sliding.
  model.law = laws::find_law("coulomb")->with({0.3, 0.3});
  model.slider.damping = 0.2, model.drive.force = 0.0, model.drive.speed = 0.5;
  const auto settles = find_cycle(from_rest(oscillators::one_slider(model)), {.tolerance = 1e-6});
  CHECK(settles.outcome.ending == Ending::none_exists);
}

TEST_CASE("an alternating transient is no period of two") {
  auto model = dry_oscillator(0.3, 0.3);
  model.drive.force = cosine(1, 2);
  const auto cycle = find_cycle(from_rest(oscillators::one_slider(model)), {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.returns == 1);
}

TEST_CASE("two equal blocks that move as one have the period of one, though the cycle does not attract") {
  oscillators::FrictionContact contact;
  contact.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5, 1.0, 0.0});
  contact.speed = 1.25, contact.normal_load = 1.0;
  const auto cycle =
      find_cycle(from_rest(oscillators::chain({{1, 1}, {0.7}, {0}, {1, 1}, {0.1, 0.1}}, {contact, contact})), {});
  INFO(cycle.outcome.detail);
  REQUIRE(cycle.outcome.complete());
  CHECK_FALSE(cycle.stable);
  CHECK(std::abs(value(cycle, "period") - 6.353748504669579) < error(cycle, "period"));  // of a single block
}

TEST_CASE("a contact that never slips leaves its place open, and the cycle of what moves is found at any phase") {
  // m ẍ + c ẋ + 2 k x = F cos(ωt + φ) beside a mass that friction holds: the amplitude is F/|2k − m ω² + i c ω|. The
  // extremes of x lie anywhere within the steps, near their ends too.
  const double force = 0.5, w = 1.3, amplitude = force / std::hypot(2 - w * w, 0.2 * w);
  oscillators::FrictionContact contact;
  contact.law = laws::find_law("coulomb")->with({0.5, 0.5});
  contact.tangential = Eigen::Vector2d(0, 1), contact.speed = 0.0, contact.normal_load = 100.0;
  for (int phase = 0; phase < 16; ++phase) {
    oscillators::Structure structure;
    structure.M = Eigen::Matrix2d::Identity(), structure.C = Eigen::Vector2d(0.2, 0).asDiagonal();
    structure.K = Eigen::Matrix2d{{2, -1}, {-1, 2}};
    structure.names = {"displacement_1", "displacement_2"};
    structure.force = {Signal(Signal::Harmonics{0, {{force, w, 0.4 * phase}}}), Signal(0.0)};
    structure.contacts = {contact};
    const auto cycle = find_cycle(from_rest(structure), {});
    INFO("phase " << 0.4 * phase << ": " << cycle.outcome.detail);
    REQUIRE(cycle.outcome.complete());
    CHECK(cycle.returns == 1);
    for (const char* name : {"displacement_1_max", "displacement_1_amplitude"})
      CHECK(std::abs(value(cycle, name) - amplitude) < error(cycle, name) + 1e-10);
    CHECK(error(cycle, "displacement_1_max") < 1e-7);
    CHECK(value(cycle, "stick_fraction") == Approx(1));
  }
}

TEST_CASE("motion that dies out while one contact sticks is at rest, which is no cycle") {
  oscillators::Structure structure;
  structure.M = Eigen::Matrix2d::Identity(), structure.C = 0.1 * Eigen::Matrix2d::Identity();
  structure.K = Eigen::Matrix2d{{2, -0.5}, {-0.5, 2}};
  structure.names = {"displacement_1", "displacement_2"};
  for (const double speed : {0.0, 0.3}) {
    oscillators::FrictionContact contact;
    contact.law = laws::find_law("coulomb")->with({0.4, 0.4});
    contact.tangential = Eigen::Vector2d::Unit(speed == 0 ? 0 : 1), contact.speed = speed, contact.normal_load = 1.0;
    structure.contacts.push_back(contact);
  }
  StructureModel model{structure, {}};
  model.start.kind = Start::Kind::given;
  model.start.coordinates = {0.6, -0.4}, model.start.velocities = {0.0, 0.5};
  const auto cycle = find_cycle(model, {});
  INFO(cycle.outcome.detail);
  CHECK(cycle.outcome.ending == Ending::none_exists);
}
