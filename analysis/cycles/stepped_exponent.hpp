/// The largest Lyapunov exponent of an oscillator that is followed by steps: how two neighbouring motions diverge.
#pragma once
#include "analysis/cycles/lyapunov.hpp"
#include "analysis/motion/stepped_oscillator.hpp"

namespace rosin::analysis::cycles {

/// The largest exponent alone: of two neighbouring motions, whose difference is scaled back to its first size time and
/// again (Benettin, Galgani & Strelcyn 1976, Phys. Rev. A 14, 2338). The second half of the average is followed by
/// finer steps from another difference. The error is the largest of both halves' errors by blocks and half their
/// difference. −∞: the difference is forgotten, in stick.
/// \throws InputError without a duration
LyapunovSpectrum lyapunov_spectrum(const motion::SteppedOscillator&, const LyapunovOptions&);

/// The same of a motion from a state on, whose returns take so long on average; nothing where it cannot be followed.
std::optional<Exponent> largest_exponent(const motion::SteppedOscillator&, double tolerance, double t,
                                         const std::vector<double>& state, double mean_return, long most_returns);

}  // namespace rosin::analysis::cycles
