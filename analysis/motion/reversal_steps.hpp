/// Step bounds near a reversal of slip, for states of a contact that evolve differently close to rest.
#pragma once
#include <functional>
#include <vector>

#include "oscillators/slider_system.hpp"
#include "oscillators/structure_system.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::motion {

/// Slip rate (m/s), far below the drive speed, under which a state of the contact evolves differently than in faster
/// slip, as a state that heals below a speed of its own; 0 where there is none.
double near_rest_slip_rate(const oscillators::SliderSystem&);
/// The same of a law, far below slip rate V under load N.
double near_rest_slip_rate(const FrictionLaw&, double lambda, double V, double N);

/// Bounds steps where slip decelerates to a reversal, so that each ends before it. Slip passes through the range below
/// near_rest_slip_rate() so fast that a longer step sees it at neither of its ends. Infinite where there is no such
/// range.
class ReversalSteps {
 public:
  static constexpr double share = 0.5;             ///< largest relative loss of slip rate in a step
  static constexpr double near_rest_share = 1e-3;  ///< loss allowed in any step, over near_rest_slip_rate()

  /// The system must outlive the bounds.
  explicit ReversalSteps(const oscillators::SliderSystem&, double share = ReversalSteps::share);
  explicit ReversalSteps(const oscillators::StructureSystem&, double share = ReversalSteps::share);
  /// Longest next step (s) after one from (t0, y0) to (t1, y1). `length`: its duration, which t1 − t0 may have lost to
  /// rounding.
  double longest(double t0, const double* y0, double t1, const double* y1, double length) const;
  double longest(const solvers::steps::Collocation& last) const {
    return longest(last.time_before(), last.state_before().data(), last.time(), last.state().data(), last.length());
  }

 private:
  struct At {
    double near_rest;  ///< m/s
    std::function<double(double t, const double* y)> slip_rate;
  };
  double share_;
  std::vector<At> contacts_;  ///< those that have such a range
};

}  // namespace rosin::analysis::motion
