/// Stick–slip in the plane, with located events between smooth pieces of slip: the reference where no closed form
/// exists.
#pragma once
#include <functional>
#include <memory>

#include "core/contact.hpp"
#include "solvers/steps/collocation.hpp"
#include "solvers/stick_slip/plane_solver.hpp"

namespace rosin::solvers::stick_slip {

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
class PlaneStickSlip final : public PlaneSolver {
 public:
  /// `tolerance`: relative tolerance of displacements and times. \throws InputError for parameters that are not above
  /// 0, and loads that fall to 0 or below.
  explicit PlaneStickSlip(PlaneMass, double tolerance = 1e-12, SlipFriction = {});
  ~PlaneStickSlip() override;

  /// Begins at (t, x, v).
  void start(double t, PlaneVector x, PlaneVector v);
  void start(double t, const std::vector<double>& state) override {
    start(t, {state[0], state[1]}, {state[2], state[3]});
  }
  std::vector<double> state() const override { return {x_[0], x_[1], v_[0], v_[1]}; }
  Outcome advance(double limit, Switch& switched) override;
  int parts() const override;
  Seen at(double t, bool near = false) override;
  bool sticking() const override { return stick_; }
  double stick_time() const override { return stick_time_; }
  long steps() const override;

 private:
  class Slip;
  /// Friction of slip at a speed and load, and its slopes.
  struct Friction {
    double force, by_speed, by_load;
  };
  static Friction friction(const PlaneMass&, const SlipFriction&, double speed, double load);
  static double largest_friction(const PlaneMass&, const SlipFriction&);
  Friction friction(double speed, double load) const { return friction(mass_, slip_friction_, speed, load); }
  double while_friction_is_linear(double t, double a) const;
  void begin_slip(double t, double end, bool from_rest, const PlaneVector& direction);
  double release(double from, double to) const;

  SlipFriction slip_friction_;
  std::unique_ptr<Slip> slip_;
  std::unique_ptr<steps::Collocation> collocation_;
  PlaneVector stick_x_{};  ///< at t0_
  bool stick_ = true;
  bool fresh_ = true;  ///< a new mode begins at t1_
  bool next_stick_ = true;
  PlaneVector release_direction_{};
  bool from_rest_ = true;
  double stick_time_ = 0;
};

}  // namespace rosin::solvers::stick_slip
