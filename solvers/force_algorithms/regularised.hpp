/// Regularised models: friction falls to zero over a transition speed V_l. Nothing sticks: at rest the mass creeps.
///
/// VLFM: linear. SVLFM: J. T. Oden & J. A. C. Martins, Comput. Methods Appl. Mech. Eng. 52 (1985) 527, u (2 − |u|).
#pragma once
#include "solvers/force_algorithms/cfm.hpp"

namespace rosin::solvers::force_algorithms {

template <int D, bool smooth>
struct Regularised : Algorithm<D> {
  static constexpr bool can_stick = false, regularised = true;
  stick_slip::Vector<D> friction(const SteppedMotion<D>& motion, double load, const stick_slip::Vector<D>&,
                                 const stick_slip::Vector<D>& w) const {
    const double u = length<D>(w) / motion.options().transition_speed;
    // |F|/(μd N) over u, so that u = 0 needs no direction
    const double slope = u >= 1 ? 1 / u : smooth ? 2 - u : 1;
    stick_slip::Vector<D> F;
    for (int d = 0; d < D; ++d)
      F[d] = -motion.mass().dynamic_friction * load * slope * w[d] / motion.options().transition_speed;
    return F;
  }
  void begin_stick(SteppedMotion<D>&, std::size_t, const stick_slip::Vector<D>&) {}
  void decide(SteppedMotion<D>& motion, std::size_t n) { motion.keep(n); }
};

}  // namespace rosin::solvers::force_algorithms
