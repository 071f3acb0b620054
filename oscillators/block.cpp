/// Assembly of an elastic block from nine-node elements.
#include "oscillators/block.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"
#include "oscillators/gauss_points.hpp"

namespace rosin::oscillators {

namespace {

using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;

/// The quadratic polynomials that are 1 at one of −1, 0, 1 and 0 at the others.
Vector3d shape(double s) { return {s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2}; }
Vector3d slope(double s) { return {s - 0.5, -2 * s, s + 0.5}; }

constexpr int corners = 3;  // nodes of an element along each direction
/// Simpson's rule, exact for the mass and the rotary inertia.
const Vector3d simpson{1.0 / 6, 4.0 / 6, 1.0 / 6};

/// K of an element, sides hx and hy: three Gauss points in each direction are exact on rectangles.
Eigen::Matrix<double, 18, 18> element_stiffness(const ElasticBlock& block, double hx, double hy) {
  const double nu = block.poisson_ratio, E = block.youngs_modulus / ((1 + nu) * (1 - 2 * nu));
  const Matrix3d D = E * Matrix3d{{1 - nu, nu, 0}, {nu, 1 - nu, 0}, {0, 0, (1 - 2 * nu) / 2}};
  Eigen::Matrix<double, 18, 18> K = Eigen::Matrix<double, 18, 18>::Zero();
  const auto points = gauss_points(3);
  for (const auto& [y, wy] : points)
    for (const auto& [x, wx] : points) {
      Eigen::Matrix<double, 3, 18> B = Eigen::Matrix<double, 3, 18>::Zero();
      for (int b = 0; b < corners; ++b)
        for (int a = 0; a < corners; ++a) {
          const int k = corners * b + a;
          const double by_x = slope(x)[a] * shape(y)[b] * 2 / hx, by_y = shape(x)[a] * slope(y)[b] * 2 / hy;
          B(0, 2 * k) = by_x, B(1, 2 * k + 1) = by_y, B(2, 2 * k) = by_y, B(2, 2 * k + 1) = by_x;
        }
      K += wx * wy * hx * hy / 4 * block.thickness * B.transpose() * D * B;
    }
  return K;
}

/// M of an element of unit mass, one direction: the tensor product of that along each side.
MatrixXd element_mass(bool lumped) {
  const Matrix3d side =
      lumped
          ? Matrix3d(simpson.asDiagonal())
          : Matrix3d{{4.0 / 30, 2.0 / 30, -1.0 / 30}, {2.0 / 30, 16.0 / 30, 2.0 / 30}, {-1.0 / 30, 2.0 / 30, 4.0 / 30}};
  MatrixXd M(corners * corners, corners * corners);
  for (int b = 0; b < corners; ++b)
    for (int d = 0; d < corners; ++d) M.block(corners * b, corners * d, corners, corners) = side(b, d) * side;
  return M;
}

void check(const ElasticBlock& block) {
  const auto positive = [](double value, const char* name, const char* unit) {
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(fmt::format("{} of a block must be above 0 {}, got {}", name, unit, value));
  };
  positive(block.length, "length", "m");
  positive(block.height, "height", "m");
  positive(block.thickness, "thickness", "m");
  positive(block.youngs_modulus, "Young's modulus", "Pa");
  positive(block.density, "density", "kg/m^3");
  if (!(block.poisson_ratio > -1 && block.poisson_ratio < 0.5))
    throw InputError(fmt::format("Poisson's ratio must be above -1 and below 0.5 (1), got {}", block.poisson_ratio));
  for (const int count : block.elements)
    if (count < 1) throw InputError(fmt::format("a block has one element or more in each direction, got {}", count));
  if (block.gauss_points < 1)
    throw InputError(fmt::format("an edge has one Gauss point or more, got {}", block.gauss_points));
}

}  // namespace

BlockMesh::BlockMesh(const ElasticBlock& from) : block(from) {
  check(block);
  const auto [nx, ny] = block.elements;
  const int columns = 2 * nx + 1, rows = 2 * ny + 1, size = 2 * columns * rows;
  const double hx = block.length / nx, hy = block.height / ny;
  const auto node = [&](int i, int j) { return j * columns + i; };
  nodes.resize(2, columns * rows);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) nodes.col(node(i, j)) << i * hx / 2 - block.length / 2, j * hy / 2;

  const auto stiffness = element_stiffness(block, hx, hy);
  const MatrixXd mass = block.density * block.thickness * hx * hy * element_mass(block.lumped_mass);
  std::vector<Eigen::Triplet<double>> of_mass, of_stiffness;
  for (int ey = 0; ey < ny; ++ey)
    for (int ex = 0; ex < nx; ++ex) {
      auto& element = elements.emplace_back();
      for (int k = 0; k < 9; ++k) element[k] = node(2 * ex + k % corners, 2 * ey + k / corners);
      for (int a = 0; a < 9; ++a)
        for (int b = 0; b < 9; ++b)
          for (int c : {0, 1}) {
            if (mass(a, b) != 0) of_mass.emplace_back(2 * element[a] + c, 2 * element[b] + c, mass(a, b));
            for (int d : {0, 1})
              of_stiffness.emplace_back(2 * element[a] + c, 2 * element[b] + d, stiffness(2 * a + c, 2 * b + d));
          }
    }
  M.resize(size, size), K.resize(size, size);
  M.setFromTriplets(of_mass.begin(), of_mass.end());
  K.setFromTriplets(of_stiffness.begin(), of_stiffness.end());

  for (int ex = 0; ex < nx; ++ex)
    for (const auto& [at, weight] : gauss_points(block.gauss_points)) {
      Station& station = stations.emplace_back();
      station.place = (ex + (at + 1) / 2) * hx - block.length / 2;
      station.area = weight / 2 * hx * block.thickness;
      station.tangential = station.normal = VectorXd::Zero(size);
      for (int a = 0; a < corners; ++a) {
        station.tangential[2 * node(2 * ex + a, 0)] = shape(at)[a];
        station.normal[2 * node(2 * ex + a, 0) + 1] = -shape(at)[a];
      }
    }

  elongation = VectorXd::Zero(size);
  for (int ey = 0; ey < ny; ++ey)
    for (int b = 0; b < corners; ++b) elongation[2 * node(0, 2 * ey + b)] += simpson[b] / ny;
  centre_x = M * rigid(1, 0, 0) / block.mass();
  centre_y = M * rigid(0, 1, 0) / block.mass();
  tilt = M * rigid(0, 0, 1) / rotary_inertia();
  weight = -centre_y;
}

VectorXd BlockMesh::rigid(double along, double up, double rotation) const {
  VectorXd q(2 * nodes.cols());
  for (Eigen::Index k = 0; k < nodes.cols(); ++k) {
    q[2 * k] = along - rotation * (nodes(1, k) - block.height / 2);
    q[2 * k + 1] = up + rotation * nodes(0, k);
  }
  return q;
}

double BlockMesh::rotary_inertia() const {
  return block.mass() * (block.length * block.length + block.height * block.height) / 12;
}

Structure block_on_belt(const BlockMesh& mesh, const BlockOnBelt& on_belt, const FrictionContact& like) {
  Structure structure;
  structure.M = mesh.M, structure.K = mesh.K;
  structure.C = on_belt.stiffness_damping * structure.K;
  structure.K += on_belt.spring_stiffness * mesh.elongation * mesh.elongation.transpose();
  const int columns = 2 * mesh.block.elements[0] + 1;
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
    for (const char* direction : {"x", "y"})
      structure.names.push_back(fmt::format("{}_{}_{}", direction, k % columns + 1, k / columns + 1));
  structure.functionals = {{"elongation", "m", mesh.elongation},
                           {"centre_x", "m", mesh.centre_x},
                           {"centre_y", "m", mesh.centre_y},
                           {"tilt", "rad", mesh.tilt}};
  const double area = mesh.block.length * mesh.block.thickness;
  for (const auto& station : mesh.stations) {
    FrictionContact& contact = structure.contacts.emplace_back(like);
    contact.tangential = station.tangential, contact.normal = station.normal;
    contact.area = VectorXd::Constant(1, station.area);
    contact.normal_law = on_belt.contact;
    contact.load_along = mesh.weight;
    contact.load_factor = station.area / area;
  }
  return structure;
}

}  // namespace rosin::oscillators
