/// Eigenvalues with their errors, and the matrix of what moves by its own.
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "core/balance.hpp"
#include "core/eigenpairs.hpp"

namespace rosin {

MovingPart moving_part(const Eigen::MatrixXd& J, const Eigen::VectorXd& mass, const Eigen::VectorXd& scale) {
  std::vector<int> moving, algebraic;
  for (int i = 0; i < mass.size(); ++i) (mass[i] > 0 ? moving : algebraic).push_back(i);
  Eigen::MatrixXd A = J(moving, moving);
  if (!algebraic.empty()) {
    const Eigen::MatrixXd by_algebraic = J(moving, algebraic), own = J(algebraic, algebraic),
                          of_moving = own.partialPivLu().solve(Eigen::MatrixXd(J(algebraic, moving)));
    A -= by_algebraic * of_moving;
  }
  for (std::size_t i = 0; i < moving.size(); ++i)
    for (std::size_t j = 0; j < moving.size(); ++j) A(i, j) *= scale[moving[j]] / (scale[moving[i]] * mass[moving[i]]);
  return {std::move(moving), std::move(A)};
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
