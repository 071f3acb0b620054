/// Swings of a slider on its spring that friction changes by little in a turn: by so little that where a turn ends does
/// not show it, as in a slip at 10¹⁰ times the drive speed, where friction that weakens is all but gone. The work of
/// friction over the turn does, to as many digits as the motion is known.
#pragma once
#include <optional>
#include <vector>

#include "analysis/cycles/return_map.hpp"

namespace rosin::analysis::cycles {

/// The work of all forces but the spring's on motion relative to the drive, over the steps of a turn from v = V to v =
/// V.
class SwingWork final : public PassageObserver {
 public:
  /// `reference`: a constant force about which the slider swings, N. Near the mean of friction least cancels.
  SwingWork(const oscillators::SliderSystem&, double reference);
  void step(solvers::steps::Collocation&) override;
  /// ln of the growth of the stretch (m) from where the spring holds the reference, and the same if all work were done
  /// in one direction.
  double growth(double stretch) const;
  double turnover(double stretch) const;
  double mean_friction() const { return impulse_ / time_; }

 private:
  const oscillators::SliderSystem& system_;
  double reference_;
  std::vector<double> y_;
  double gained_ = 0, moved_ = 0, impulse_ = 0, time_ = 0;
};

/// One turn from the section v = V, with a state of the contact that repeats itself at this stretch.
struct SlowSwing {
  std::vector<double> y;  ///< on the section
  double middle = 0;      ///< displacement about which it swings, where the spring holds the mean friction, m
  double stretch = 0;     ///< from there to y, m
  double growth = 0;      ///< ln of the growth of the stretch in a turn
  double turnover = 0;    ///< the same if friction did all its work in one direction
  double scatter = 0;     ///< of the growth, from turn to turn
  double amplitude = 0;   ///< largest |v − V|/V
  Eigen::MatrixXd state_derivative;  ///< of the contact's unknowns over a turn; empty: it forgets them
};

/// The swing from a displacement (m) on the section, from one `near` it. Nothing where the motion does not come round
/// in one turn, or its contact does not settle.
std::optional<SlowSwing> swing_at(ReturnMap&, const SlowSwing& near, double displacement, double tolerance);

/// The swing that motion on the section at y makes. Nothing where the slider is no oscillator on a rigid contact, or
/// friction moves more than a small part of its energy in a turn.
std::optional<SlowSwing> slow_swing_from(ReturnMap&, const std::vector<double>& y, double tolerance);

/// Where the growth of slow swings leads.
struct SlowEnd {
  std::optional<SlowSwing> balance;   ///< neither grows nor decays, and attracts; known to 1e-7 of its stretch
  double slope = 0, slope_error = 0;  ///< d growth / d ln stretch there, below 0
  std::optional<SlowSwing> last;      ///< else the last one that came round in one turn
  double turns = 0;                   ///< that lead there, about
};
SlowEnd follow_slow_swing(ReturnMap&, const SlowSwing& start, double tolerance);

/// Swings that decay until the slider sticks, and slips again: how much the stretch of the next swing, ln, is moved by
/// where in its turn the last one came to stick, and the growth of the next. Nothing if no such swing follows.
struct Return {
  double spread, growth;
};
std::optional<Return> return_after(ReturnMap&, const SlowSwing& last, const SlowSwing& first, double tolerance);

/// Moves a balanced swing to where its growth vanishes as exactly as steps of a tolerance tell. \returns how far off it
/// may still be, as a part of its stretch; nothing if it is not found beside `balance`.
std::optional<double> balance_closely(ReturnMap&, SlowEnd& end, double tolerance);

}  // namespace rosin::analysis::cycles
