/// The one place where Eigen's eigenvalue solver, slow to compile, is compiled.
#include "core/eigenpairs.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

namespace rosin {

Eigenpairs eigenpairs(const Eigen::MatrixXd& A, bool with_vectors) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A, with_vectors);
  if (solver.info() != Eigen::Success)
    return {Eigen::VectorXcd::Constant(A.rows(), std::numeric_limits<double>::quiet_NaN()), {}};
  return {solver.eigenvalues(), with_vectors ? Eigen::MatrixXcd(solver.eigenvectors()) : Eigen::MatrixXcd()};
}

}  // namespace rosin
