/// The one place where Eigen's eigenvalue solver, slow to compile, is compiled.
#include "core/eigenpairs.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
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
    for (std::size_t j = 0; j < moving.size(); ++j)
      A(i, j) *= scale[moving[j]] / (scale[moving[i]] * mass[moving[i]]);
  return {std::move(moving), std::move(A)};
}

SmallEigenpairs small_eigenpairs(const SmallMatrix<double>& A, bool with_vectors) {
  return solve<SmallEigenpairs>(A, with_vectors);
}

}  // namespace rosin
