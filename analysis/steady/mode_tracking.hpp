/// The slowest motions of many coordinates: eigenvalues of smallest modulus of a sparse quadratic pencil, with right
/// and left vectors and the error of each, without the eigenvalues of the others.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <complex>
#include <vector>

namespace rosin::analysis::steady {

/// M q̈ + C q̇ + K q = 0, in which q = x e^(λt) asks for (λ² M + λ C + K) x = 0. K and C need not be symmetric.
struct QuadraticPencil {
  Eigen::SparseMatrix<double> M, C, K;  ///< kg, N s/m, N/m
};

struct PencilMode {
  std::complex<double> eigenvalue;  ///< λ, 1/s; of a pair that with Im λ > 0
  double error;                     ///< of the eigenvalue, that rounding leaves (1/s)
  Eigen::VectorXcd right, left;     ///< P(λ) x = 0, y* P(λ) = 0, of length 1
};

/// The `count` modes of smallest |λ|, ascending; pairs count once. Fewer where there are no more.
///
/// Krylov spaces of P(λ) and of its transpose about λ = 0 hold the vectors; λ is then the root of y* P(λ) x, whose
/// error is the product of the errors of both vectors (two-sided Rayleigh quotient; Ostrowski 1959, Schwetlick &
/// Schreiber 2012, Linear Algebra Appl. 436, 3991), and two-sided inverse iteration goes on where rounding is not
/// reached. \throws InputError where K has no inverse
std::vector<PencilMode> lowest_modes(const QuadraticPencil&, int count);

/// The mode near an estimate of λ and x, by the same iteration. Its error is infinite where it goes farther away than a
/// quarter of the gap, the distance of the next eigenvalue.
PencilMode mode_near(const QuadraticPencil&, std::complex<double> eigenvalue, const Eigen::VectorXcd& right,
                     double gap);

}  // namespace rosin::analysis::steady
