/// The published force algorithms by name: what they need, what they refuse, and their motions.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "solvers/force_algorithms/stepped_motion.hpp"

namespace rosin::solvers::force_algorithms {

struct Description {
  std::string_view name, title;
};
/// In the order of publication.
std::span<const Description> algorithms();
bool is_algorithm(std::string_view name);

template <int D>
struct Track {
  std::vector<typename SteppedMotion<D>::Point> points;
  std::vector<Stick> sticks;
};

/// The step that is taken: the asked one, or a thousandth of the shortest period of spring, forces and load.
template <int D>
double step_of(const stick_slip::DryMass<D>&, const Options&);

/// \throws InputError for a step too long for stability, an adherence that is not overdamped, a window or transition
/// speed that is not between 0 and the speeds of the motion, and an algorithm that cannot serve the mass; each with the
/// admissible range.
template <int D>
void check(std::string_view algorithm, const stick_slip::DryMass<D>&, const Options&);

/// Motion from (x, v) at t = 0 under a forcing with steps of step_of(). The scheme after Meijaard takes its duration
/// and step from it, and evaluates the drive itself.
template <int D>
Track<D> follow(std::string_view algorithm, const stick_slip::DryMass<D>&, const Forcing<D>&, const Options&,
                const stick_slip::Vector<D>& x, const stick_slip::Vector<D>& v);

}  // namespace rosin::solvers::force_algorithms
