/// The last whole oscillation of a motion by steps, in frames, for whoever draws it.
#pragma once
#include <Eigen/Core>
#include <vector>

namespace rosin::analysis::motion {

enum class Touch { slips, sticks, open };

/// Moments of an oscillation, the last of them the first of the next one.
struct Frames {
  std::vector<double> time;                  ///< s
  std::vector<Eigen::VectorXd> coordinates;  ///< m
  std::vector<std::vector<Touch>> touch;     ///< of each station
  std::vector<double> friction, load;        ///< N, of all contacts

  std::size_t size() const { return time.size(); }
  bool empty() const { return time.empty(); }
  double duration() const { return empty() ? 0 : time.back() - time.front(); }
  /// As many evenly spaced moments, interpolated; touch is that of the nearest.
  Frames evenly(int count) const;
};

/// Keeps the frames between two upward passages of one displacement through a level, and forgets those before. Long
/// oscillations are thinned out, so that few frames are kept whatever the step.
class LastOscillation {
 public:
  /// \param place  the displacement over its level
  void add(double place, double time, const Eigen::VectorXd& coordinates, const std::vector<Touch>&, double friction,
           double load);
  /// Empty where there were no two passages.
  const Frames& whole() const { return whole_; }

 private:
  void keep(double time, const Eigen::VectorXd& coordinates, const std::vector<Touch>&, double friction, double load);

  Frames whole_, present_;
  bool begun_ = false, started_ = false;
  double before_ = 0;
  long steps_ = 0, stride_ = 1;  ///< since the passage; between frames
};

}  // namespace rosin::analysis::motion
