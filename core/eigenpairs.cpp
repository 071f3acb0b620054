/// The one place where Eigen's eigenvalue solver, slow to compile, is compiled.
#include "core/eigenpairs.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>

namespace rosin {

namespace {
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class Pairs, class Matrix>
Pairs solve(const Matrix& A, bool with_vectors) {
  Pairs pairs;
  pairs.values.setConstant(A.rows(), nan);
  if (with_vectors) pairs.vectors.setConstant(A.rows(), A.rows(), nan);
  const auto take = [&](const auto& solver) {
    if (solver.info() != Eigen::Success) return false;
    pairs.values = solver.eigenvalues();
    if (with_vectors) pairs.vectors = solver.eigenvectors();
    return true;
  };
  if (!A.allFinite() || take(Eigen::EigenSolver<Matrix>(A, with_vectors))) return pairs;
  // The double steps of real matrices may go round in circles where the single ones of complex matrices do not.
  using ComplexMatrix = decltype(pairs.vectors);
  take(Eigen::ComplexEigenSolver<ComplexMatrix>(A.template cast<std::complex<double>>(), with_vectors));
  return pairs;
}

/// Changes a matrix to unknowns of other sizes, by powers of two, in which rows and columns are of one size (Parlett &
/// Reinsch 1969): couplings may lie fifteen decades apart, and the eigenvalue of a pair is the root of their product.
/// \param unit gets the sizes of the unknowns.
template <class Matrix, class Units>
void balance(Matrix& A, Units& unit) {
  const int n = int(A.rows());
  constexpr int rounds = 20;
  bool balanced = false;
  for (int round = 0; round < rounds && !balanced; ++round) {
    balanced = true;
    for (int i = 0; i < n; ++i) {
      const double row = A.row(i).cwiseAbs().sum() - std::abs(A(i, i));
      const double column = A.col(i).cwiseAbs().sum() - std::abs(A(i, i));
      if (!(row > 0 && column > 0 && std::isfinite(row) && std::isfinite(column))) continue;
      const int power = int(std::round(0.5 * std::log2(row / column)));
      if (power == 0) continue;
      balanced = false;
      const double factor = std::ldexp(1.0, power);
      A.row(i) /= factor;
      A.col(i) *= factor;
      unit[std::size_t(i)] *= factor;
    }
  }
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
    for (std::size_t j = 0; j < moving.size(); ++j) A(i, j) *= scale[moving[j]] / (scale[moving[i]] * mass[moving[i]]);
  return {std::move(moving), std::move(A)};
}

SmallEigenpairs small_eigenpairs(SmallMatrix<double> A, bool with_vectors) {
  std::array<double, most_small_rows> unit;
  unit.fill(1);
  balance(A, unit);
  auto pairs = solve<SmallEigenpairs>(A, with_vectors);
  for (int i = 0; i < pairs.vectors.rows(); ++i) pairs.vectors.row(i) *= unit[i];
  return pairs;
}

Spectrum spectrum_of(Eigen::MatrixXd A) {
  std::vector<double> unit(std::size_t(A.rows()), 1.0);
  balance(A, unit);
  const auto pairs = eigenpairs(A, true);
  // |δλ| ≤ ‖x‖ ‖y‖ δ/|yᴴx| with the rows yᴴ of the inverse of the vectors x (Golub & Van Loan, section 7.2.2).
  const double size = A.norm(), rounding = double(A.rows()) * std::numeric_limits<double>::epsilon() * size;
  const Eigen::MatrixXcd inverse = pairs.vectors.partialPivLu().inverse();
  Spectrum spectrum;
  for (int i = 0; i < A.rows(); ++i) {
    const double separate = pairs.vectors.col(i).norm() * inverse.row(i).norm() * rounding;
    // m eigenvalues that rounding mixes are known to the m-th root of it, merged or not.
    const auto mixed = ((pairs.values.array() - pairs.values[i]).abs() <= separate).count();
    const double merged = 2 * size * std::pow(rounding / size, 1.0 / double(std::max<Eigen::Index>(mixed, 2)));
    spectrum.values.push_back(pairs.values[i]);
    spectrum.errors.push_back(separate < merged ? separate : merged);
  }
  return spectrum;
}

}  // namespace rosin
