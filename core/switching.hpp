/// What an event-driven solver asks of a system whose contacts stick and slip.
#pragma once
#include <cstdint>
#include <vector>

#include "core/system.hpp"

namespace rosin {

/// What a set-valued contact does: slip along the drive is forward.
enum class ContactMode : std::int8_t { backward = -1, stick = 0, forward = 1 };

/// −1, 0 or +1.
inline double sign(ContactMode mode) { return static_cast<double>(mode); }
/// The mode of slip along a force or a slip rate.
inline ContactMode slip_along(double direction) { return direction < 0 ? ContactMode::backward : ContactMode::forward; }

/// A system with set-valued contacts, each of which sticks or slips in one of two directions. A solver with event
/// location sets the modes. Contacts under smooth laws are ordinary rows of the equations and are not counted here.
///
/// A contact behind a spring (is_elastic) has a point of its own, without mass, which sticks and slips while the
/// coordinates move on: stick begins and ends without a jump of their speeds, and each such contact decides alone.
class SwitchingSystem : public System {
 public:
  virtual int contacts() const = 0;
  virtual ContactMode mode(int contact) const = 0;
  virtual void set_mode(int contact, ContactMode mode) = 0;
  /// The contact stands behind a spring.
  virtual bool is_elastic([[maybe_unused]] int contact) const { return false; }
  /// Index of the unknown that is the slip rate of a contact that is not elastic: at rest it is exactly 0.
  virtual int slip_rate_unknown(int contact) const = 0;
  /// Slip rate (m/s) in the present modes, of the contact's own point where it is elastic.
  virtual double own_slip_rate(int contact, [[maybe_unused]] double t, const double* y) const {
    return y[slip_rate_unknown(contact)];
  }
  /// Displacement along the contact's direction (m).
  virtual double displacement(int contact, const double* y) const = 0;
  /// A speed that the contact's slip rates are measured against, > 0.
  virtual double reference_speed(int contact) const = 0;

  /// True if the force that holds a contact does not depend on the modes of others: then each decides alone.
  virtual bool contacts_decide_alone() const { return false; }

  /// The force that keeps a contact from slipping, positive where it would slip forward without it (of an elastic one
  /// the force of its spring); the largest that the contact bears; and what rounding leaves open of the two (newton).
  struct Held {
    double force, limit, digits;
  };
  /// Of every contact that sticks, in the present modes: contacts() entries, of which those of slip are left alone.
  virtual void held(double t, const double* y, Held* held) const = 0;
  /// Acceleration of the slip of every contact that slips, in the present modes (m/s²): contacts() entries, of which
  /// those of stick, and of elastic contacts, are left alone.
  virtual void slip_accelerations(double t, const double* y, double* acceleration) const = 0;

  /// Ends a slip: the slip rate is exactly zero, and contacts that count from their last stop begin anew.
  virtual void stop(int contact, double* y) const = 0;
  /// At rest, where stick gives way to slip in the present mode: loads the contact by the last digits that are missing
  /// for the balance of forces to start it, which rounding may have left the other way.
  virtual void release(int contact, double t, double* y) const = 0;
};

/// Unknowns that have a rate of their own, be it only while contacts stick: the deflection of an elastic one follows
/// from its load in slip.
inline std::vector<int> moving_unknowns(SwitchingSystem& system) {
  std::vector<ContactMode> modes;
  for (int c = 0; c < system.contacts(); ++c) modes.push_back(system.mode(c)), system.set_mode(c, ContactMode::stick);
  std::vector<double> mass(system.size());
  system.mass(0, mass.data());
  for (int c = 0; c < system.contacts(); ++c) system.set_mode(c, modes[c]);
  std::vector<int> moving;
  for (int i = 0; i < system.size(); ++i)
    if (mass[i] != 0) moving.push_back(i);
  return moving;
}

}  // namespace rosin
