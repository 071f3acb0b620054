/// Stick–slip in closed form: a mass on a spring and a damper under dry friction, followed from event to event.
#pragma once
#include <limits>

#include "core/error.hpp"
#include "solvers/stick_slip/closed_form.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace rosin::solvers::stick_slip {

/// m ẍ + c ẋ + k x = f(t) + F with friction F on a surface of speed V(t): in motion F = μd N(t) sgn(V − ẋ) +
/// viscous·(V − ẋ), at rest on the surface |F| ≤ μs N(t).
struct DryOscillator {
  double mass = 1, stiffness = 1, damping = 0;  ///< kg, N/m, N s/m; mass and stiffness above 0
  double static_friction = 0.4, dynamic_friction = 0.3;
  double viscous = 0;  ///< N s/m of the slip rate
  Signal speed = 0.0, load = 1.0, force = 0.0;
  /// \throws InputError for a mass or stiffness that is not above 0, μs < μd, a load that is negative at times, and a
  /// viscous part under a varying load.
  void check() const;
};

/// Follows a DryOscillator exactly: between events the motion is a sum of exponentials; events are the certain first
/// zeros of the slip rate or of what is left of the holding force; the balance of forces decides what follows. What
/// would be an endless sequence of events closer than arithmetic tells apart is held at rest for a moment and counted
/// as chatter. Real: double, or long double to learn what rounding has done.
template <class Real = double>
class Exact {
 public:
  /// \throws InputError by DryOscillator::check().
  explicit Exact(DryOscillator);

  /// Begins at (t, x, v).
  void start(Real t, Real x, Real v);
  /// Goes on to the next event, at time(), but not past the limit. Until the next call the observers below hold for
  /// the times passed over; then the mode `direction()` begins.
  Switch advance(Real limit);

  Real time() const { return t1_; }
  Real time_before() const { return t0_; }
  /// Direction of slip V − ẋ of the mode that was passed over: 0 stick, else ±1; and of the one that follows.
  int direction() const { return mode_; }
  int upcoming() const { return next_; }

  /// The fastest rate (1/s) of what was passed over; 0 if all is constant.
  Real fastest() const;

  struct Seen {
    Real displacement, velocity, slip_rate, friction_force, load;
  };
  /// At a time passed over by the last call.
  Seen at(Real t) const;

  /// Works done since the start (joule): of the drive's force, of the moving surface by friction, in the damper, and
  /// what friction has turned into heat, ∫ |F (V − ẋ)| dt. Only with `audit`.
  struct Works {
    Real force = 0, surface = 0, damper = 0, friction = 0;
    Real wear = 0;        ///< ∫ N |V − ẋ| dt
    Real residual = 0;    ///< of energy + damper − force − surface, which should vanish
    Real throughput = 0;  ///< sum of all that was turned over, by which to judge it
  };
  /// Asks for the works, by quadrature of the closed form (15 points for every three radians of its fastest part). It
  /// is given up where so many parts are not enough.
  void audit(double most_parts = std::numeric_limits<double>::infinity()) { parts_left_ = most_parts; }
  bool audits() const { return parts_left_ > 0; }
  const Works& works() const { return works_; }

  Real stick_time() const { return stick_time_; }
  long chatter_events() const { return chatter_events_; }
  Real chatter_time() const { return chatter_time_; }
  /// The smallest | |R|/(μs N) − 1 | with which an end of slip was decided.
  Real decision_margin() const { return decision_margin_; }
  long pieces() const { return pieces_; }

 private:
  void build();
  int mode_at_rest(Real x, Real t, Real& margin) const;
  Real balance(Real x, Real t) const;
  void account(Real from, Real to);
  Real fastest(Real tau) const;

  DryOscillator model_;
  double parts_left_ = 0;  ///< of the quadrature of works; 0: they are not asked for
  Real origin_ = 0;        ///< time from which the present closed form counts
  Real t0_ = 0, t1_ = 0;   ///< passed over by the last call
  Real x_ = 0, v_ = 0;     ///< at t1_
  int mode_ = 0, next_ = 0;
  bool fresh_ = true;     ///< a new mode or piece of the drive begins at t1_
  bool leaving_ = false;  ///< it begins at a zero of what will end it
  ClosedForm<Real> motion_, velocity_, slip_, speed_, load_, force_, hold_[2];
  Works works_;
  Real energy_at_start_ = 0;
  Real stick_time_ = 0, chatter_time_ = 0, decision_margin_ = std::numeric_limits<Real>::infinity();
  Real last_progress_ = 0;
  int without_progress_ = 0;
  long chatter_events_ = 0, pieces_ = 0;
};

extern template class Exact<double>;
extern template class Exact<long double>;

}  // namespace rosin::solvers::stick_slip
