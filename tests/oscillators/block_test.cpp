/// The elastic block against its rigid body, its free vibrations on several meshes, and what elements are exact for.
#include "oscillators/block.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/error.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

BlockMesh mesh(int n, bool lumped = false) {
  ElasticBlock block;  // length 2, height 1, E = 20, density 0.5: mass 1
  block.elements = {n, n};
  block.lumped_mass = lumped;
  return BlockMesh(block);
}

/// The angular frequency of the free block that is nearest to an estimate, by inverse iteration.
double frequency_near(const BlockMesh& mesh, double estimate) {
  const Eigen::SparseMatrix<double> shifted = mesh.K - estimate * estimate * mesh.M;
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(shifted);
  VectorXd x = VectorXd::LinSpaced(mesh.size(), 1, 2).array().sin();
  for (int k = 0; k < 60; ++k) x = lu.solve(mesh.M * x).normalized();
  return std::sqrt(x.dot(mesh.K * x) / x.dot(mesh.M * x));
}

}  // namespace

TEST_CASE("a block carries the mass, the rotary inertia and the weight of its rectangle, and moves freely") {
  for (const bool lumped : {false, true}) {
    ElasticBlock block{.length = 0.08, .height = 0.04, .thickness = 0.02, .youngs_modulus = 206e9, .density = 7850};
    block.elements = {3, 2}, block.lumped_mass = lumped, block.gauss_points = 4;
    const BlockMesh mesh(block);
    INFO(lumped);
    CHECK(mesh.M.isApprox(mesh.M.transpose()));
    const VectorXd along = mesh.rigid(1, 0, 0), up = mesh.rigid(0, 1, 0), turned = mesh.rigid(0, 0, 1);
    const double mass = 7850 * 0.08 * 0.04 * 0.02;
    CHECK(along.dot(mesh.M * along) == Approx(mass).epsilon(1e-13));
    CHECK(turned.dot(mesh.M * turned) == Approx(mass * (0.08 * 0.08 + 0.04 * 0.04) / 12).epsilon(1e-13));
    CHECK(std::abs(turned.dot(mesh.M * along)) < 1e-15 * mass);
    for (const VectorXd& rigid : {along, up, turned})
      CHECK((mesh.K * rigid).cwiseAbs().maxCoeff() < 1e-12 * 206e9 * 0.02 * rigid.cwiseAbs().maxCoeff());
    CHECK(mesh.weight.dot(up) == Approx(-1).epsilon(1e-13));
    CHECK(std::abs(mesh.weight.dot(turned)) < 1e-15);
    const VectorXd moved = mesh.rigid(0.3, -0.2, 0.01);
    CHECK(mesh.centre_x.dot(moved) == Approx(0.3).epsilon(1e-13));
    CHECK(mesh.centre_y.dot(moved) == Approx(-0.2).epsilon(1e-13));
    CHECK(mesh.tilt.dot(moved) == Approx(0.01).epsilon(1e-12));
    CHECK(mesh.elongation.dot(moved) == Approx(0.3).epsilon(1e-13));
    double area = 0, moment = 0, second = 0;
    for (const auto& station : mesh.stations) {
      area += station.area, moment += station.area * station.place;
      second += station.area * station.place * station.place;
      CHECK(station.normal.dot(moved) == Approx(0.2 - 0.01 * station.place).epsilon(1e-12));
      CHECK(station.tangential.dot(moved) == Approx(0.3 + 0.01 * 0.02).epsilon(1e-12));
    }
    CHECK(mesh.stations.size() == 12);
    CHECK(area == Approx(0.08 * 0.02).epsilon(1e-14));
    CHECK(std::abs(moment) < 1e-18);
    CHECK(second == Approx(0.02 * std::pow(0.08, 3) / 12).epsilon(1e-13));
  }
}

TEST_CASE("a block stretched evenly bears the stress of plane strain") {
  const auto mesh_3 = mesh(3);
  const double E = 20, nu = 0.3, lame = E * nu / ((1 + nu) * (1 - 2 * nu)), shear = E / (2 * (1 + nu));
  const double exx = 1e-3, eyy = -2e-3, gamma = 0.7e-3;
  VectorXd q(mesh_3.size());
  for (Eigen::Index k = 0; k < mesh_3.nodes.cols(); ++k) {
    const auto x = mesh_3.nodes(0, k), y = mesh_3.nodes(1, k);
    q[2 * k] = exx * x + gamma * y, q[2 * k + 1] = eyy * y;
  }
  const double energy = lame / 2 * (exx + eyy) * (exx + eyy) + shear * (exx * exx + eyy * eyy + gamma * gamma / 2);
  CHECK(q.dot(mesh_3.K * q) / 2 == Approx(energy * 2 * 1 * 1).epsilon(1e-13));
  // Without volume forces nodes inside are in balance.
  const VectorXd force = mesh_3.K * q;
  for (Eigen::Index k = 0; k < mesh_3.nodes.cols(); ++k)
    if (std::abs(mesh_3.nodes(0, k)) < 0.99 && mesh_3.nodes(1, k) > 0.01 && mesh_3.nodes(1, k) < 0.99)
      CHECK(std::abs(force[2 * k]) + std::abs(force[2 * k + 1]) < 1e-15);
}

TEST_CASE("free vibrations of a block agree with an independent assembly on four meshes, to all printed digits") {
  struct Row {
    int n;
    bool lumped;
    std::vector<double> wanted;
  };
  const Row rows[] = {
      {2,
       false,
       {7.0734572, 10.212886, 11.380775, 17.957161, 18.115174, 18.33027, 18.505018, 20.270903, 22.758945, 26.707322}},
      {4,
       false,
       {6.7538322, 10.171606, 11.064235, 16.124501, 16.280559, 17.500026, 18.009145, 18.543127, 21.463514, 23.304811}},
      {4,
       true,
       {6.7428383, 10.167535, 11.013746, 15.849638, 16.079167, 17.396121, 17.915927, 18.386028, 20.994671, 22.394411}}};
  for (const auto& [n, lumped, wanted] : rows) {
    const auto block = mesh(n, lumped);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      INFO(n << " x " << n << ", mode " << k + 1);
      CHECK(frequency_near(block, 1.0001 * wanted[k]) == Approx(wanted[k]).epsilon(6e-8));
    }
    if (n == 4) {
      const double highest = lumped ? 145.47760 : 235.33936;
      CHECK(frequency_near(block, 1.0001 * highest) == Approx(highest).epsilon(6e-8));
    }
  }
}

TEST_CASE("squared frequencies of a block converge with the fourth power of the element's size") {
  const std::vector<double> fine = {6.7325932, 10.168604, 10.999069, 15.895872, 16.105995,
                                    17.431647, 17.956861, 18.460008, 21.12919,  21.773749},
                            finest = {6.7312835, 10.168435, 10.995169, 15.879563, 16.093907,
                                      17.42748,  17.953057, 18.454588, 21.106416, 21.703091};
  const auto mesh_8 = mesh(8), mesh_12 = mesh(12);
  for (std::size_t k = 0; k < fine.size(); ++k) {
    CHECK(frequency_near(mesh_8, 1.0001 * fine[k]) == Approx(fine[k]).epsilon(6e-8));
    CHECK(frequency_near(mesh_12, 1.0001 * finest[k]) == Approx(finest[k]).epsilon(6e-8));
  }
  const double exact = frequency_near(mesh_12, finest[0]);
  const auto error = [&](int n, double near) { return std::pow(frequency_near(mesh(n), near), 2) - exact * exact; };
  const double coarse = error(2, 7.07), middle = error(4, 6.75);
  CHECK(std::log2(coarse / middle) == Approx(4).margin(0.2));
  // That of the finest mesh, (4/12)⁴ of the middle one's, belongs to both.
  const double rest = middle / 80, finer = frequency_near(mesh_8, fine[0]);
  CHECK(std::log2((middle + rest) / (finer * finer - exact * exact + rest)) == Approx(4).margin(0.2));
}

TEST_CASE("a block that cannot be is refused with what is wrong") {
  CHECK_THROWS_WITH(BlockMesh({.poisson_ratio = 0.5}),
                    Catch::Contains("Poisson's ratio must be above -1 and below 0.5"));
  CHECK_THROWS_WITH(BlockMesh({.length = 0}), Catch::Contains("length of a block must be above 0 m"));
  CHECK_THROWS_WITH(BlockMesh({.elements = {0, 4}}), Catch::Contains("one element or more"));
}
