/// Eigenvalues and eigenvectors of a small real matrix, compiled once for all who ask.
#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

namespace rosin {

/// A·vectors = vectors·diag(values).
struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};

/// Eigenvalues, and eigenvectors in columns if asked, of a square matrix. NaN throughout where the matrix is not finite
/// or no iteration converges.
Eigenpairs eigenpairs(const Eigen::MatrixXd& A, bool with_vectors = false);

/// Eigenvalues of a matrix of any balance, each with the error that rounding leaves: its condition times the rounding
/// of the matrix, and where m eigenvalues merge the m-th root of that rounding. NaN throughout as eigenpairs.
struct Spectrum {
  std::vector<std::complex<double>> values;
  std::vector<double> errors;
};
Spectrum spectrum_of(Eigen::MatrixXd A);

/// What moves in M ẏ = J y by its own: the unknowns with a mass, and the matrix of their rates, each in its scale. The
/// others follow at once, and their rows are eliminated; scales balance the matrix.
struct MovingPart {
  std::vector<int> unknowns;
  Eigen::MatrixXd A;  ///< 1/s
};
MovingPart moving_part(const Eigen::MatrixXd& J, const Eigen::VectorXd& mass, const Eigen::VectorXd& scale);

/// Eigenpairs of small matrices, which nothing is allocated for, of any balance.
inline constexpr int most_small_rows = 64;
template <class Number>
using SmallMatrix =
    Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_small_rows, most_small_rows>;
struct SmallEigenpairs {
  Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 1, Eigen::ColMajor, most_small_rows, 1> values;
  SmallMatrix<std::complex<double>> vectors;
};
SmallEigenpairs small_eigenpairs(SmallMatrix<double> A, bool with_vectors = false);

}  // namespace rosin
