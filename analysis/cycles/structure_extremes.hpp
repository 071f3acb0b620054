/// Extremes over the period of a structure of numbers that are sums of its coordinates.
#pragma once
#include <Eigen/Core>

#include "analysis/cycles/structure_cycle.hpp"

namespace rosin::analysis::cycles {

/// Least and largest value of Σ weightᵢ qᵢ, by the polynomials of the steps. Error: of each, from those of the
/// coordinates' extremes and what the polynomials miss of these.
struct ExtremesOfPeriod {
  double low, high, error;
};
ExtremesOfPeriod extremes_of(const StructureCycle&, const Eigen::VectorXd& weights);

}  // namespace rosin::analysis::cycles
