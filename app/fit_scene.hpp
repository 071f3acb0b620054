/// The table [fit] of a scene.
#pragma once
#include <filesystem>
#include <functional>

#include "app/scene.hpp"

namespace rosin::app {

class Table;

/// Reads what is to be fitted, and the files of data, which are looked for in `folder`. `read_law` reads the law of a
/// candidate. \throws InputError with the place of what cannot be used.
void read_fit(Table&, Scene&, const std::filesystem::path& folder,
              const std::function<void(Table, oscillators::Model&)>& read_law);

}  // namespace rosin::app
