/// What changes in time: speeds, loads and forces of a scene.
#pragma once
#include <filesystem>
#include <string>

#include "app/scene/scene_table.hpp"
#include "core/signal.hpp"

namespace rosin::app::scene {

/// Two numbers a line, separated by a comma or blanks: a time in s and a value in `unit`, unless the first line is a
/// header with other units. \throws InputError with the line.
Signal::Table read_signal(const std::filesystem::path&, const std::string& unit);

/// In the units of `quantity`; files are looked for in `folder`. \throws InputError with the place of what is wrong,
/// and where the signal leaves the quantity's range.
Signal read_signal(const toml::node&, const Quantity&, const std::filesystem::path& folder);

}  // namespace rosin::app::scene
