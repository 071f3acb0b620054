/// Systems of linear equations, whose factorisations by Eigen, slow to compile, are compiled once for all who solve
/// one.
#pragma once
#include <Eigen/Core>

namespace rosin {

/// x of A·x = b with a square A, by LU with row pivoting. Not finite where A is singular.
Eigen::VectorXd solve_linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// The same for each column of B, by one factorisation.
Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// x that makes |A·x − b| least, by QR with column pivoting.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// x of A·x = b with a square A. Where rounding alone keeps A from being singular, of all such x the one that changes
/// nothing that A leaves open: ℓᵀx = 0 for all ℓᵀA = 0.
Eigen::VectorXd solve_within_range(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace rosin
