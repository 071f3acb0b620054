/// Swings: free oscillations of a slider on its spring whose amplitude friction changes by little in a period. In a
/// slip at 10¹⁰ times the drive speed, where weakening friction has nearly vanished, the change is below rounding error
/// of the displacement. The work of friction over the period gives it to the accuracy of the motion.
#pragma once
#include <optional>
#include <vector>

#include "analysis/cycles/return_map.hpp"

namespace rosin::analysis::cycles {

/// The work of all forces except the spring's on motion relative to the drive, over the steps of a period from v = V to
/// v = V.
class SwingWork final : public StepObserver {
 public:
  /// `reference`: constant force about which the slider oscillates, N. Rounding error is least near the mean friction.
  SwingWork(const oscillators::SliderSystem&, double reference);
  void step(solvers::steps::Collocation&) override;
  /// ln of the growth per period of the `stretch`, the amplitude (m) about the point where the spring holds the
  /// reference; and the same if all work had one sign.
  double growth(double stretch) const;
  double turnover(double stretch) const;
  double mean_friction() const { return impulse_ / time_; }

 private:
  const oscillators::SliderSystem& system_;
  double reference_;
  std::vector<double> y_;
  double gained_ = 0, moved_ = 0, impulse_ = 0, time_ = 0;
};

/// One period from the section v = V, with the state of the contact that repeats itself at this amplitude.
struct SlowSwing {
  std::vector<double> y;             ///< on the section
  double middle = 0;                 ///< centre of the oscillation, where the spring holds the mean friction, m
  double stretch = 0;                ///< amplitude: displacement of y from the centre, m
  double growth = 0;                 ///< ln of the amplitude growth per period
  double turnover = 0;               ///< the same if all work of friction had one sign
  double scatter = 0;                ///< change of the growth from period to period, by errors of the steps
  double amplitude = 0;              ///< largest |v − V|/V
  Eigen::MatrixXd state_derivative;  ///< derivative of the contact's unknowns over a period; empty: it forgets them
};

/// The swing from a displacement (m) on the section, starting from the swing `near` it. Nothing where the motion does
/// not return after one period, or the state of its contact does not converge.
std::optional<SlowSwing> swing_at(ReturnMap&, const SlowSwing& near, double displacement, double tolerance);

/// The swing from the point y on the section. Nothing where the slider is no oscillator on a rigid contact, or the work
/// of friction in a period exceeds a small part of its energy.
std::optional<SlowSwing> slow_swing_from(ReturnMap&, const std::vector<double>& y, double tolerance);

/// The end of slow amplitude growth.
struct SlowEnd {
  std::optional<SlowSwing> balance;   ///< swing of zero growth that attracts, to 1e-7 of its amplitude
  double slope = 0, slope_error = 0;  ///< d growth / d ln stretch there, below 0
  std::optional<SlowSwing> last;      ///< without a balance: the last swing that returned after one period
  double periods = 0;                 ///< number of periods from the start to there, roughly
};
SlowEnd follow_slow_swing(ReturnMap&, const SlowSwing& start, double tolerance);

/// A swing after one that decayed until the slider stuck: the spread of ln stretch with the phase of the last swing at
/// which it stuck, and the growth per period. Nothing if no swing follows.
struct AfterStick {
  double spread, growth;
};
std::optional<AfterStick> swing_after_stick(ReturnMap&, const SlowSwing& last, const SlowSwing& first,
                                            double tolerance);

/// Moves a balanced swing to the amplitude of zero growth at the given tolerance. \returns the relative error of its
/// amplitude; nothing if there is no zero near `balance`.
std::optional<double> balance_closely(ReturnMap&, SlowEnd& end, double tolerance);

}  // namespace rosin::analysis::cycles
