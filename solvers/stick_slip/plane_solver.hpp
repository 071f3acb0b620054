/// A mass that moves in the plane under friction, followed by steps: what its solvers have in common.
#pragma once
#include <vector>

#include "core/error.hpp"
#include "solvers/stick_slip/dry_mass.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace rosin::solvers::stick_slip {

using PlaneMass = DryMass<2>;
using PlaneVector = Vector<2>;

/// m ẍᵢ + cᵢ ẋᵢ + kᵢ xᵢ = fᵢ(t) + Fᵢ on a surface of constant velocity V; friction F is the solver's.
class PlaneSolver {
 public:
  virtual ~PlaneSolver() = default;

  /// Begins at t, in a state as state() tells it.
  virtual void start(double t, const std::vector<double>& state) = 0;
  /// All that the motion from time() on depends on: two displacements, then two velocities, of the mass or against the
  /// surface, then what friction remembers.
  virtual std::vector<double> state() const = 0;
  /// One step of slip, or a whole stick, not past the limit. `switched`: the switch at its end, if any, at time().
  virtual Outcome advance(double limit, Switch& switched) = 0;
  /// Parts of the last step over each of which the motion is smooth.
  virtual int parts() const = 0;

  struct Seen {
    PlaneVector displacement, velocity, friction;
    std::vector<double> memory = {};  ///< what friction remembers, as unknowns of its contact
  };
  /// The motion at a time within the last call of advance(). `near`: by the polynomial of the step, at less cost.
  virtual Seen at(double t, bool near = false) = 0;
  /// The mass was at rest on the surface in the last step.
  virtual bool sticking() const = 0;
  virtual double stick_time() const = 0;
  virtual long steps() const = 0;

  double time() const { return t1_; }
  double time_before() const { return t0_; }
  const PlaneVector& displacement() const { return x_; }  ///< at time()
  const PlaneVector& velocity() const { return v_; }
  /// The fastest rate of springs, load and forces, rad/s.
  double fastest() const { return fastest_; }
  /// Of the mass, which forces may bring it to, m/s.
  double speed_scale() const { return speed_scale_; }
  double friction_work() const { return friction_work_; }  ///< J
  double path_length() const { return path_length_; }      ///< slip distance on the surface, m
  /// Kinetic and elastic energy + friction work − work of forces and of the surface − energy at the start, over the sum
  /// of these energies.
  double energy_residual() const;

 protected:
  /// \param friction  the largest of it, N
  /// \throws InputError for parameters that are not above 0, and loads that fall to 0 or below.
  PlaneSolver(PlaneMass, double friction);
  /// f − c v − k x: the force that friction would have to balance.
  PlaneVector balance(double t, const PlaneVector& x, const PlaneVector& v) const;
  double energy(const PlaneVector& x, const PlaneVector& v) const;
  /// Begins the account of works at (x, v).
  void open_account();

  PlaneMass mass_;
  double fastest_ = 0, speed_scale_ = 0;
  double t0_ = 0, t1_ = 0;
  PlaneVector x_{}, v_{};  ///< at t1_
  double friction_work_ = 0, path_length_ = 0, supplied_ = 0, energy_at_start_ = 0;
};

}  // namespace rosin::solvers::stick_slip
