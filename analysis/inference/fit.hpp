/// Parameters of any law from measurements: frequency responses, velocity steps, steady curves, holds, recorded
/// motion, or several together.
///
/// Weighted least squares by trust-region Levenberg-Marquardt (GSL), in ln p for parameters that are positive, with
/// derivatives by dual numbers and variational equations (analysis/inference/measurement.hpp), together with the terms
/// of each laboratory: trend, level, offset of the clock. Noise whose size is not given comes from the residuals,
/// with the correlation of neighbours (analysis/inference/noise.hpp). Intervals from the covariance and from the
/// profile of the likelihood; ranking by AIC, BIC and cross-validation.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/inference/derived.hpp"
#include "analysis/inference/measurement.hpp"
#include "analysis/inference/misfit.hpp"
#include "analysis/inference/noise.hpp"
#include "core/error.hpp"

namespace rosin::analysis::inference {

struct FitOptions {
  std::vector<std::string> parameters;  ///< paths
  /// The model's own values, and random ones within a factor of 30. Nothing: 1, and 4 if the first leaves a doubt.
  std::optional<int> starts = {};
  std::uint64_t seed = 1;
  std::optional<bool> profiles = {};  ///< of all parameters or none; nothing: of those whose covariance is in doubt
  int folds = 0;                      ///< of cross-validation; 0: none
  double confidence = 0.95;
  std::vector<DerivedNumber> derived = {};                 ///< numbers that follow from the fitted ones
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
  bool withheld = false;  ///< the interval, because the law does not describe the data
};

/// What a fit leaves of one measurement.
struct FittedMeasurement {
  std::vector<double> fitted;     ///< y of the model with all terms
  std::vector<double> residuals;  ///< y − fitted, over the standard error
  std::vector<double> error;      ///< standard error of each y, given or found
  std::vector<char> bounded;      ///< true of each y at rest under a law that sticks: it is bounded, not predicted
  bool error_found = false;       ///< from the residuals
  SeriesNoise noise;              ///< found, or of size 1 and uncorrelated
  Neighbours neighbours;          ///< of residuals whose correlation, where one was found, is taken out
  std::optional<Misfit> misfit;   ///< that is no noise: then no number has an interval
};

struct Fit {
  Model model;  ///< with the fitted values
  /// Those of the model, then terms of the laboratory: "data.1.trend", …, counted from 1.
  std::vector<FittedParameter> parameters;
  /// Each by its name as path. Standard error √(gᵀCg) of its slopes g and the covariance C, also where the data know
  /// the fitted numbers in this combination only; interval: its extremes over the ellipsoid of fitted variables in
  /// which each of them alone has its own interval.
  std::vector<FittedParameter> derived;
  std::vector<double> correlation;  ///< row-major, of the fitted variables
  double chi_square = 0;
  int points = 0;  ///< that are predicted
  int converged_starts = 0;
  /// Up to a constant of the data: D + 2 k and D + k ln n with D = χ², or where the size σ of noise was found,
  /// n ln σ² + (n − 1) ln(1 − ρ²) of these n numbers; k counts σ and ρ.
  double aic = 0, bic = 0;
  double cross_validation = 0;  ///< mean squared standardised residual of points left out; NaN if not asked for
  std::vector<FittedMeasurement> measurements;
  long predictions = 0, steps = 0;     ///< work: calls of the model, and steps of motion in them
  std::vector<std::string> decisions;  ///< what was left out as not needed, or done as needed, and why
  std::vector<std::string> warnings;
  Outcome outcome;  ///< none_exists where the data do not determine a number; budget_spent without convergence
};

/// \throws InputError unless a fit can find the number at `path`: one of the law or its contact, of the slider where
/// data know one, or any of a machine that is among the data; finite, and above 0 where it cannot be negative.
void require_fittable(const Subject&, const std::string& path, bool with_slider);

/// \throws InputError for unknown or unfit parameters, errors that are not positive, and fewer points than parameters.
Fit fit(const Subject&, const std::vector<Measurement>&, const FitOptions&);

}  // namespace rosin::analysis::inference
