/// Eigenvalues and eigenvectors of a small real matrix, compiled once for all who ask.
#pragma once
#include <Eigen/Core>

namespace rosin {

/// A·vectors = vectors·diag(values).
struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};

/// Eigenvalues, and eigenvectors in columns if asked, of a square matrix. NaN throughout if the iteration fails.
Eigenpairs eigenpairs(const Eigen::MatrixXd& A, bool with_vectors = false);

}  // namespace rosin
