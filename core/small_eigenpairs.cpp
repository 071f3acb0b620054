/// The one place where Eigen's eigenvalue solver of small matrices is compiled.
#include <array>

#include "core/balance.hpp"
#include "core/solve_eigenpairs.hpp"

namespace rosin {

SmallEigenpairs small_eigenpairs(SmallMatrix<double> A, bool with_vectors) {
  std::array<double, most_small_rows> unit;
  unit.fill(1);
  balance(A, unit);
  auto pairs = solve_eigenpairs<SmallEigenpairs>(A, with_vectors);
  for (int i = 0; i < pairs.vectors.rows(); ++i) pairs.vectors.row(i) *= unit[i];
  return pairs;
}

}  // namespace rosin
