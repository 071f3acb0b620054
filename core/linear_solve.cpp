/// The one place where Eigen's LU and QR of real matrices of any size are compiled for a single right side.
#include "core/linear_solve.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

namespace rosin {

Eigen::VectorXd solve_linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.partialPivLu().solve(b); }

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}

}  // namespace rosin
