/// Inputs that a table says to be uncertain. Include only in .cpp files.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "app/scene/scene_table.hpp"
#include "core/uncertain.hpp"

namespace rosin::app::scene {

/// Draws of inputs: `uncertain`, relative standard deviations by path, with `samples` and `seed` beside it.
/// \param check throws InputError for a path that names no number
std::vector<Uncertain> read_uncertain(Table&, const std::function<void(const std::string& path)>& check, int& samples,
                                      std::uint64_t& seed);

}  // namespace rosin::app::scene
