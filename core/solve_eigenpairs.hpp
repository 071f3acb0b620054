/// What eigenpairs of matrices of any size and of small ones have in common. Each of Eigen's solvers takes the compiler
/// eight seconds and half a gigabyte, so that each is compiled in a file of its own.
#pragma once
#include <Eigen/Eigenvalues>
#include <limits>

#include "core/eigenpairs.hpp"

namespace rosin {

/// Eigenpairs of a complex matrix. \returns false if no iteration converges.
bool complex_eigenpairs(const Eigen::MatrixXcd& A, bool with_vectors, Eigenpairs& pairs);

template <class Pairs, class Matrix>
Pairs solve_eigenpairs(const Matrix& A, bool with_vectors) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Pairs pairs;
  pairs.values.setConstant(A.rows(), nan);
  if (with_vectors) pairs.vectors.setConstant(A.rows(), A.rows(), nan);
  if (!A.allFinite()) return pairs;
  if (const Eigen::EigenSolver<Matrix> solver(A, with_vectors); solver.info() == Eigen::Success) {
    pairs.values = solver.eigenvalues();
    if (with_vectors) pairs.vectors = solver.eigenvectors();
    return pairs;
  }
  // The double steps of real matrices may go round in circles where the single ones of complex matrices do not.
  if (Eigenpairs complex; complex_eigenpairs(A.template cast<std::complex<double>>(), with_vectors, complex)) {
    pairs.values = complex.values;
    if (with_vectors) pairs.vectors = complex.vectors;
  }
  return pairs;
}

}  // namespace rosin
