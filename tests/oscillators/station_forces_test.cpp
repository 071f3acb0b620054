/// Forces of contacts on the rows that they feel: slopes against differences, and the equations of the whole structure.
#include "oscillators/station_forces.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "oscillators/structure_system.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using Eigen::MatrixXd, Eigen::VectorXd;

TEST_CASE("slopes of the forces of contacts are those of central differences, sliding, sticking and open") {
  const auto structure = FlatBlock{.elements = 2, .speed = 0.3, .width = 0.2}.structure();
  const StationForces contacts(structure);
  const auto size = contacts.size();
  REQUIRE(size == 12);
  const VectorXd place = VectorXd::NullaryExpr(size, [](auto i) { return std::sin(1.0 + 2.3 * double(i)); });
  const VectorXd rate = VectorXd::NullaryExpr(size, [](auto i) { return 0.4 * std::cos(0.7 * double(i * i)); });
  StationForces::Forces forces, ahead, behind;
  contacts.evaluate(0, place, rate, forces);
  constexpr double h = 1e-6;
  for (Eigen::Index k = 0; k < size; ++k) {
    const VectorXd step = h * VectorXd::Unit(size, k);
    contacts.evaluate(0, place + step, rate, ahead), contacts.evaluate(0, place - step, rate, behind);
    CHECK((forces.by_place.col(k) - (ahead.value - behind.value) / (2 * h)).norm() < 1e-8);
    contacts.evaluate(0, place, rate + step, ahead), contacts.evaluate(0, place, rate - step, behind);
    CHECK((forces.by_rate.col(k) - (ahead.value - behind.value) / (2 * h)).norm() < 1e-8);
  }
}

TEST_CASE("forces of contacts on their rows are those of the whole structure's equations") {
  const auto structure = FlatBlock{.elements = 1, .friction = 0.4}.structure();
  const StationForces contacts(structure);
  const StructureSystem system(structure, Unknowns::states);
  const int n = structure.size();
  const VectorXd q = VectorXd::NullaryExpr(n, [](auto i) { return -0.8 + 0.3 * std::sin(double(i * i)); });
  const VectorXd v = VectorXd::NullaryExpr(n, [](auto i) { return 0.2 * std::cos(1.3 * double(i)); });
  StationForces::Forces forces;
  contacts.evaluate(0, contacts.rows() * q, contacts.rows() * v, forces);
  const VectorXd total =
      contacts.dead_load(0) - structure.K * q - structure.C * v + contacts.rows().transpose() * forces.value;
  // Accelerations by the system: q̇ between two moments.
  const auto y = system.unknowns_at(0, q, v);
  std::vector<double> f(system.size()), moved(y);
  system.evaluate(0, y.data(), f.data());
  for (int i = 0; i < system.size(); ++i) moved[i] += f[i] * 1e-6;
  std::vector<double> mass(system.size());
  system.mass(0, mass.data());
  const VectorXd acceleration = (system.velocity(0, moved.data()) - system.velocity(0, y.data())) / 1e-6;
  CHECK((structure.M * acceleration - total).norm() < 1e-6 * total.norm());
}

TEST_CASE("contacts that remember are refused by codes that see forces alone") {
  auto structure = FlatBlock{.elements = 1}.structure();
  structure.contacts[1].law = laws::find_law("ageing");
  CHECK_THROWS_WITH(StationForces(structure), Catch::Contains("contact 2") && Catch::Contains("law 'ageing'"));
}
