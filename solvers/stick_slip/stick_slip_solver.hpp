/// Event-driven integration of set-valued contacts: smooth pieces of slip, exact stick, located switches.
#pragma once
#include <array>
#include <optional>
#include <span>

#include "solvers/steps/collocation.hpp"
#include "solvers/stick_slip/contact_balance.hpp"
#include "solvers/stick_slip/free_swings.hpp"

namespace rosin::solvers::stick_slip {

enum class Switch { none, stick, slip, reversal };

/// "stick", "slip" or "reversal".
std::string name(Switch);

/// Advances a SwitchingSystem piece by piece. The first switch of any contact within a step is located to rounding by
/// solving the step again; after it the balance of forces decides between stick, reversal and going on, for all
/// contacts at rest together (balance_contacts).
class StickSlip {
 public:
  /// \param swings  of a system of one contact that swings nearly free: its energy tells where slip ends; outlives this
  StickSlip(SwitchingSystem&, double tolerance, const FreeSwings* swings = nullptr);
  /// No step of slip may be longer (stick is as long as it is); infinity to lift the bound.
  void bound_slip_step(double longest) { longest_slip_step_ = longest; }
  /// No next step may be longer.
  void bound_step(double longest) { longest_step_ = longest; }
  /// Of a system that does not know the time: every switch sets the clock to 0, so that it resolves short slips between
  /// long sticks.
  void rewind_at_switches() { rewinds_ = true; }
  /// A slip rate whose minimum lies between 0 and `slip_rate` (m/s) has touched rest if the contact then holds, or,
  /// with `even_if_not_held`, in any case: the error of the solution hides which. Of free swings their energy tells, to
  /// the rounding of the slip rate.
  void rest_below(double slip_rate, bool even_if_not_held) { touch_ = slip_rate, touch_rests_ = even_if_not_held; }
  /// The same within ten tolerances of rest by slip rate, and within one by the energy of free swings.
  void rest_in_doubt(bool even_if_not_held);
  /// Begins at (t, y). The modes follow from the slip rates: a contact at rest sticks if it can hold.
  bool start(double t, std::span<const double> y);
  /// Begins at (t, y), where stick of the one contact has just given way to slip along `mode`.
  bool start_slip(double t, std::span<const double> y, ContactMode mode);
  /// One step, not past t_limit. `switched` tells whether it ended in a switch, at time(). Until the next call the
  /// system and the stepper still show the step as it was taken; then the modes `upcoming()` begin.
  Outcome step(double t_limit, Switch& switched);
  /// What the last step ended in: one entry for each contact that switched, in their order.
  struct Event {
    int contact;
    Switch what;
  };
  std::span<const Event> events() const { return events_; }
  /// The lowest slip rate, along its direction, that the last step of slip came to after it had left rest.
  double lowest(int contact = 0) const { return contacts_[contact].lowest; }
  /// Where the energy told where the last slip came to rest.
  const std::optional<SlipEnergy::Rest>& rest_by_energy() const { return rest_; }
  /// ContactMode that the next step is taken in.
  ContactMode upcoming(int contact = 0) const { return upcoming_[contact]; }
  /// Switches at which the rule of balance_contacts chose one of several modes that may all be consistent.
  long choices() const { return choices_; }
  const steps::Collocation& stepper() const { return collocation_; }
  steps::Collocation& stepper() { return collocation_; }
  double time() const { return collocation_.time(); }
  /// The unknowns that the next step is taken from: at a switch those behind it.
  const std::vector<double>& state() const { return switched_ ? behind_switch_ : collocation_.state(); }

 private:
  static constexpr int nodes = steps::Collocation::stages + 1;  ///< of a step, with its start
  struct ContactState {
    bool armed = false;        ///< slip has left the neighbourhood of rest that it started from, or stick of an elastic
                               ///< contact that of its limit
    bool had_left = false;     ///< it had before the last step; or stick had begun before it
    double lowest = infinity;  ///< in the last step
    std::array<double, nodes> indicator;
    Ended ended = Ended::nothing;
  };
  /// The end of a mode within the last step: between two parts of it, or where slip touches rest.
  struct End {
    int contact;
    double low = 0, low_value = 0, high = -1, high_value = 0;
    bool touched = false;
    std::optional<double> at;  ///< part of the step after which the mode ends
    bool found() const { return high >= 0 || touched; }
  };
  bool slips() const;               ///< some contact does
  bool sticks() const;              ///< some contact does
  bool may_end(int contact) const;  ///< the mode is not one that has only just begun
  double indicator_of_held(int contact, double t, const double* y) const;
  double indicator(int contact, double t, const double* y);
  bool holds(int contact, double t, std::vector<double> y);
  double landing_time();
  bool begin(double t, std::span<const double> y);
  bool begin_upcoming(double t_limit);
  void read_indicators();
  End look_at_nodes(int contact);
  Outcome look_between_nodes(End&);
  bool locate(End&, double& first);
  bool locate_first_of_many(double& first);
  double noise(int contact) const;
  Ended ended_mode(int contact) const {
    return system_.mode(contact) == ContactMode::stick ? Ended::stick : Ended::slip;
  }
  Outcome switch_at(double theta, Switch& switched);

  SwitchingSystem& system_;
  steps::Collocation collocation_;
  SlipEnergy energy_;
  double tolerance_, longest_slip_step_ = infinity, longest_step_ = infinity, touch_ = 0;
  bool touch_rests_ = false;
  bool switched_ = false;  ///< the last step ended in a switch: begin anew
  bool rewinds_ = false;
  std::vector<ContactState> contacts_;
  std::vector<ContactMode> upcoming_;
  std::vector<Event> events_;
  std::vector<End> found_, ends_;  ///< of modes within the last step: seen, and located
  std::vector<Ended> ended_;
  std::vector<SwitchingSystem::Held> held_;
  std::optional<SlipEnergy::Rest> rest_;
  long choices_ = 0;
  std::vector<double> work_, jacobian_, mass_, behind_switch_;
};

}  // namespace rosin::solvers::stick_slip
