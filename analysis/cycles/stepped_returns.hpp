/// Returns of a motion by steps: to a moment of its drive, or to the maximum of a coordinate.
#pragma once
#include <functional>
#include <vector>

#include "analysis/motion/stepped_oscillator.hpp"

namespace rosin::analysis::cycles {

/// The motion from one return to the next.
struct SteppedReturn {
  double duration = 0;                    ///< s
  std::vector<double> row;                ///< the channels at its end
  std::vector<double> low, high;          ///< of each channel: at the nodes of steps, or, if measured, at full accuracy
  std::vector<double> integral;           ///< of each channel over time; if measured
  std::vector<std::vector<double>> rows;  ///< at moments within; if measured
  std::vector<double> time;               ///< of these, s since its beginning
};

class SteppedReturns {
 public:
  /// \param finer  see SteppedOscillator::motion
  SteppedReturns(const motion::SteppedOscillator&, double tolerance, bool finer = false);

  /// Goes on from a state; a periodic drive is then in its phase at t.
  void start(double t, const std::vector<double>& state);
  /// The coordinate whose maxima are the section of a motion without a periodic drive.
  void watch(int coordinate) { watched_ = coordinate; }
  int watched() const { return watched_; }

  /// Follows the motion to the next return: Ending::event. Another ending where it does not return within 100 natural
  /// periods (none_exists), or cannot be followed.
  Outcome next(SteppedReturn&, bool measured = false);
  /// Called with the channels at each maximum and minimum of the watched coordinate.
  std::function<void(const std::vector<double>& row)> extremum;

  /// Where the last step ended, at or behind the last return, and the time since that return.
  std::vector<double> state() const { return motion_->state(); }
  double behind() const { return motion_->time() - begin_; }
  double time() const { return begin_; }  ///< s, of the last return
  long steps() const { return steps_; }

  long most_steps = 2'000'000;

 private:
  bool take(double from, double to, SteppedReturn&, bool measured);
  double crossing(double from, double to);
  double velocity(double t, bool near);

  const motion::SteppedOscillator& oscillator_;
  std::unique_ptr<motion::SteppedMotion> motion_;
  int watched_ = 0;
  double begin_ = 0, phase_ = 0;  ///< s: the last return; the first moment of the drive
  long periods_ = 0, steps_ = 0;
  std::vector<double> row_;
};

}  // namespace rosin::analysis::cycles
