/// Balancing of a matrix whose unknowns have units of their own.
#pragma once
#include <cmath>

namespace rosin {

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

}  // namespace rosin
