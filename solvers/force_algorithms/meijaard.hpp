/// Meijaard's scheme: Runge–Kutta steps shortened by interpolation to end where the velocity passes zero.
///
/// Source: J. P. Meijaard, "Efficient numerical integration of the equations of motion of non-smooth mechanical
/// systems", Z. Angew. Math. Mech. 77 (1997) 419. Accurate to the order of the steps; what begins and ends within one
/// step is missed.
#pragma once
#include "solvers/force_algorithms/stepped_motion.hpp"

namespace rosin::solvers::force_algorithms {

/// Points of the motion in one direction, steps of `step` between events, and its sticks.
void follow_meijaard(const stick_slip::DryMass<1>&, double step, double duration, double x, double v, const Options&,
                     std::vector<SteppedMotion<1>::Point>& points, std::vector<Stick>& sticks);

}  // namespace rosin::solvers::force_algorithms
