/// A rigid block on its face and on feet: the friction at which sinking and rocking merge, in closed form.
#include "oscillators/rigid_block.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/steady/mode_windows.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/structure_system.hpp"

using namespace rosin;
using namespace rosin::oscillators;

namespace {

Structure sliding(RigidBlock block, double coefficient, double weight, double mu) {
  block.spring_stiffness = 1e-3;
  block.contact = laws::normal_law(laws::PowerContact{
      .coefficient = coefficient, .exponent = 2, .bound_coefficient = coefficient, .bound_exponent = 2});
  FrictionContact contact;
  contact.law = laws::find_law("coulomb")->with({mu, mu});
  contact.normal_load = weight;
  return rigid_block_on_belt(block, contact);
}

analysis::steady::Scan over_friction(const RigidBlock& block, double coefficient, double weight, double to) {
  std::vector<double> values;
  for (int i = 0; i <= 20; ++i) values.push_back(0.05 + (to - 0.05) * i / 20);
  return analysis::steady::scan(
      [&](double mu) { return analysis::steady::stability(sliding(block, coefficient, weight, mu)); }, values);
}

/// D(μ) < 0 where a block of half height and half length η : 1 on p = c a² flutters, while all of its face touches: the
/// squared difference of the two diagonal terms and the product of the couplings.
double discriminant(double eta, double mu) {
  const double h = mu * eta, sigma = -(1 - std::sqrt(1 - 3 * h * h)) / h;
  return std::pow(eta * eta - h * sigma, 2) + 4.0 / 3 * (1 + eta * eta) * sigma * (sigma + 3 * h);
}

}  // namespace

TEST_CASE("a rigid block on its face begins to flutter at a friction that depends on its shape alone") {
  const double eta = GENERATE(0.5, 0.4, 0.3);
  double low = 0.05, high = 0.45;
  for (int i = 0; i < 60; ++i) (discriminant(eta, 0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
  if (eta == 0.5) CHECK(low == Approx(0.29174773559646).epsilon(1e-11));
  for (const double weight : {0.5, 40.0}) {
    const auto thresholds =
        over_friction({.mass = 1.3, .length = 2, .height = 2 * eta}, weight * 0.7, weight, 0.45).thresholds;
    REQUIRE(!thresholds.empty());
    CHECK(thresholds[0].value == Approx(low).epsilon(1e-9));
  }
}

TEST_CASE("a rigid block on two feet that stiffen with the load") {
  struct Case {
    double height, mu, squared_frequency;  ///< half the height over half the length
  };
  const auto [height, mu, squared] =
      GENERATE(Case{1.2, 0.156128847038, 1.0989706491}, Case{1.6, 0.117297836187, 0.9097926458});
  // Both feet together are as stiff as 1 under half the weight each: 2·2 √(c A W/2) = 1, with A = 1.
  const double weight = 0.125;
  const auto scan = over_friction({.mass = 1, .length = 2, .height = 2 * height, .on_feet = true}, 1, weight, 0.3);
  REQUIRE(!scan.thresholds.empty());
  CHECK(scan.thresholds[0].value == Approx(mu).epsilon(1e-9));
  CHECK(std::pow(scan.thresholds[0].angular_frequency, 2) == Approx(squared).epsilon(1e-5));
}

TEST_CASE("a rigid block stands by its weight, pulls its spring by friction, and bears ahead of its middle") {
  RigidBlock block{.mass = 2, .length = 2, .height = 1};
  const auto structure = sliding(block, 0.25, 0.5, 0.2);
  const StructureSystem system(structure);
  const auto y = system.steady(0);
  CHECK(system.normal_load(0, 0, y.data()) == Approx(0.5).epsilon(1e-10));
  CHECK(y[0] == Approx(0.2 * 0.5 / 1e-3).epsilon(1e-9));
  CHECK(y[2] > 0);  // friction turns it up in front
}
