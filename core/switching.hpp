/// What an event-driven solver asks of a system whose contacts stick and slip.
#pragma once
#include <cstdint>

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
class SwitchingSystem : public System {
 public:
  virtual int contacts() const = 0;
  virtual ContactMode mode(int contact) const = 0;
  virtual void set_mode(int contact, ContactMode mode) = 0;
  /// Index of the unknown that is the slip rate of the contact: at rest it is exactly 0.
  virtual int slip_rate_unknown(int contact) const = 0;
  /// Displacement along the contact's direction (m).
  virtual double displacement(int contact, const double* y) const = 0;
  /// A speed that the contact's slip rates are measured against, > 0.
  virtual double reference_speed(int contact) const = 0;

  /// True if the force that holds a contact does not depend on the modes of others: then each decides alone.
  virtual bool contacts_decide_alone() const { return false; }

  /// The force that keeps a contact from slipping, positive where it would slip forward without it; the largest that
  /// the contact bears; and what rounding leaves open of the two (newton).
  struct Held {
    double force, limit, digits;
  };
  /// Of every contact that sticks, in the present modes: contacts() entries, of which those of slip are left alone.
  virtual void held(double t, const double* y, Held* held) const = 0;
  /// Acceleration of the slip of every contact that slips, in the present modes (m/s²): contacts() entries, of which
  /// those of stick are left alone.
  virtual void slip_accelerations(double t, const double* y, double* acceleration) const = 0;

  /// Ends a slip: the slip rate is exactly zero, and contacts that count from their last stop begin anew.
  virtual void stop(int contact, double* y) const = 0;
  /// At rest, where stick gives way to slip in the present mode: loads the contact by the last digits that are missing
  /// for the balance of forces to start it, which rounding may have left the other way.
  virtual void release(int contact, double t, double* y) const = 0;
};

}  // namespace rosin
