/// Event-driven integration of a set-valued contact: smooth pieces of slip, exact stick, located switches.
#pragma once
#include <optional>
#include <span>

#include "solvers/steps/collocation.hpp"

namespace rosin::solvers::stick_slip {

enum class Switch { none, stick, slip, reversal };

/// "stick", "slip" or "reversal".
std::string name(Switch);

/// Advances a SwitchingSystem piece by piece. Switches are located to rounding by solving the last step again; after
/// each, the balance of forces decides between stick, reversal and going on (Leine & Nijmeijer 2004, chapter 6).
class StickSlip {
 public:
  StickSlip(SwitchingSystem&, double tolerance);
  /// No step of slip may be longer (stick is as long as it is); infinity to lift the bound.
  void bound_slip_step(double longest) { longest_slip_step_ = longest; }
  /// Of a system that does not know the time: every switch sets the clock to 0, so that it resolves short slips between
  /// long sticks.
  void rewind_at_switches() { rewinds_ = true; }
  /// Slip that comes down to so little (m/s) before it turns up again has come to rest if the contact then holds it, or
  /// `even_if_not_held`, for no time: whether it did is not told by a solution that is no better. Of free swings their
  /// energy tells, but for last digits of the slip rate.
  void rest_below(double slip_rate, bool even_if_not_held) { touch_ = slip_rate, touch_rests_ = even_if_not_held; }
  /// The same within ten tolerances of rest, by slip rate, and within one by the energy that tells it of free swings.
  void rest_in_doubt(bool even_if_not_held);
  /// Begins at (t, y). The mode follows from the slip rate: stick where it is zero and the contact can hold.
  bool start(double t, std::span<const double> y);
  /// Begins at (t, y), where stick has just given way to slip along `direction`.
  bool start_slip(double t, std::span<const double> y, double direction);
  /// One step, not past t_limit. `switched` tells whether it ended in a switch, at time(). Until the next call the
  /// system and the stepper still show the step as it was taken; then the mode `upcoming()` begins.
  Outcome step(double t_limit, Switch& switched);
  /// The lowest slip rate, along its direction, that the last step of slip came to after it had left rest.
  double lowest() const { return lowest_; }
  /// Where the energy told where the last slip came to rest: how much later than the step's end that was (s), and to
  /// which time both it and, times the drive's speed, the displacement there are known (s).
  struct Rest {
    double later, known;
  };
  const std::optional<Rest>& rest_by_energy() const { return rest_; }
  /// Direction of the mode that the next step is taken in.
  double upcoming() const { return upcoming_; }
  const steps::Collocation& stepper() const { return collocation_; }
  steps::Collocation& stepper() { return collocation_; }
  double time() const { return collocation_.time(); }
  /// The unknowns that the next step is taken from: at a switch those behind it.
  const std::vector<double>& state() const { return switched_ ? behind_switch_ : collocation_.state(); }

 private:
  /// Of a slip from rest where swings are free: by how much friction and damping have changed the square of its swing,
  /// and the size of what they did (m²).
  struct Work {
    double sum = 0, size = 0;
  };
  double indicator(double t, const double* y) const;
  bool holds(double t, std::vector<double> y) const;
  double mode_at_rest(double t, const double* y, double direction) const;
  void leave_rest(const double* y);
  bool begin(double t, std::span<const double> y);
  Work work_so_far();
  double turning_swing(double t, const double* y) const;
  bool rests(const Work&, double t, const double* y) const;
  void put_at_rest(const Work&);
  double landing_time();
  SwitchingSystem& system_;
  steps::Collocation collocation_;
  double tolerance_, longest_slip_step_ = infinity, touch_ = 0, work_in_doubt_ = 0;
  double upcoming_ = 0, lowest_ = infinity;
  bool touch_rests_ = false;
  bool switched_ = false;  ///< the last step ended in a switch: begin anew
  bool rewinds_ = false;
  Work work_done_;
  std::optional<double> swing_before_;  ///< at rest, before the present slip; none where that did not begin at rest
  std::optional<Rest> rest_;
  bool armed_ = false;  ///< slip has left the neighbourhood of rest that it started from
  std::vector<double> work_, jacobian_, mass_, behind_switch_;
};

}  // namespace rosin::solvers::stick_slip
