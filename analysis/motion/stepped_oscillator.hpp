/// Oscillators that are followed by steps of their own: what searches for periods, exponents and basins ask of them.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/motion/plane_run.hpp"
#include "analysis/motion/stepping.hpp"
#include "analysis/motion/structure_start.hpp"
#include "core/error.hpp"

namespace rosin::analysis::motion {

/// A number that is seen of a motion at each moment.
struct Channel {
  enum class Kind : std::uint8_t {
    value,  ///< a displacement, a velocity, a force: a period has its extremes and its mean
    part,   ///< 0 … 1, such as the part that sticks: a period has its mean, by the channel's name
    rate    ///< a period has its integral, by the channel's name: distance slipped, heat of friction
  };
  std::string name, unit;  ///< of a rate the unit of the integral
  Kind kind = Kind::value;
};

/// One motion, step by step.
class SteppedMotion {
 public:
  virtual ~SteppedMotion() = default;
  /// Goes on from a state at a time.
  virtual void start(double t, const std::vector<double>& state) = 0;
  /// One step. It ends at the limit or before it, but where steps have a fixed length.
  virtual Outcome advance(double limit) = 0;
  virtual double time_before() const = 0;
  virtual double time() const = 0;
  /// All that the motion from time() on depends on.
  virtual std::vector<double> state() const = 0;
  /// Parts of the last step over each of which channels are smooth.
  virtual int parts() const = 0;
  /// The channels at a time within the last step. \param near  by the step's polynomial, at less cost
  virtual void observe(double t, bool near, double* row) = 0;
};

struct SteppedOscillator {
  std::vector<Channel> channels;  ///< coordinates, as many velocities, and others
  int coordinates = 0;
  /// The coordinate whose maxima are the section of a motion without a periodic drive; −1: the one that moves most.
  int watched = -1;
  double drive_period = 0;    ///< s; 0: the drive is constant
  double natural_period = 1;  ///< s, the longest
  bool fixed_steps = false;   ///< the length of steps, and not a tolerance, decides how well the motion is known
  std::vector<double> start;  ///< state at t = 0
  std::vector<double> size;   ///< of the entries of a state, by which states are compared; infinite: an entry is not
  /// \param finer  at half the step, or at a smaller tolerance, which shows the error
  std::function<std::unique_ptr<SteppedMotion>(double tolerance, bool finer)> motion;
  std::vector<Channel> starts;      ///< values in which starts may differ
  std::vector<double> start_sizes;  ///< natural size of each
  /// The state at t = 0 with those that are given, the others as in `start`.
  std::function<std::vector<double>(std::span<const std::optional<double>> values)> start_at;

  bool driven() const { return drive_period > 0; }
};

/// A slider in the plane, from its own start. \throws InputError where the drive has no period, or nothing drives it
SteppedOscillator stepped(const PlaneModel&);

/// Displacements of a structure that a start may add to steady sliding, each a column.
struct StartShapes {
  std::vector<Channel> names;
  Eigen::MatrixXd columns;
};
/// A structure of many coordinates, seen by its functionals, by steps of a given length. "rest" is steady sliding moved
/// back by the first shape until the first functional is 0, a spring that is relaxed, and going with the surface.
/// \throws InputError where the drive has no period, nothing drives it, or laws have states
SteppedOscillator stepped(const StructureModel&, const Stepping&, const StartShapes&);

}  // namespace rosin::analysis::motion
