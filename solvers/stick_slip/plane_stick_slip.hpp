/// Stick–slip in the plane, with located events between smooth pieces of slip: the reference where no closed form
/// exists.
#pragma once
#include <functional>
#include <memory>

#include "core/contact.hpp"
#include "solvers/steps/collocation.hpp"
#include "solvers/stick_slip/dry_mass.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace rosin::solvers::stick_slip {

using PlaneMass = DryMass<2>;
using PlaneVector = Vector<2>;

/// Friction of slip where it depends on the slip rate: a contact without unknowns, and a function of the slip rate
/// that changes sign, in numbers of the size of 1, at kinks of friction, or NaN. The mass's dynamic friction is then
/// that of the slowest slip; both of its coefficients are 0 where friction rises from 0, so that nothing holds at
/// rest.
struct SlipFriction {
  std::shared_ptr<const Contact<double>> contact = nullptr;  ///< null: Coulomb friction
  std::function<double(double)> kink = nullptr;
};

/// Solves m ẍᵢ + cᵢ ẋᵢ + kᵢ xᵢ = fᵢ(t) − F wᵢ/|w|, with w the velocity on a surface of constant velocity, and F = μd
/// N(t) or a function of |w| and N. Slip is integrated by collocation in the logarithm of speed and the angle of w over
/// s, with dt = |w| ds. In these variables the equations are smooth up to rest, which slip reaches in finite time but
/// infinite s, along the direction of the force. Slip ends where the speed is negligible, and the remaining distance
/// follows in closed form. Slip begins along R, the force that friction cannot hold, by a series. Release is the
/// certain first zero of (μs N)² − |R|².
class PlaneStickSlip {
 public:
  /// `tolerance`: relative tolerance of displacements and times. \throws InputError for parameters that are not above
  /// 0, and loads that fall to 0 or below.
  explicit PlaneStickSlip(PlaneMass, double tolerance = 1e-12, SlipFriction = {});
  ~PlaneStickSlip();

  /// Begins at (t, x, v).
  void start(double t, PlaneVector x, PlaneVector v);
  /// One step of slip, or a whole stick, not past the limit. `switched`: the switch at its end, if any, at time().
  Outcome advance(double limit, Switch& switched);

  double time() const { return t1_; }
  double time_before() const { return t0_; }
  bool sticking() const { return stick_; }
  const PlaneVector& displacement() const { return x_; }  ///< at time()
  const PlaneVector& velocity() const { return v_; }

  struct Seen {
    PlaneVector displacement, velocity, friction;
  };
  /// The motion at a time within the last call of advance(). `near`: by the polynomial of the step, at less cost.
  Seen at(double t, bool near = false);
  /// The fastest rate of springs, load and forces, rad/s.
  double fastest() const { return fastest_; }

  double stick_time() const { return stick_time_; }
  double friction_work() const { return friction_work_; }  ///< J
  double path_length() const { return path_length_; }      ///< slip distance on the surface, m
  /// Kinetic and elastic energy + friction work − work of forces and of the surface − energy at the start, over the sum
  /// of these energies.
  double energy_residual() const;
  long steps() const;

 private:
  class Slip;
  /// Friction of slip at a speed and load, and its slopes.
  struct Friction {
    double force, by_speed, by_load;
  };
  Friction friction(double speed, double load) const;
  PlaneVector balance(double t, const PlaneVector& x, const PlaneVector& v) const;
  double energy(const PlaneVector& x, const PlaneVector& v) const;
  double while_friction_is_linear(double t, double a) const;
  void begin_slip(double t, double end, bool from_rest, const PlaneVector& direction);
  double release(double from, double to) const;

  PlaneMass mass_;
  SlipFriction slip_friction_;
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
