/// The line below a picture: what the scene is made of.
#pragma once
#include <string>
#include <vector>

#include "app/scene/scene.hpp"

namespace rosin::app::output {

/// "law: ageing, a = 0.01, L = 10 um; oscillator: stiffness = 1000 N/m; drive: speed = 1 um/s": the numbers and names
/// that the scene sets, as it sets them, as far as two lines have room.
/// \param varied parameters that the picture is drawn over, such as "drive.speed", or whole tables, such as "law": left
/// out
std::string caption(const scene::Scene&, const std::vector<std::string>& varied = {});

}  // namespace rosin::app::output
