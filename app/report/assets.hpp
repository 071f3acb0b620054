/// Script, style and the library of charts that stand in every report; the build embeds them (cmake/embed.cmake).
#pragma once
#include <string_view>

namespace rosin::app::report {

struct Asset {
  std::string_view text;
  std::string_view sha256;  ///< in hexadecimal digits
};

extern const Asset library, script, style;

}  // namespace rosin::app::report
