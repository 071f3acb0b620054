/// Texts as HTML, SVG and XML take them.
#pragma once
#include <string>
#include <string_view>

namespace rosin::app::output {

/// A text that may hold anything, as content of an element or of an attribute.
std::string escaped(std::string_view);

}  // namespace rosin::app::output
