/// The largest Lyapunov exponent of a bowed string: does its motion repeat itself, or is it chaotic?
#pragma once
#include "analysis/cycles/lyapunov.hpp"
#include "analysis/motion/stepped_oscillator.hpp"
#include "oscillators/bowed_string.hpp"

namespace rosin::analysis::strings {

using oscillators::BowedStringModel;

/// The string followed sample by sample, its waves as the state. It has no channels: its motion is seen by bow().
/// \throws InputError where the bow changes its speed or load, or does not move
motion::SteppedOscillator stepped(const BowedStringModel&);

/// The growth of the distance between two neighbouring strings, as of every oscillator that is followed by steps. The
/// error covers the difference to a string at twice the sample rate. −∞: the bow forgets the difference, in stick.
cycles::LyapunovSpectrum lyapunov_spectrum(const BowedStringModel&, const cycles::LyapunovOptions&);

}  // namespace rosin::analysis::strings
