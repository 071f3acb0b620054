/// Floquet multipliers, each with an error, or left out with the reason.
#pragma once
#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "analysis/cycles/return_map.hpp"

namespace rosin::analysis::cycles {

/// Factors by which small disturbances of a periodic motion grow in a period, largest modulus first, without the
/// trivial 1.
struct Multipliers {
  std::vector<std::complex<double>> values;
  std::vector<double> errors;  ///< absolute, in modulus
  std::string left_out;        ///< the reason why some, or all, are not known; empty: all are
};

/// Eigenvalues, largest modulus first.
std::vector<std::complex<double>> by_modulus(const Eigen::MatrixXd&);
/// Multipliers from the derivative of a return to a section, without the trivial one. `scale`: scales of its unknowns.
std::vector<std::complex<double>> multipliers_of(const Eigen::MatrixXd& derivative, const Eigen::VectorXd& scale);

/// The `fine` multipliers with their differences from the `coarse` ones as errors; those not known to a tenth are left
/// out.
Multipliers known_multipliers(const std::vector<std::complex<double>>& coarse, std::vector<std::complex<double>> fine);

/// Multipliers of the cycle that closes at y on the section after `returns` returns, from the derivative of the return
/// map at tolerances 1e-9 and 1e-11. Steps end where slip reverses, and disturbances are kept across the motion. With
/// `closes` each derivative is taken at its own fixed point, found by Newton's method; else at y.
Multipliers cycle_multipliers(ReturnMap&, std::vector<double> y, int returns, double amplitude, bool closes);

}  // namespace rosin::analysis::cycles
