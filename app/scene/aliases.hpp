/// Names that other programs use for what a scene has under a name of its own: each is read as that name, with a note,
/// where both mean exactly the same; else it is refused with what to give instead.
#pragma once
#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

namespace rosin::app::scene {

/// The law of that name, or the name itself. \throws InputError for a name that stands for several laws or for none
std::string law_called(std::string_view name);

/// Gives law types, keys of [law], [oscillator], [drive] and [run], and paths of such keys, their own names; each
/// change is noted. A key that a law has under that very name stays. To be called after each override, which then
/// replaces what the scene has under either name. \throws InputError with the place, also where a file gives both names
void resolve_aliases(toml::table& scene, std::vector<std::string>& notes);

}  // namespace rosin::app::scene
