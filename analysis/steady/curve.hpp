/// The steady friction curve of a law and its extrema.
#pragma once
#include <vector>

#include "laws/law.hpp"

namespace rosin::analysis::steady {

/// μ_ss at each of these slip rates (m/s).
std::vector<double> steady_curve(const FrictionLaw&, const std::vector<double>& slip_rates, double normal_load);

struct Extremum {
  bool maximum;      ///< else minimum
  double slip_rate;  ///< m/s
  double friction_coefficient;
  double slip_rate_error;  ///< absolute
};

/// Extrema of μ_ss(v) for v in [low, high] m/s at the given load, by bracketing the zeros of dμ_ss/dv on a logarithmic
/// grid of 64 points a decade and bisection of the exact derivative to rounding. Pairs closer than a grid cell are
/// missed.
std::vector<Extremum> steady_extrema(const FrictionLaw&, double low, double high, double normal_load = 1);

/// True if μ_ss falls with v somewhere in 1e-14 … 1e3 m/s, so that self-excited motion is possible at all.
bool weakens_somewhere(const FrictionLaw&, double normal_load);

}  // namespace rosin::analysis::steady
