/// Oscillators that are followed by steps of their own, a plane slider and a block: with the start of [cycle], and the
/// steps of [solver].
#pragma once
#include <string_view>
#include <vector>

#include "analysis/motion/stepped_oscillator.hpp"
#include "app/scene/reader.hpp"

namespace rosin::app::scene {

/// Verbs that serve them; stability, branch and frf ask of their steady sliding.
inline const std::vector<std::string_view> verbs_by_steps = {"run",    "stability", "cycle", "map", "sweep",
                                                             "branch", "lyapunov",  "basin", "frf", "fit"};

/// After law and oscillator: reads how the oscillator is followed, if it is one that is followed by steps.
/// \returns whether it is
bool read_stepped(SceneReader&);
/// The oscillator that was read so; null: another one is in the scene.
const analysis::motion::SteppedOscillator* stepped_of(const Scene&);
/// s, of the drive of a structure or of an oscillator that is followed by steps; 0: the drive is constant.
double drive_period_of(const Scene&);

/// [solver] scheme, step and spectral_radius: steps of a given length for a structure.
void read_stepping(Table&, SceneReader&);
/// \throws InputError for a block without them
void require_stepping_of_block(const Scene&);

}  // namespace rosin::app::scene
