/// Steady sliding and flutter of an elastic block against exact balances, an independent code, and the rigid block.
#include "analysis/steady/sliding_modes.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/steady/thresholds.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::analysis::steady;
using Eigen::VectorXd;
using oscillators::FlatBlock;
using Complex = std::complex<double>;

namespace {

Complex nearest(const StructureStability& stability, Complex wanted) {
  return *std::ranges::min_element(stability.eigenvalues, {}, [&](Complex z) { return std::abs(z - wanted); });
}

Crossing critical_friction(FlatBlock block, double from, double to) {
  const auto found = crossings(
      [&](double friction) {
        block.friction = friction;
        const auto modes = lowest_modes_of_sliding(block.structure(), 4).modes;
        return Leading{modes.front().growth_rate(), modes.front().error, modes.front().eigenvalue.imag()};
      },
      {from, to});
  REQUIRE(found.size() == 1);
  return found[0];
}

}  // namespace

TEST_CASE("a block that slides steadily balances its weight, its spring and the moment of friction") {
  for (const double friction : {0.2, 0.5}) {
    const FlatBlock block{.friction = friction};
    const auto mesh = block.mesh();
    const auto structure = block.structure();
    const oscillators::StationForces contacts(structure);
    const VectorXd q = steady_sliding(structure, contacts);
    oscillators::StationForces::Forces forces;
    contacts.evaluate(0, contacts.rows() * q, VectorXd::Zero(contacts.size()), forces);
    double N = 0, T = 0, moment = 0;
    for (std::size_t s = 0; s < mesh.stations.size(); ++s) {
      const auto& contact = contacts.contacts()[s];
      N -= forces.value[contact.first], T += forces.value[contact.slip];
      moment -= forces.value[contact.first] * mesh.stations[s].place;
    }
    CHECK(std::abs(N - 0.5) < 1e-10);
    CHECK(std::abs(T - friction * 0.5) < 1e-10);
    CHECK(std::abs(mesh.elongation.dot(q) - friction * 0.5 / 0.05) < 1e-9);
    CHECK(std::abs(moment / N + friction * 0.5) < 1e-10);  // −μ H, H half the height
  }
}

TEST_CASE("displacements of steady sliding agree with an independent code to its printed digits") {
  struct Row {
    double friction, centre, left, right, left_along, right_along;
  };
  for (const auto& [friction, centre, left, right, left_along, right_along] :
       {Row{0, -1.003790380303, -0.998405459808, -0.998405459808, -.002418197508, .007293197507},
        Row{0.2, -1.000396604124, -1.147356079651, -0.843086736361, 2.077729767175, 2.089705627975},
        Row{0.3, -0.995688844020, -1.220407396802, -0.761869477236, 3.119052725671, 3.130450022601},
        Row{0.5, -0.979501914580, -1.365469552578, -0.588967493915, 5.205541417311, 5.212385342658}}) {
    const FlatBlock block{.friction = friction};
    const auto mesh = block.mesh();
    const auto structure = block.structure();
    const VectorXd q = steady_sliding(structure, oscillators::StationForces(structure));
    INFO(friction);
    CHECK(std::abs(mesh.centre_y.dot(q) - centre) < 1e-8);
    CHECK(std::abs(q[1] - left) < 1e-8);
    CHECK(std::abs(q[2 * 8 + 1] - right) < 1e-8);
    CHECK(std::abs(q[0] - left_along) < 1e-8);
    CHECK(std::abs(q[2 * 8] - right_along) < 1e-8);
  }
}

TEST_CASE("bounce and pitch of a sliding block agree with an independent code, without and with damping") {
  struct Row {
    double friction;
    bool damped, lumped;
    Complex first, second;
  };
  for (const auto& [friction, damped, lumped, first, second] :
       {Row{0, false, false, {0, .89023764}, {0, .99622038}},
        Row{0, true, false, {-.00785450, .89020413}, {-.00985326, .99617299}},
        Row{0.2, false, false, {0, .90079726}, {0, .97733211}},
        Row{0.2, true, false, {-.00744946, .90078279}, {-.01031056, .97726271}},
        Row{0.3, false, false, {.01353521, .93372394}, {-.01353521, .93372394}},
        Row{0.3, true, false, {.0054645088, .9296404140}, {-.0232908255, .9377199300}},
        Row{0.5, false, false, {.07188268, .91557042}, {-.07188268, .91557042}},
        Row{0.5, true, false, {.0629873473, .9144257814}, {-.0810337291, .9166153655}},
        Row{0.5, true, true, {.0629873620, .9144257774}, {-.0810337291, .9166153655}}}) {
    const auto stability =
        lowest_modes_of_sliding(FlatBlock{.lumped = lumped, .damped = damped, .friction = friction}.structure(), 6);
    INFO(friction << (damped ? " damped" : "") << (lumped ? " lumped" : ""));
    CHECK(std::abs(nearest(stability, first) - first) < 1e-7);
    if (!lumped) CHECK(std::abs(nearest(stability, second) - second) < 1e-7);
    CHECK(stability.modes.size() == 6);
    CHECK((stability.modes.front().growth_rate() > stability.modes.front().error) == (friction > 0.25));
  }
  CHECK(std::abs(nearest(lowest_modes_of_sliding(FlatBlock{.damped = false, .friction = 0}.structure(), 3), {0, 0.22}) -
                 Complex(0, .223437)) < 1e-6);
}

TEST_CASE("the friction at which a damped block begins to flutter agrees with an independent code") {
  struct Row {
    int elements;
    double wanted;
  };
  for (const auto& [elements, wanted] : {Row{2, .292067186}, Row{4, .292091470}}) {
    const auto found = critical_friction({.elements = elements}, 0.28, 0.31);
    CHECK(std::abs(found.value - wanted) < 2e-9);
    CHECK(found.error < 1e-9);
    if (elements == 4) CHECK(std::abs(found.angular_frequency - .9277101) < 1e-7);
  }
}

TEST_CASE("an ever stiffer block begins to flutter where the rigid block does") {
  // Rigid, on p = c a², height over length 1/2, in closed form; the difference falls with 1/E and its powers.
  constexpr double rigid = 0.29174773559646;
  const auto at = [](double E) {
    return critical_friction({.elements = 1, .damped = false, .youngs_modulus = E}, 0.288, 0.296).value;
  };
  const double soft = at(20), middle = at(200), stiff = at(2000);
  CHECK(std::abs(stiff - rigid) < 2e-5);
  CHECK((rigid - soft) / (rigid - middle) == Approx(10).epsilon(0.02));
  const double once = (10 * middle - soft) / 9, again = (10 * stiff - middle) / 9;
  CHECK(std::abs((100 * again - once) / 99 - rigid) < 5e-9);
}

TEST_CASE("the lowest modes of a small structure are among all of its modes") {
  oscillators::ModeCoupling model;
  model.mass[0] = 1, model.mass[1] = 2, model.damping[0] = 0.03;
  model.springs = {{1, 0.4}, {0.7, 1.9}};
  model.contact = laws::normal_law(laws::LinearContact{.stiffness = 1.3, .damping = 0.05, .lift_off = false});
  oscillators::FrictionContact contact;
  contact.law = laws::find_law("coulomb")->with({0.9, 0.4});
  contact.normal_load = 3.0;
  const auto structure = oscillators::mode_coupling(model, contact, 0.7);
  const auto all = stability(structure), lowest = lowest_modes_of_sliding(structure, 2);
  REQUIRE(lowest.modes.size() == 2);
  for (const auto& mode : lowest.modes) CHECK(std::abs(nearest(all, mode.eigenvalue) - mode.eigenvalue) < 1e-13);
  for (int i : {0, 1}) CHECK(lowest.coordinates[i] == Approx(all.coordinates[i]).epsilon(1e-12));
  CHECK(lowest.contacts[0].normal_load == Approx(all.contacts[0].normal_load).epsilon(1e-12));
  CHECK(lowest.contacts[0].friction_force == Approx(all.contacts[0].friction_force).epsilon(1e-12));
}

TEST_CASE("a stiff block that friction would tip over has no steady sliding, however far rounding lets it fall") {
  // μ H/2 against half the length: 10.2 mm against 6.5 mm. Far down |K||q| ε is more than the weight.
  oscillators::ElasticBlock shape{.length = 0.013,
                                  .height = 0.0073,
                                  .thickness = 0.016,
                                  .youngs_modulus = 3.4e5,
                                  .poisson_ratio = 0.14,
                                  .density = 20};
  shape.elements = {3, 3}, shape.gauss_points = 1;
  const oscillators::BlockMesh mesh(shape);
  const laws::PowerContact contact{
      .coefficient = 2.9e24, .exponent = 2.5, .bound_coefficient = 2.9e24, .bound_exponent = 2.5};
  const auto structure = [&](double friction) {
    oscillators::FrictionContact like;
    like.law = laws::find_law("coulomb")->with({friction, friction});
    like.speed = 4e-4, like.normal_load = 5.2;
    return oscillators::block_on_belt(mesh, {2.9e5, 0, laws::normal_law(contact)}, like);
  };
  const auto of = structure(2.8);
  CHECK_THROWS_WITH(steady_sliding(of, oscillators::StationForces(of)), Catch::Contains("no steady sliding"));
  double load = 0;
  for (const auto& station : lowest_modes_of_sliding(structure(0.5), 3).contacts) load += station.normal_load;
  CHECK(load == Approx(5.2).epsilon(1e-8));
}
