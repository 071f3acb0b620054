/// An elastic block on a belt, followed by CVODE with a sparse direct solver.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace bench {

/// M q̈ + β K q̇ + K q + k e (eᵀ q) = f + Σ A (n p − t τ), M diagonal: at a station the approach a = −n-displacement and
/// the slip rate w = t-velocity − V give p = c a₊² + b a₊² ȧ and τ = μ c a₊² ψ(w), ψ = (2 − |w|/ε) w/ε within ε of
/// rest and the sign of w beyond.
struct BlockProblem {
  std::vector<double> mass;
  std::vector<int> row_start, column;  ///< of K, by rows, each with its diagonal
  std::vector<double> stiffness;
  std::vector<double> spring_row, force;
  double spring = 0.05, stiffness_damping = 1e-3;
  struct Station {
    std::array<int, 3> x, y;  ///< coordinates that move it along the belt and upwards
    std::array<double, 3> shape;
    double area;
  };
  std::vector<Station> stations;
  double coefficient = 0.25, damping = 0.01, friction = 0.5, speed = 0.1, width = 0.005;
  std::vector<double> start;      ///< q, from which it starts at rest
  double from = 0, duration = 0;  ///< s: friction is averaged from the one to the other
};

struct BlockMotion {
  double friction = 0;  ///< mean friction force over mean load
  long steps = 0;
  std::string failure = {};
};

/// BDF with the exact sparse Jacobian, solved by KLU, as its user would write it for this problem. The equations have
/// no jump, so that no root is looked for. Impulses of friction and of the load are unknowns.
BlockMotion follow_cvode_block(const BlockProblem&, double tolerance);
/// Largest deviation of the Jacobian from differences at the start, over its largest entry.
double block_jacobian_defect(const BlockProblem&);

}  // namespace bench
