/// Test for modes that grow faster than an implicit step resolves.
#pragma once
#include <vector>

#include "solvers/steps/lu.hpp"

namespace rosin::solvers::steps {

/// Implicit steps damp modes that grow too fast for them: their stages follow a slow motion, which the true solution
/// leaves at once, at every tolerance alike. The test needs no eigenvalues. For moving unknowns with masses mᵢ and
/// rates λᵢ, det(r M − J) = det(−J_aa) Π mᵢ (r − λᵢ) with J_aa for the algebraic ones, so that the signs of two
/// determinants differ where an odd number of real rates exceeds r. A rate r between the rates of two growing modes
/// shows both.
class GrowthTest {
 public:
  explicit GrowthTest(int unknowns) : pivot_(unknowns) { matrix_.reserve(unknowns * unknowns); }

  /// True if in M ẏ = J y an odd number of modes grows faster than `rate` (1/s) without oscillating. `jacobian`:
  /// row-major. Does not allocate.
  bool faster_than(double rate, const std::vector<double>& mass, const std::vector<double>& jacobian) {
    const int n = int(mass.size());
    matrix_.clear();
    int algebraic = 0;
    for (int i = 0; i < n; ++i) {
      algebraic += mass[i] == 0;
      for (int j = 0; j < n; ++j) matrix_.push_back((i == j ? rate * mass[i] : 0) - jacobian[i * n + j]);
    }
    const int all = sign(n);
    matrix_.clear();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (mass[i] == 0 && mass[j] == 0) matrix_.push_back(-jacobian[i * n + j]);
    return all * sign(algebraic) < 0;
  }

 private:
  /// Sign of the determinant of the matrix; 0 where the matrix is singular.
  int sign(int rows) { return factorise_lu(matrix_, pivot_, rows) ? determinant_sign(matrix_, pivot_, rows) : 0; }
  std::vector<double> matrix_;
  std::vector<int> pivot_;
};

}  // namespace rosin::solvers::steps
