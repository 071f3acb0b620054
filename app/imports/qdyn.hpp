/// What a spring-slider of QDYN is, whichever of its inputs says so.
#pragma once
#include <map>
#include <string>
#include <string_view>

#include "app/imports/parameters.hpp"

namespace rosin::app::imports {

/// Parameters by QDYN's names (MESHDIM, V_PL, A, …), as its manual lists them.
using QdynParameters = std::map<std::string, Parameter, std::less<>>;

/// \throws InputError with file and line for what rosin has not
SceneText qdyn_scene(const std::string& path, const QdynParameters&);

/// The file qdyn.in.
QdynParameters read_qdyn_input(const std::string& path, std::string_view text);
/// A script for the wrapper in Python, or in MATLAB.
QdynParameters read_qdyn_script(const std::string& path, std::string_view text);

/// Whether the text is a qdyn.in: its first line is a whole number.
bool is_qdyn_input(std::string_view text);

}  // namespace rosin::app::imports
