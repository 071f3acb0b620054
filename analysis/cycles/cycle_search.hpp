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
  int returns = 1;
  double amplitude = 0;
  bool by_differences = false;  ///< the derivative comes from neighbouring returns
  bool bounded = false;         ///< the derivative is an upper bound only
  std::optional<SlowEnd> swing =
      std::nullopt;  ///< set where friction changes the amplitude by too little in a period to show in `y`
  /// A nearly conservative oscillation: the start of the motion, the returns since then, and the growth per period.
  struct Free {
    std::vector<double> start;
    int returns;
    double growth;
  };
  std::optional<Free> free = std::nullopt;
};

double spectral_radius(const FixedPoint&, const ReturnMap&);

struct SearchResult {
  std::optional<FixedPoint> point;   ///< an attracting one, to a relative 1e-3 or better
  Outcome outcome;                   ///< the reason where there is no point
  std::optional<Exponent> exponent;  ///< the largest, where a motion goes on without a period
};
/// `growth_about_steady`: growth ln(A'/A) per period of a small oscillation about steady sliding.
SearchResult search_cycle(ReturnMap&, double growth_about_steady, const CycleOptions&);

}  // namespace rosin::analysis::cycles
