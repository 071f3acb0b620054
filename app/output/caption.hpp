/// The line below a picture: what the scene is made of.
#pragma once
#include <string>

#include "app/scene/scene.hpp"

namespace rosin::app::output {

/// "law: ageing, a = 0.01, L = 10 um; oscillator: stiffness = 1000 N/m; drive: speed = 1 um/s": the numbers and names
/// that the scene sets, as it sets them, as far as a line has room.
std::string caption(const scene::Scene&);

/// Puts the caption below the last plot of a script for gnuplot, where `caption_room` is left free.
std::string captioned(std::string script, const scene::Scene&);
constexpr int caption_room = 18;  ///< pixels

}  // namespace rosin::app::output
