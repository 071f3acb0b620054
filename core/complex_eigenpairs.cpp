/// The one place where Eigen's eigenvalue solver of complex matrices is compiled.
#include "core/solve_eigenpairs.hpp"

namespace rosin {

bool complex_eigenpairs(const Eigen::MatrixXcd& A, bool with_vectors, Eigenpairs& pairs) {
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(A, with_vectors);
  if (solver.info() != Eigen::Success) return false;
  pairs.values = solver.eigenvalues();
  if (with_vectors) pairs.vectors = solver.eigenvectors();
  return true;
}

}  // namespace rosin
