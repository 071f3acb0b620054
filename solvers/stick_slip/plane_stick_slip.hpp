/// Stick–slip in the plane, by events on smooth pieces of slip: the reference where no closed form exists.
#pragma once
#include <memory>

#include "solvers/steps/collocation.hpp"
#include "solvers/stick_slip/dry_mass.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace rosin::solvers::stick_slip {

using PlaneMass = DryMass<2>;
using PlaneVector = Vector<2>;

/// Follows m ẍᵢ + cᵢ ẋᵢ + kᵢ xᵢ = fᵢ(t) − μd N(t) wᵢ/|w|, w the velocity on a surface of constant velocity.
///
/// Slip is integrated by collocation in the logarithm of speed and the angle of w over a clock with dt = |w| ds: there
/// the equations are smooth up to rest, which is reached in finite time but infinite s, along the direction of the
/// force. Slip ends where the speed is negligible, with the rest of the way in closed form; it begins along R, the
/// force that friction cannot hold, by a series. Release is the certain first zero of (μs N)² − |R|².
class PlaneStickSlip {
 public:
  /// `tolerance`: relative, of displacements and times. \throws InputError for what is not above 0, and loads that
  /// fall to 0 or below.
  explicit PlaneStickSlip(PlaneMass, double tolerance = 1e-12);
  ~PlaneStickSlip();

  /// Begins at (t, x, v).
  void start(double t, PlaneVector x, PlaneVector v);
  /// One step of slip, or a whole stick, not past the limit. `switched` tells whether it ended in a switch, at time().
  Outcome advance(double limit, Switch& switched);

  double time() const { return t1_; }
  double time_before() const { return t0_; }
  bool sticking() const { return stick_; }

  struct Seen {
    PlaneVector displacement, velocity, friction;
  };
  /// At a time passed over by the last call.
  Seen at(double t);

  double stick_time() const { return stick_time_; }
  double friction_work() const { return friction_work_; }  ///< J
  double path_length() const { return path_length_; }      ///< m, on the surface
  /// Kinetic and elastic energy + friction − work of forces and of the surface − start; relative to what was turned
  /// over.
  double energy_residual() const;
  long steps() const;

 private:
  class Slip;
  PlaneVector balance(double t, const PlaneVector& x, const PlaneVector& v) const;
  double energy(const PlaneVector& x, const PlaneVector& v) const;
  void begin_slip(double t, double end, bool from_rest, const PlaneVector& direction);
  double release(double from, double to) const;

  PlaneMass mass_;
  double tolerance_, fastest_, speed_scale_;
  std::unique_ptr<Slip> slip_;
  std::unique_ptr<steps::Collocation> collocation_;
  double t0_ = 0, t1_ = 0;
  PlaneVector x_{}, v_{};  ///< at t1_
  PlaneVector stick_x_{};  ///< at t0_
  bool stick_ = true;
  bool fresh_ = true;  ///< a new mode begins at t1_
  bool next_stick_ = true;
  PlaneVector release_direction_{};
  bool from_rest_ = true;
  double stick_time_ = 0, friction_work_ = 0, path_length_ = 0, supplied_ = 0, energy_at_start_ = 0;
};

}  // namespace rosin::solvers::stick_slip
