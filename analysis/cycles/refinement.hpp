/// What two refinements of a cycle tell of its errors.
#pragma once
#include <string>

#include "analysis/cycles/cycle.hpp"

namespace rosin::analysis::cycles {

/// Errors of `fine` by its difference to `coarse`, a result at a hundred times the tolerance or more; never below what
/// the tolerance, rounding and `closure`, the relative change that is left from period to period, allow. Where errors
/// scatter, `caution` times the difference is stated. \returns the worst ratio of error to size, of the metric `worst`.
double estimate_errors(const Metrics& coarse, const Metrics& fine, double tolerance, double closure, double V,
                       bool stick_is_ill_conditioned, Metrics& error, std::string& worst, double caution = 1);

/// States the errors of all metrics with_caution.
void state_with_caution(Metrics& error, const Metrics&, double asked, double V);

/// The tolerances of the refinements of a cycle, each finer than the one before, until the error asked for is met.
class Sharpening {
 public:
  /// `first`: the tolerance of the coarsest.
  Sharpening(double asked, double first) : asked_(asked), tolerance_(first) {}
  double tolerance() const { return tolerance_; }
  /// Turns to the next tolerance. False after the last.
  bool next();
  /// After a refinement that ended so: turns back to one half as fine, on a scale of powers, where it spent its budget.
  /// False where that will not do, or was done before.
  bool ease(const Outcome&);
  /// Takes the worst ratio of error to size, that of the metric `worst`. \returns how well the cycle is known.
  Outcome judge(double reached, const std::string& worst);
  /// True if a refinement is to take the place of what is `known` of the cycle: it is known better, by the worst ratio
  /// `reached`, or refutes that. Finer steps may follow what coarser ones pass over, and lose themselves in it, or do
  /// nothing but round more often.
  bool supersedes(const Cycle& known, const Metrics&, const Metrics& error, double reached);

 private:
  double asked_, tolerance_, before_ = 0, factor_ = 0.01, least_reached_ = infinity;
  int attempts_ = 0;
  bool eased_ = false;
};

}  // namespace rosin::analysis::cycles
