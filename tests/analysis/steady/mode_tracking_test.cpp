/// The slowest modes of many coordinates against closed forms and all eigenvalues of a dense matrix.
#include "analysis/steady/mode_tracking.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/steady/thresholds.hpp"
#include "core/eigenpairs.hpp"
#include "core/error.hpp"

using namespace rosin;
using namespace rosin::analysis::steady;
using Eigen::MatrixXd, Eigen::VectorXcd;
using Complex = std::complex<double>;

namespace {

QuadraticPencil sparse(const MatrixXd& M, const MatrixXd& C, const MatrixXd& K) {
  return {M.sparseView(), C.sparseView(), K.sparseView()};
}

/// Thresholds of two modes coupled by springs and by friction on a contact normal to the second coordinate.
std::vector<Crossing> coupled_modes(const MatrixXd& C, const MatrixXd& K, double stiffness, int points) {
  const MatrixXd I = MatrixXd::Identity(2, 2);
  std::vector<double> values;
  for (int i = 0; i < points; ++i) values.push_back(0.01 + 1.49 * i / (points - 1));
  return crossings(
      [&](double coefficient) {
        MatrixXd sliding = K;
        sliding(0, 1) -= coefficient * stiffness, sliding(1, 1) += stiffness;
        Leading leading{-infinity, 0, 0};
        for (const auto& mode : lowest_modes(sparse(I, C, sliding), 2))
          if (mode.eigenvalue.real() > leading.growth)
            leading = {mode.eigenvalue.real(), mode.error, mode.eigenvalue.imag()};
        return leading;
      },
      values);
}

}  // namespace

TEST_CASE("the slowest modes of a long damped chain are those of its closed form") {
  constexpr int n = 310;
  constexpr double mass = 2, stiffness = 5e4, beta = 3e-5;
  MatrixXd K = MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    K(i, i) = 2 * stiffness;
    if (i > 0) K(i, i - 1) = K(i - 1, i) = -stiffness;
  }
  const auto modes = lowest_modes(sparse(mass * MatrixXd::Identity(n, n), beta * K, K), 12);
  REQUIRE(modes.size() == 12);
  for (int k = 1; k <= 12; ++k) {
    const double omega = 2 * std::sqrt(stiffness / mass) * std::sin(std::numbers::pi * k / (2.0 * (n + 1)));
    const double decay = beta * omega * omega / 2;
    const Complex wanted(-decay, std::sqrt(omega * omega - decay * decay));
    INFO("mode " << k << ": " << modes[k - 1].eigenvalue << " and " << wanted);
    CHECK(std::abs(modes[k - 1].eigenvalue - wanted) < modes[k - 1].error + 1e-13 * omega);
    CHECK(modes[k - 1].error < 1e-9 * omega);
    CHECK(std::abs(std::abs(modes[k - 1].right[n / 3]) / std::abs(modes[k - 1].right[n / 7])) ==
          Approx(std::abs(std::sin(std::numbers::pi * k * (n / 3 + 1) / (n + 1)) /
                          std::sin(std::numbers::pi * k * (n / 7 + 1) / (n + 1))))
              .epsilon(1e-8));
  }
}

TEST_CASE("modes under circulatory and gyroscopic forces are those of the dense matrix, from both sides") {
  constexpr int n = 40;
  const MatrixXd R =
      MatrixXd::NullaryExpr(n, n, [](auto i, auto j) { return std::sin(1.37 * double((i + 1) * (i + 2 * j + 2))); });
  const MatrixXd M = MatrixXd::Identity(n, n) + 0.01 * R * R.transpose();
  const MatrixXd K = R * R.transpose() + 2 * MatrixXd::Identity(n, n) + 0.3 * R, C = 0.02 * R;
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -M.llt().solve(K), A.bottomRightCorner(n, n) = -M.llt().solve(C);
  const auto all = eigenpairs(A).values;
  const auto modes = lowest_modes(sparse(M, C, K), 8);
  REQUIRE(modes.size() == 8);
  double before = 0;
  for (const auto& [eigenvalue, error, right, left] : modes) {
    CHECK((all.array() - eigenvalue).abs().minCoeff() < 1e-11);
    CHECK(std::abs(eigenvalue) > before - 1e-12);
    before = std::abs(eigenvalue);
    const Eigen::MatrixXcd P = eigenvalue * eigenvalue * M + eigenvalue * C + K;
    CHECK((P * right).norm() < 1e-12 * K.norm());
    CHECK((left.adjoint() * P).norm() < 1e-12 * K.norm());
  }
  CHECK((all.array().abs() < before * (1 - 1e-9)).count() == 14);  // none is left out
}

TEST_CASE("where modes merge, the threshold from the slowest modes is the closed form's") {
  const MatrixXd I = MatrixXd::Identity(2, 2), minimal{{2, 1}, {1, 2.0 / 3}}, stiff{{5.2e7, 1e7}, {1e7, 2e7}};
  struct Row {
    MatrixXd C, K;
    double stiffness, wanted;
  };
  const Row rows[] = {{0 * I, minimal, 4.0 / 3, 0.75},
                      {0.02 * I, minimal, 4.0 / 3, 0.7506},
                      {MatrixXd{{0.02, 0}, {0, 0.06}}, minimal, 4.0 / 3, 0.7518},
                      {0 * I, stiff, 3e7, 404.0 / 1200},
                      {MatrixXd{{20, 0}, {0, 30}}, stiff, 3e7, 0.336635733333}};
  for (const auto& row : rows) {
    const auto found = coupled_modes(row.C, row.K, row.stiffness, 40);
    REQUIRE(found.size() == 1);
    INFO(row.wanted << ": " << found[0].value << " ± " << found[0].error);
    CHECK(found[0].onset);
    CHECK(std::abs(found[0].value - row.wanted) < found[0].error + 1e-12);
    CHECK(found[0].error < 1e-10);
  }
}

TEST_CASE("a stiffness without inverse is refused") {
  const MatrixXd I = MatrixXd::Identity(2, 2), free{{1, -1}, {-1, 1}};
  CHECK_THROWS_AS(lowest_modes(sparse(I, I, free), 1), InputError);
}
