/// The one place where Eigen's eigenvalue solver, slow to compile, is compiled.
#include "core/eigenpairs.hpp"

#include <Eigen/Eigenvalues>
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

SmallEigenpairs small_eigenpairs(const SmallMatrix<double>& A, bool with_vectors) {
  return solve<SmallEigenpairs>(A, with_vectors);
}

}  // namespace rosin
