/// What all gnuplot scripts have in common.
#pragma once
#include <string>
#include <string_view>

namespace rosin::app {

/// A text for gnuplot in single quotes: markup characters are shown as they are, control characters dropped.
std::string single_quoted(std::string_view text);

/// What every script begins with. `format` and `output` may be set by the caller: gnuplot -e "format='png'" map.gp
std::string preamble(const std::string& name, std::string_view what, int width, int height);

}  // namespace rosin::app
