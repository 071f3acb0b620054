/// Eigenvalues of a product of matrices that is never formed: moduli may lie hundreds of decades apart.
#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

namespace rosin {

/// Eigenvalues of A_N ⋯ A_2 A_1, largest modulus first, each to the rounding of the factors. Beside an eigenvalue of
/// 1e26 the product itself keeps the others to 1e10 at best. Factors may be rectangular, if the product is square. NaN
/// throughout where a factor is not finite.
std::vector<std::complex<double>> product_eigenvalues(const std::vector<Eigen::MatrixXd>& factors);

}  // namespace rosin
