/// Eigenvalues of products against those that the factors were made of.
#include "core/product_eigenvalues.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace rosin;
using Eigen::MatrixXd;

namespace {

/// S_k D_k S_{k−1}⁻¹ with S_N = S_0: the product is similar to that of the D.
std::vector<MatrixXd> factors_of(const std::vector<MatrixXd>& D, unsigned seed) {
  std::mt19937 dice(seed);
  std::normal_distribution<double> normal;
  const auto n = D.front().rows();
  std::vector<MatrixXd> S;
  for (std::size_t k = 0; k < D.size(); ++k) {
    S.push_back(MatrixXd::NullaryExpr(n, n, [&] { return normal(dice); }) + 3 * MatrixXd::Identity(n, n));
  }
  std::vector<MatrixXd> factors;
  for (std::size_t k = 0; k < D.size(); ++k) factors.push_back(S[(k + 1) % D.size()] * D[k] * S[k].inverse());
  return factors;
}

}  // namespace

TEST_CASE("eigenvalues a hundred decades apart are each known to rounding", "[core][eigenvalues]") {
  // 1e3 and its like, twenty times: 1e60, one near 1, 1e-40.
  const int count = 20;
  std::vector<MatrixXd> D(count, Eigen::Vector3d(std::pow(10, -2.0), 1e3, std::pow(1.5, 1.0 / count)).asDiagonal());
  const auto found = product_eigenvalues(factors_of(D, 1));
  REQUIRE(found.size() == 3);
  CHECK(std::abs(found[0] / 1e60 - 1.0) < 1e-11);
  CHECK(std::abs(found[1] / 1.5 - 1.0) < 1e-11);
  CHECK(std::abs(found[2] / 1e-40 - 1.0) < 1e-10);
}

TEST_CASE("a pair of complex eigenvalues stands beside large and vanishing ones", "[core][eigenvalues]") {
  MatrixXd D = MatrixXd::Zero(4, 4);
  const double turn = 0.2;
  D(0, 0) = 50;
  D.block(1, 1, 2, 2) << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
  const int count = 12;
  const auto found = product_eigenvalues(factors_of(std::vector<MatrixXd>(count, D), 2));
  CHECK(std::abs(found[0] / std::pow(50.0, count) - 1.0) < 1e-11);
  CHECK(std::abs(found[1] - std::polar(1.0, turn * count)) < 1e-11);
  CHECK(std::abs(found[2] - std::polar(1.0, -turn * count)) < 1e-11);
  CHECK(std::abs(found[3]) < 1e-14);
}

TEST_CASE("rectangular factors whose product is square keep its eigenvalues", "[core][eigenvalues]") {
  MatrixXd A(3, 2), B(2, 3);
  A << 1, 2, 3, 4, 5, 6;
  B << 1, 0, 1, 0, 1, -1;
  // B·A = [[6, 8], [-2, -2]]: λ² − 4 λ + 4 = 0 within rounding's root.
  const auto found = product_eigenvalues({A, B});
  REQUIRE(found.size() == 2);
  CHECK(std::abs(found[0] - 2.0) < 1e-6);
  CHECK(product_eigenvalues({}).empty());
  CHECK(std::isnan(product_eigenvalues({MatrixXd::Constant(1, 1, NAN)})[0].real()));
}
