/// Where steady sliding loses or regains its stability along a parameter, undamped merging of modes included.
#pragma once
#include <cmath>
#include <functional>
#include <vector>

#include "analysis/steady/structure_stability.hpp"

namespace rosin::analysis::steady {

/// The mode that grows fastest; NaN where there is no steady sliding.
struct Leading {
  double growth, error;      ///< 1/s, and what rounding leaves of it
  double angular_frequency;  ///< rad/s; 0: divergence
  bool grows() const { return growth > error; }
  bool is_neutral() const { return std::abs(growth) <= error; }
};

/// A value of the parameter at which the largest growth rate crosses 0.
struct Crossing {
  double value, error;       ///< absolute
  bool onset;                ///< unstable above the value; else below
  double angular_frequency;  ///< rad/s, of the mode that grows
};

/// Crossings between neighbours of the values, ascending. Of damped structures each is a simple root of the growth
/// rate. Where two undamped modes merge, the growth rate begins as the root of the distance: its square, continued to
/// 0, has the simple root (Hoffmann & Gaul 2003, Z. Angew. Math. Mech. 83, 524). Two crossings between the same
/// neighbours show only where the growth rate has a maximum there.
std::vector<Crossing> crossings(const std::function<Leading(double)>&, const std::vector<double>& values);

/// A crossing, and the structure there.
struct Threshold : Crossing {
  StructureStability at;
};

/// The crossing between a value where a mode does not grow and one where it does.
Crossing locate(const std::function<Leading(double)>&, double calm, double growing);

}  // namespace rosin::analysis::steady
