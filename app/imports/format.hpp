/// Programs whose inputs become scenes: one entry in formats.def and one file for each.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/imports/scene_text.hpp"

namespace rosin::app::imports {

struct Format {
  const char *name, *what;
  /// How surely a text is of this format, 0: not. The largest wins.
  int (*likeness)(std::string_view text);
  /// \throws InputError with file and line
  SceneText (*translate)(const std::string& path, std::string_view text);
};

/// All of them, in the order of formats.def.
const std::vector<Format>& formats();
/// The one of that name, or, without a name, the one that the text looks like. \throws InputError for none
const Format& format_of(std::string_view name, const std::string& path, std::string_view text);

}  // namespace rosin::app::imports
