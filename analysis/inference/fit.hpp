/// Parameters of any law from measurements: frequency responses, velocity steps, steady curves, holds, or several
/// together.
///
/// Weighted least squares by trust-region Levenberg-Marquardt (GSL), in ln p for parameters that are positive, with
/// derivatives by dual numbers and variational equations (analysis/inference/measurement.hpp); several starts;
/// intervals from the covariance and from the profile of the likelihood; ranking by AIC, BIC and cross-validation.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "analysis/inference/measurement.hpp"
#include "core/error.hpp"

namespace rosin::analysis::inference {

struct FitOptions {
  std::vector<std::string> parameters;  ///< paths
  int starts = 4;                       ///< the model's own values, and random ones within a factor of 30
  std::uint64_t seed = 1;
  bool profiles = true;
  int folds = 5;  ///< of cross-validation; 0: none
  double confidence = 0.95;
  std::function<void(int done, int total)> progress = {};  ///< called after each minimisation, of so many at most
};

struct FittedParameter {
  std::string path, unit;
  double value = 0, standard_error = 0;
  /// Interval from the covariance, in ln p for positive parameters. NaN, as the standard error, where the data do not
  /// determine the number.
  double low = 0, high = 0;
  double profile_low = 0, profile_high = 0;  ///< from the profile of the likelihood; NaN if not asked for
  bool at_bound = false;
};

struct Fit {
  Model model;  ///< with the fitted values
  std::vector<FittedParameter> parameters;
  std::vector<double> correlation;  ///< row-major, of the fitted variables
  double chi_square = 0;
  int points = 0, converged_starts = 0;
  double aic = 0, bic = 0;      ///< up to a constant of the data: χ² + 2 k and χ² + k ln n
  double cross_validation = 0;  ///< mean squared standardised residual of points left out; NaN if not asked for
  std::vector<std::vector<double>> residuals;  ///< standardised, of each measurement
  std::vector<std::string> warnings;
  Outcome outcome;  ///< none_exists where the data do not determine a number; budget_spent without convergence
};

/// \throws InputError unless a fit can find the number at `path`: one of the law or its contact, finite, and above 0
/// where it cannot be negative.
void require_fittable(const Model&, const std::string& path);

/// \throws InputError for unknown or unfit parameters, errors that are not positive, and fewer points than parameters.
Fit fit(const Model&, const std::vector<Measurement>&, const FitOptions&);

}  // namespace rosin::analysis::inference
