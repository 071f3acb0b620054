/// The key `profile`: heights of the surface under a contact over the distance along it.
#pragma once
#include <optional>

#include "app/scene/reader.hpp"
#include "app/scene/scene_table.hpp"
#include "oscillators/profile.hpp"
#include "oscillators/structure.hpp"

namespace rosin::app::scene {

/// The profile that this table gives, if any.
std::optional<oscillators::Profile> read_profile(SceneReader&, Table& owner);

/// Reads it, and lays it under a contact of one station, whose speed is known.
void read_profile_under(SceneReader&, Table& owner, oscillators::FrictionContact&);

/// \throws InputError where the table gives a profile to a contact whose load is prescribed
void refuse_profile(Table& owner);

}  // namespace rosin::app::scene
