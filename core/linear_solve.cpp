/// The one place where Eigen's LU and QR of real matrices of any size are compiled.
#include "core/linear_solve.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

namespace rosin {

Eigen::VectorXd solve_linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.partialPivLu().solve(b); }

Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A.partialPivLu().solve(B); }

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}

Eigen::VectorXd solve_within_range(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  const auto qr = A.colPivHouseholderQr();
  const Eigen::Index n = A.rows(), open = n - qr.rank();
  if (open == 0) return qr.solve(b);
  const Eigen::MatrixXd Q = qr.householderQ();
  Eigen::MatrixXd rows(n + open, n);
  rows << A, Q.rightCols(open).transpose();
  Eigen::VectorXd values(n + open);
  values << b, Eigen::VectorXd::Zero(open);
  return least_squares(rows, values);
}

}  // namespace rosin
