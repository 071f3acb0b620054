/// Floquet multipliers, each with an error, or left out with the reason.
#pragma once
#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "analysis/cycles/return_map.hpp"

namespace rosin::analysis::cycles {

/// What small disturbances of a periodic motion are multiplied by in a period, largest modulus first, without the
/// trivial 1.
struct Multipliers {
  std::vector<std::complex<double>> values;
  std::vector<double> errors;  ///< absolute, in modulus
  std::string left_out;        ///< why some, or all, are not known; empty: all are
};

/// Eigenvalues, largest modulus first.
std::vector<std::complex<double>> by_modulus(const Eigen::MatrixXd&);
/// Of the derivative of a return to a section, without the trivial one. `scale`: of its unknowns.
std::vector<std::complex<double>> multipliers_of(const Eigen::MatrixXd& derivative, const Eigen::VectorXd& scale);

/// The `fine` ones, known to their difference from the `coarse` ones, found less closely; those that are not known to
/// a tenth are left out.
Multipliers known_multipliers(const std::vector<std::complex<double>>& coarse, std::vector<std::complex<double>> fine);

/// Of the cycle through the section at y after so many turns: the derivative of the return map at two tolerances, 1e-9
/// and 1e-11. Steps end where slip reverses, and disturbances are kept across the motion. `closes`: each at its own
/// fixed point, which the derivative itself leads to; else at y.
Multipliers cycle_multipliers(ReturnMap&, std::vector<double> y, int turns, double amplitude, bool closes);

}  // namespace rosin::analysis::cycles
