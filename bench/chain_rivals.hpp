/// A chain of blocks on a belt under a smooth friction law, followed by CVODE with its banded linear solver.
#pragma once
#include <string>
#include <vector>

namespace bench {

/// Blocks of mass 1 in a row: q̈ᵢ = −pull qᵢ + coupling (qᵢ₋₁ − 2 qᵢ + qᵢ₊₁) + μ(vᵢ), without neighbours at the ends;
/// vᵢ = speed − q̇ᵢ and μ(v) = (μ_d + (μ_s − μ_d)/(1 + (v/v₁)²)) v/√(v² + v₀²). All begin with the belt's speed.
struct ChainProblem {
  double pull = 1, coupling = 25, speed = 0.1, mu_s = 0.6, mu_d = 0.4, v0 = 0.01, v1 = 0.1;
  std::vector<double> start;  ///< qᵢ, m
  double duration = 0;        ///< s
};

struct ChainMotion {
  std::vector<double> q = {};  ///< at the end
  long steps = 0;
  std::string failure = {};
};

/// BDF with a banded Jacobian of displacements and velocities in turn, as its user would write it for this problem.
ChainMotion follow_cvode_chain(const ChainProblem&, double tolerance);

}  // namespace bench
