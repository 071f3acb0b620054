/// What a model says to a measurement, and how that changes with its numbers: frequency responses, steady curves,
/// velocity steps and holds.
#pragma once
#include <string>
#include <vector>

#include "oscillators/model.hpp"

namespace rosin::analysis::inference {

using oscillators::Model;

/// One set of numbers, each with its standard error.
struct Measurement {
  enum class Kind {
    frequency_response,  ///< x: Hz; y: real and imaginary part of Z in turn, N s/m
    velocity_step,       ///< x: s after the step of an imposed slip rate; y: friction coefficient
    steady_curve,        ///< x: m/s; y: friction coefficient
    hold,                ///< x: s that the drive rests; y: peak coefficient as it resumes, behind the contact's spring
  };
  Kind kind = Kind::frequency_response;
  std::string name;
  double slip_rate = 1;       ///< mean, before the step, or around the hold, m/s
  double next_slip_rate = 1;  ///< after the step, m/s
  double normal_load = 1;     ///< N
  std::vector<double> x, y, error;
};

/// The model's y of a measurement, and ∂y/∂p of each number asked for.
struct Prediction {
  std::vector<double> y;
  std::vector<std::vector<double>> slopes;  ///< by number, then by y
};

/// What a model says to a measurement's x, as its y, with slopes by the numbers at `paths`: exact for responses and
/// steady curves; motion and its variational equations by collocation at 1e-10 for steps and holds.
/// \throws InputError where the law does not answer, and where no slope exists (analysis/response/contact_slopes.hpp).
Prediction predict(const Model&, const Measurement&, const std::vector<std::string>& paths = {});

}  // namespace rosin::analysis::inference
