/// The one place where Eigen's eigenvalue solver of matrices of any size is compiled.
#include "core/solve_eigenpairs.hpp"

namespace rosin {

Eigenpairs eigenpairs(const Eigen::MatrixXd& A, bool with_vectors) {
  return solve_eigenpairs<Eigenpairs>(A, with_vectors);
}

}  // namespace rosin
