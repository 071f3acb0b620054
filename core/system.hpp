/// What a solver advances in time: M(t)·ẏ = f(t, y) with a diagonal M whose zero rows are algebraic.
#pragma once
#include <cmath>
#include <string>

#include "core/pack.hpp"
#include "core/parameters.hpp"

namespace rosin {

/// A system of ordinary differential and algebraic equations of index 1. Immutable during a solution.
class System {
 public:
  virtual ~System() = default;
  virtual int size() const = 0;
  /// Diagonal of M at time t (size entries).
  virtual void mass(double t, double* m) const = 0;
  /// f(t, y).
  virtual void evaluate(double t, const double* y, double* f) const = 0;
  /// f and ∂f/∂y, row-major size × size.
  virtual void linearise(double t, const double* y, double* f, double* jacobian) const = 0;
  /// The sizes by which errors in each unknown are measured, at y.
  virtual void scale(const double* y, double* s) const = 0;
  /// Name of an unknown for messages.
  virtual std::string unknown(int i) const = 0;
  /// The next time after t at which the equations jump; infinity if none.
  virtual double next_break(double) const { return infinity; }
  /// Carries y across the break at t: continues what is continuous and makes algebraic unknowns consistent.
  virtual void cross_break(double, double*) const {}
  /// True if the equations do not change with time: then steps may be shorter than the clock can show.
  virtual bool autonomous() const { return false; }
  /// Longest step that resolves prescribed motion; infinity if none is prescribed.
  virtual double resolution() const { return infinity; }
  /// A smooth function of y that changes sign, in numbers of the size of 1, where f has a kink, at which a step must
  /// end to keep its order; NaN if f has none.
  virtual double kink(const double*) const { return NAN; }
  /// True if the system can be followed as ordinary differential equations, by `flow` and `restore`.
  virtual bool has_flow() const { return false; }
  /// At eight times t and consistent states y, one in each lane: dy/dt of every unknown, algebraic ones by
  /// differentiating their rows in time; and the pace at which the system changes (1/s, > 0, smooth in y), a natural
  /// unit for steps.
  virtual void flow(const Pack& /*t*/, const Pack* /*y*/, Pack* /*rate*/, Pack& /*pace*/) const {}
  /// Removes what steps along the flow have left of a defect in the algebraic rows.
  virtual void restore(double, double*) const {}
};

/// Σ|J_ij y_j| of one row of a Jacobian: the size of the terms that cancel where a row of f is in balance, and of which
/// rounding leaves some last digits.
inline double size_of_terms(const double* row, const double* y, int n) {
  double sum = 0;
  for (int j = 0; j < n; ++j) sum += std::abs(row[j] * y[j]);
  return sum;
}
/// What may be wrong with a row of f by that.
inline double last_digits_of_terms(const double* row, const double* y, int n) {
  constexpr double rounding = 2.3e-16;
  return 4 * rounding * size_of_terms(row, y, n);
}

/// A system with one set-valued contact: it sticks, or slips in one of two directions, and a solver with event
/// location sets which.
class SwitchingSystem : public System {
 public:
  /// 0: stick; +1 or −1: slip in that direction.
  virtual void set_direction(double direction) = 0;
  virtual double direction() const = 0;
  virtual double slip_rate(double t, const double* y) const = 0;
  /// The force that keeps the contact from slipping, and the largest that it can bear (newton).
  virtual double holding_force(double t, const double* y) const = 0;
  virtual double holding_limit(double t, const double* y) const = 0;
  /// What rounding leaves open of the two (newton).
  virtual double holding_digits(double t, const double* y) const = 0;
  /// Sets the slip rate to exactly zero.
  virtual void hold(double* y) const = 0;
  /// At rest, where stick gives way to slip in the present direction: loads the contact by the last digits that are
  /// missing for the balance of forces to start it, which rounding may have left the other way.
  virtual void release(double t, double* y) const = 0;
  /// Ends a slip: the slip rate is exactly zero, and contacts that count from their last stop begin anew.
  virtual void stop(double* y) const = 0;
  /// A speed that slip rates are measured against, > 0.
  virtual double reference_speed() const = 0;
  /// True where a slip swings nearly free between rest and rest. It then comes down to rest along the slope of a wide
  /// swing, and where it does is known from its slip rate only to the root of that one's error; the energy, which
  /// friction and damping hardly change, tells it as exactly as they are known.
  virtual bool swings_freely() const { return false; }
  /// Where swings are free. The slider's velocity while the contact is at rest (m/s), and how wide it makes it swing
  /// (m); its displacement from that of steady sliding (m), and the place for another.
  virtual double velocity_at_rest() const { return 0; }
  virtual double swing_of_drive() const { return 0; }
  virtual double swing(const double* /*y*/) const { return 0; }
  virtual void set_swing(double /*swing*/, double* /*y*/) const {}
  /// Rate at which friction and damping change the square of the swing that the slider has at rest, m²/s.
  virtual double swing_power(double /*t*/, const double* /*y*/) const { return 0; }
};

}  // namespace rosin
