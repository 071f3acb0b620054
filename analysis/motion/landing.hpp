/// Steps that do not pass over what the states of a contact do only where slip is all but at rest.
#pragma once
#include "oscillators/slider_system.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::motion {

/// Slip rate (m/s) beside rest within which a state of the contact evolves otherwise than wherever slip is faster, as
/// those do that heal below a speed of their own; 0 where none does, far below the speed of the drive.
double narrow_slip_rate(const oscillators::SliderSystem&);

/// Bounds steps where slip slows down to a reversal, so that they land before it by ever shorter ways: slip passes
/// through what is narrow in a time that shows at neither end of a longer step. Infinite where nothing is.
class LandingSteps {
 public:
  static constexpr double share = 0.5;  ///< of the slip rate that a step may take away
  static constexpr double part = 1e-3;  ///< of what is narrow, which it may always

  /// The system must outlive it.
  explicit LandingSteps(const oscillators::SliderSystem& system, double share = LandingSteps::share)
      : system_(system), share_(share), narrow_(narrow_slip_rate(system)) {}
  /// Time (s) that the next step may take, after one from (t0, y0) to (t1, y1). Its length may be less than the clock
  /// shows.
  double time(double t0, const double* y0, double t1, const double* y1, double length) const;
  double time(const solvers::steps::Collocation& last) const {
    return time(last.time_before(), last.state_before().data(), last.time(), last.state().data(), last.length());
  }

 private:
  const oscillators::SliderSystem& system_;
  double share_, narrow_;
};

}  // namespace rosin::analysis::motion
