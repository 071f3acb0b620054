/// The search for the fixed point of the return map that motion from stick, or from a given start, settles on.
#pragma once
#include <optional>
#include <vector>

#include "analysis/cycles/return_map.hpp"
#include "analysis/cycles/slow_swing.hpp"

namespace rosin::analysis::cycles {

/// A fixed point of the return map.
struct FixedPoint {
  std::vector<double> y;
  Eigen::MatrixXd derivative;
  int turns = 1;
  double amplitude = 0;
  bool by_differences = false;                  ///< the derivative is that of neighbouring passages
  bool bounded = false;                         ///< no more is known than that it is smaller
  std::optional<SlowEnd> swing = std::nullopt;  ///< friction changes it by too little in a turn to show in `y`
  /// Of a swing that friction all but leaves alone: where the motion began, the passages since then, and its growth.
  struct Free {
    std::vector<double> start;
    int passages;
    double growth;
  };
  std::optional<Free> free = std::nullopt;
};

double spectral_radius(const FixedPoint&, const ReturnMap&);

struct SearchResult {
  std::optional<FixedPoint> point;  ///< attracts; known as closely as the search needs, to a thousandth or better
  Outcome outcome;                  ///< where there is none: why
};
/// `drift_at_rest`: growth of a small oscillation about steady sliding in one period, ln(A'/A).
SearchResult search_cycle(ReturnMap&, double drift_at_rest, const CycleOptions&);

}  // namespace rosin::analysis::cycles
