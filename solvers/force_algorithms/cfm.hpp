/// CFM, Coulomb friction model: friction always at its dynamic value against the slip of the step before.
///
/// It never sticks: at rest it chatters around zero velocity with ±μd N, and leaves at μd N instead of μs N.
#pragma once
#include "solvers/force_algorithms/stepped_motion.hpp"

namespace rosin::solvers::force_algorithms {

/// What algorithms have unless they say otherwise.
template <int D>
struct Algorithm {
  static constexpr bool can_stick = true, holds_velocity = false, regularised = false;
  stick_slip::Vector<D> friction(const SteppedMotion<D>&, double, const stick_slip::Vector<D>&,
                                 const stick_slip::Vector<D>&) const {
    return {};
  }
  /// The spring and damper of stick, and the place that it is tied to (relative to the surface).
  struct Adherence {
    double stiffness, damping, anchor;
  };
  Adherence adherence(const SteppedMotion<D>&, int) const { return {}; }
};

template <int D>
struct Cfm : Algorithm<D> {
  static constexpr bool can_stick = false;
  void begin_stick(SteppedMotion<D>&, std::size_t, const stick_slip::Vector<D>&) {}
  void decide(SteppedMotion<D>& motion, std::size_t n) { motion.slide_along(n, motion.slip(n)); }
};

}  // namespace rosin::solvers::force_algorithms
