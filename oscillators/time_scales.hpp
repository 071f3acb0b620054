/// What a slider's motion takes its time from: the free oscillation about steady sliding, and states of the contact.
#pragma once
#include "oscillators/model.hpp"

namespace rosin::oscillators {

/// Damping of the slider and of steady friction that rises with the slip rate together, N s/m.
double resistance(const Model&);

/// True where that damping leaves no free oscillation.
bool overdamped(const Model&);

/// Time (s) of a free oscillation about steady sliding, or of relaxation to it where damping, with the damping by
/// friction that grows with the slip rate, leaves no oscillation. Steps of slip are a part of it.
double swing_time(const Model&);

/// True where the contact carries states of its own.
bool remembers(const Model&);

}  // namespace rosin::oscillators
