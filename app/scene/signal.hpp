/// What changes in time: speeds, loads and forces of a scene.
#pragma once
#include <filesystem>
#include <string>

#include "app/scene/scene_table.hpp"
#include "core/signal.hpp"

namespace rosin::app::scene {

/// A table in a file: its name, or { file, time, value } with columns; without these a time in s and a value in `unit`
/// in two columns. \throws InputError with the line.
/// \param units_needed  numbers without a unit are refused
Signal::Table read_table_file(const toml::node&, const std::string& path, const std::string& unit,
                              const std::filesystem::path& folder, bool units_needed = false);

/// In the units of `quantity`; files are looked for in `folder`. \throws InputError with the place of what is wrong,
/// and where the signal leaves the quantity's range.
Signal read_signal(const toml::node&, const Quantity&, const std::filesystem::path& folder);

}  // namespace rosin::app::scene
