/// Force-balance models: stick keeps the velocity it was found with, friction balances all other forces.
///
/// Source: D. Karnopp, J. Dyn. Syst. Meas. Control 107 (1985) 100, with the force balance of X. Tan & R. J. Rogers,
/// Flow-Induced Vibration, ASME PVP 328 (1996) 347. The velocity that stick keeps is not zero, so that it drifts.
#pragma once
#include "solvers/force_algorithms/cfm.hpp"

namespace rosin::solvers::force_algorithms {

/// The component of slip that changed sign in the last step, if one did; zero counts.
template <int D>
std::optional<int> turned(const SteppedMotion<D>& motion, std::size_t n) {
  const auto before = motion.slip(n - 1), now = motion.slip(n);
  for (int d = 0; d < D; ++d)
    if (before[d] * now[d] <= 0) return d;
  return std::nullopt;
}

/// O-FBFM: rest is a speed within a window. A window smaller than a step's change of speed is jumped over; one too
/// large finds sticks that are none.
template <int D>
struct OriginalForceBalance : Algorithm<D> {
  static constexpr bool holds_velocity = true;
  void begin_stick(SteppedMotion<D>& motion, std::size_t n, const stick_slip::Vector<D>&) { motion.stick(n); }
  void decide(SteppedMotion<D>& motion, std::size_t n) {
    if (length<D>(motion.slip(n)) > motion.options().window) return motion.slide_along(n, motion.slip(n));
    if (length<D>(motion.balance(n)) <= motion.static_limit(n))
      return motion.state() == State::stick ? motion.keep(n) : motion.stick(n);
    if (motion.state() == State::stick) return motion.release(n);
    if (motion.state() == State::micro_slip) return motion.end_micro_slip(n);
    motion.slide_along(n, motion.slip(n));
  }
};

/// R-FBFM: rest is a change of sign; stick keeps the smaller of the two speeds around it.
template <int D>
struct RevisedForceBalance : Algorithm<D> {
  static constexpr bool holds_velocity = true;
  void begin_stick(SteppedMotion<D>& motion, std::size_t n, const stick_slip::Vector<D>&) { motion.stick(n); }
  void decide(SteppedMotion<D>& motion, std::size_t n) {
    const bool holds = length<D>(motion.balance(n)) <= motion.static_limit(n);
    if (motion.state() == State::stick) return holds ? motion.keep(n) : motion.release(n);
    if (motion.state() == State::micro_slip) return motion.end_micro_slip(n);
    if (!turned(motion, n) || !holds || !slow(motion, n)) return motion.slide_along(n, motion.slip(n));
    if (length<D>(motion.slip(n - 1)) < length<D>(motion.slip(n))) motion.take_back(n);
    motion.stick(n);
  }

 private:
  /// In the plane a component changes sign mostly at high speed; rest is only where three steps could stop the mass.
  static bool slow(const SteppedMotion<D>& motion, std::size_t n) {
    if constexpr (D == 1) return true;
    auto change = motion.slip(n);
    const auto before = motion.slip(n - 1);
    for (int d = 0; d < D; ++d) change[d] -= before[d];
    return length<D>(motion.slip(n)) <= 3 * length<D>(change);
  }
};

}  // namespace rosin::solvers::force_algorithms
