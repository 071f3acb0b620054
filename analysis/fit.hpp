/// Parameters of any law from measurements: frequency responses, velocity steps, steady curves, holds, or several
/// together.
///
/// Weighted least squares by trust-region Levenberg-Marquardt (GSL), in ln p for parameters that are positive, with
/// derivatives by central differences of the predictions (relative error 1e-8); several starts; intervals from the
/// covariance and from the profile of the likelihood; ranking by AIC, BIC and cross-validation.
#pragma once
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "oscillators/model.hpp"

namespace rosin::analysis {

using oscillators::Model;

/// One set of numbers, each with its standard error.
struct Measurement {
  enum class Kind {
    frequency_response,  ///< x: Hz; y: real and imaginary part of Z in turn, N s/m
    velocity_step,       ///< x: s after the step of an imposed slip rate; y: friction coefficient
    steady_curve,        ///< x: m/s; y: friction coefficient
    hold,                ///< x: s at rest; y: peak coefficient as sliding resumes, on a stiff machine
  };
  Kind kind = Kind::frequency_response;
  std::string name;
  double slip_rate = 1;       ///< mean, before the step, or around the hold, m/s
  double next_slip_rate = 1;  ///< after the step, m/s
  double normal_load = 1;     ///< N
  std::vector<double> x, y, error;
};

/// What a model says to a measurement's x, as its y. \throws InputError where the law does not answer.
std::vector<double> predict(const Model&, const Measurement&);

struct FitOptions {
  std::vector<std::string> parameters;  ///< paths
  int starts = 4;                       ///< the model's own values, and random ones within a factor of 30
  std::uint64_t seed = 1;
  bool profiles = true;
  int folds = 5;  ///< of cross-validation; 0: none
  double confidence = 0.95;
};

struct FittedParameter {
  std::string path, unit;
  double value = 0, standard_error = 0;
  double low = 0, high = 0;                  ///< interval from the covariance, in ln p for positive parameters
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
  Outcome outcome;
};

/// \throws InputError for unknown or unfit parameters, errors that are not positive, and fewer points than parameters.
Fit fit(const Model&, const std::vector<Measurement>&, const FitOptions&);

}  // namespace rosin::analysis
