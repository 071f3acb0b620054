/// The one rule of what contacts at rest do next: which hold, which give way, and in which direction.
#pragma once
#include <cmath>
#include <span>

#include "core/error.hpp"
#include "core/switching.hpp"

namespace rosin::solvers::stick_slip {

/// Of one contact that is asked alone: it sticks if its limit bears the force on it, else it slips along the force.
template <class Real>
ContactMode mode_at_rest(Real force, Real limit) {
  return std::abs(force) <= limit ? ContactMode::stick : slip_along(double(force));
}

/// What became of a contact in the instant that is decided.
enum class Ended : std::int8_t {
  nothing,  ///< its mode goes on; a contact that sticks is asked again, since the force on it may jump
  stick,    ///< the force on it has reached its limit
  slip,     ///< its slip rate has come to 0
};

/// Of an elastic contact that a motion starts with: where its spring bears the limit, or more, it slips if that takes
/// its point along the force. The system keeps its mode.
ContactMode mode_behind_spring(SwitchingSystem&, int contact, double t, const double* y);

/// How a decision went.
struct Balance {
  Outcome outcome;
  int pivots = 0;           ///< contacts that were let go or held again, one after another
  bool had_choice = false;  ///< were the least overloaded contact to give way first, other modes would follow
};

/// Coulomb's law leaves the modes of contacts at rest open where they share masses and static friction exceeds kinetic:
/// several sets are consistent. The rule chooses one: all hold; of those overloaded the one that bears the largest part
/// of its limit gives way, along its force, and the forces are asked again; a contact that then accelerates against its
/// direction of slip is held again. Where static friction equals kinetic the consistent set is unique (the forces are
/// those of a strictly convex problem), and where contacts share no mass each decides alone.
///
/// Stick that has ended gives way without question. Slip that has ended is held if the contact can, or but for
/// rounding where it would reverse (Leine & Nijmeijer 2004, chapter 6). An elastic contact goes from each mode that has
/// ended to the other.
///
/// \param y      unknowns at time t, with slip rates of exactly 0 where contacts are at rest
/// \param ended  contacts() entries; the modes of the system are those before
/// \param next   contacts() entries: the modes that follow. The system keeps those before.
/// \returns      Ending::budget_spent if contacts are let go and held again in a circle and no set is consistent
Balance balance_contacts(SwitchingSystem&, double t, const double* y, std::span<const Ended> ended,
                         std::span<ContactMode> next);

}  // namespace rosin::solvers::stick_slip
