/// Where steady sliding loses or regains its stability along a parameter, undamped merging of modes included.
#pragma once
#include <functional>
#include <vector>

#include "analysis/steady/structure_stability.hpp"

namespace rosin::analysis::steady {

/// A value of the parameter at which the largest growth rate crosses 0.
struct Threshold {
  double value, error;       ///< absolute
  bool onset;                ///< unstable above the value; else below
  double angular_frequency;  ///< rad/s, of the mode that grows; 0: divergence
  StructureStability at;
};

struct Scan {
  std::vector<double> values;                                   ///< of the parameter, ascending
  std::vector<std::vector<std::complex<double>>> eigenvalues;  ///< [value]; each a branch from value to value
  std::vector<Threshold> thresholds;                            ///< ascending
};

/// Stability at each of the values, ascending, and the thresholds between them. A threshold of a damped structure is a
/// simple root of the growth rate. Where two undamped modes merge, the growth rate begins as the root of the distance:
/// its square, continued to 0, has the simple root (Hoffmann & Gaul 2003, Z. Angew. Math. Mech. 83, 524). Two
/// thresholds nearer to each other than the values show only where the growth rate has a maximum between them.
Scan scan(const std::function<StructureStability(double)>& stability_at, std::vector<double> values);

}  // namespace rosin::analysis::steady
