/// What two refinements of a cycle tell of its errors.
#pragma once
#include <string>

#include "analysis/cycle.hpp"

namespace rosin::analysis {

/// Errors of `fine` by its difference to `coarse`, a result at a hundred times the tolerance or more; never below what
/// the tolerance, rounding and `closure`, the relative change that is left from period to period, allow. Where errors
/// scatter, `caution` times the difference is stated. \returns the worst ratio of error to size, of the metric `worst`.
double estimate_errors(const Metrics& coarse, const Metrics& fine, double tolerance, double closure, double V,
                       bool stick_is_ill_conditioned, Metrics& error, std::string& worst, double caution = 1);

/// The next factor on the tolerance where the error found is to fall by `wanted`: errors of moderately stiff unknowns
/// follow the estimate, which is the tolerance to the power 2/3.
double next_sharpening(double wanted);

}  // namespace rosin::analysis
