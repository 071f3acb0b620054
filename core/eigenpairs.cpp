/// The one place where Eigen's eigenvalue solver, slow to compile, is compiled.
#include "core/eigenpairs.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>

namespace rosin {

namespace {
template <class Pairs, class Matrix>
Pairs solve(const Matrix& A, bool with_vectors) {
  const Eigen::EigenSolver<Matrix> solver(A, with_vectors);
  Pairs pairs;
  if (solver.info() != Eigen::Success) {
    pairs.values.setConstant(A.rows(), std::numeric_limits<double>::quiet_NaN());
  } else {
    pairs.values = solver.eigenvalues();
    if (with_vectors) pairs.vectors = solver.eigenvectors();
  }
  return pairs;
}
}  // namespace

Eigenpairs eigenpairs(const Eigen::MatrixXd& A, bool with_vectors) { return solve<Eigenpairs>(A, with_vectors); }

MovingPart moving_part(const Eigen::MatrixXd& J, const Eigen::VectorXd& mass, const Eigen::VectorXd& scale) {
  std::vector<int> moving, algebraic;
  for (int i = 0; i < mass.size(); ++i) (mass[i] > 0 ? moving : algebraic).push_back(i);
  Eigen::MatrixXd A = J(moving, moving);
  if (!algebraic.empty())
    A -= J(moving, algebraic) * J(algebraic, algebraic).partialPivLu().solve(J(algebraic, moving));
  for (std::size_t i = 0; i < moving.size(); ++i)
    for (std::size_t j = 0; j < moving.size(); ++j) A(i, j) *= scale[moving[j]] / (scale[moving[i]] * mass[moving[i]]);
  return {std::move(moving), std::move(A)};
}

SmallEigenpairs small_eigenpairs(SmallMatrix<double> A, bool with_vectors) {
  const int n = int(A.rows());
  // Unknowns of other sizes, by powers of two, in which rows and columns are of one size (Parlett & Reinsch 1969):
  // couplings may lie fifteen decades apart, and the eigenvalue of a pair is the root of their product.
  std::array<double, most_small_rows> unit;
  unit.fill(1);
  constexpr int rounds = 20;
  bool balanced = false;
  for (int round = 0; round < rounds && !balanced; ++round) {
    balanced = true;
    for (int i = 0; i < n; ++i) {
      const double row = A.row(i).cwiseAbs().sum() - std::abs(A(i, i));
      const double column = A.col(i).cwiseAbs().sum() - std::abs(A(i, i));
      if (!(row > 0 && column > 0 && std::isfinite(row) && std::isfinite(column))) continue;
      const int power = int(std::round(0.5 * std::log2(row / column)));
      if (power == 0) continue;
      balanced = false;
      const double factor = std::ldexp(1.0, power);
      A.row(i) /= factor;
      A.col(i) *= factor;
      unit[i] *= factor;
    }
  }
  auto pairs = solve<SmallEigenpairs>(A, with_vectors);
  for (int i = 0; i < pairs.vectors.rows(); ++i) pairs.vectors.row(i) *= unit[i];
  return pairs;
}

}  // namespace rosin
