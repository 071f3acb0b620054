/// Eigenvalues and eigenvectors of a small real matrix, compiled once for all who ask.
#pragma once
#include <Eigen/Core>
#include <complex>

namespace rosin {

/// A·vectors = vectors·diag(values).
struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};

/// Eigenvalues, and eigenvectors in columns if asked, of a square matrix. NaN throughout if the iteration fails.
Eigenpairs eigenpairs(const Eigen::MatrixXd& A, bool with_vectors = false);

/// The same for small matrices, which nothing is allocated for.
inline constexpr int most_small_rows = 20;
template <class Number>
using SmallMatrix =
    Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_small_rows, most_small_rows>;
struct SmallEigenpairs {
  Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1, Eigen::ColMajor, most_small_rows, 1> values;
  SmallMatrix<std::complex<double>> vectors;
};
SmallEigenpairs small_eigenpairs(const SmallMatrix<double>& A, bool with_vectors = false);

}  // namespace rosin
