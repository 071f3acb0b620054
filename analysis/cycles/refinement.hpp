/// Errors of a cycle from two refinements of it.
#pragma once
#include <string>

#include "analysis/cycles/cycle.hpp"

namespace rosin::analysis::cycles {

/// Errors of `fine` from its difference to `coarse`, a result at 100 times the tolerance or more. They are never below
/// the tolerance, rounding error and `closure`, the remaining relative change from period to period. Where errors
/// scatter, the difference counts `caution` times. \returns the largest ratio of error to size, with its metric
/// `worst`.
double estimate_errors(const Metrics& coarse, const Metrics& fine, double tolerance, double closure, double V,
                       bool stick_is_ill_conditioned, Metrics& error, std::string& worst, double caution = 1);

/// States the errors of all metrics with_caution.
void state_with_caution(Metrics& error, const Metrics&, double requested, double V);

/// The tolerances of successive refinements of a cycle, each tighter than the one before, until its errors meet the
/// requested tolerance.
class Sharpening {
 public:
  /// `first`: the loosest tolerance.
  Sharpening(double requested, double first) : requested_(requested), tolerance_(first) {}
  double tolerance() const { return tolerance_; }
  /// Moves to the next tolerance. False after the last.
  bool next();
  /// After a refinement that spent its budget: moves back to the geometric mean of the last two tolerances, once. False
  /// for another outcome, or the second time.
  bool loosen(const Outcome&);
  /// Judges the largest ratio of error to size, `reached`, of the metric `worst`. \returns the cycle's outcome.
  Outcome judge(double reached, const std::string& worst);
  /// True if a refinement replaces the `known` cycle: its largest error ratio `reached` is smaller, or the two differ
  /// by more than their errors. Finer steps are not always better: they may resolve ringing that coarser ones pass
  /// over, or only add rounding error.
  bool supersedes(const Cycle& known, const Metrics&, const Metrics& error, double reached);

 private:
  double requested_, tolerance_, before_ = 0, factor_ = 0.01, least_reached_ = infinity;
  int attempts_ = 0;
  bool loosened_ = false;
};

}  // namespace rosin::analysis::cycles
