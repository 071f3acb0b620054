/// Scenes of oscillators that a user's own program adds.
#include "app/add_oscillator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "app/scene/oscillator.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app {

namespace {

constexpr std::string_view type_key = "type", stops_key = "stops";

/// The structure in the scene, by [oscillator] and by law and drive as far as they have been read.
void build(scene::SceneReader& reader, scene::Table& table, const AddedOscillator& added) {
  std::vector<double> values;
  for (const auto& [quantity, usual] : added.parameters)
    table.read(quantity.name, values.emplace_back(usual), quantity);
  scene::located(table.source(), [&] {
    const auto& model = reader.scene.model;
    auto structure = added.structure(values, contact_of(model), model.drive.force);
    structure.check();
    if (int(structure.names.size()) != structure.size())
      throw InputError(fmt::format("oscillator.type = '{}' has {} names for {} coordinates", added.name,
                                   structure.names.size(), structure.size()));
    reader.scene.structure.emplace().structure = std::move(structure);
  });
  scene::read_stops(reader, table);
}

void read(scene::SceneReader& reader, scene::Table table, const AddedOscillator& added) {
  table.find(type_key);
  build(reader, table, added);
  table.finish();
}

/// Contacts and forces follow the drive: the structure is built again with it.
void read_drive(scene::SceneReader& reader, scene::Table drive, bool complete, const AddedOscillator& added) {
  const auto* force = drive.find("force");
  scene::read_structure_drive(reader, std::move(drive), complete, true);
  scene::Table table(*reader.root.find("oscillator"), "oscillator");
  build(reader, table, added);
  if (force && reader.scene.structure->structure.force.empty())
    scene::fail(force->source(), "drive.force has no place on oscillator.type = '{}'", added.name);
}

}  // namespace

void add_oscillator(AddedOscillator oscillator) {
  for (const auto& [quantity, usual] : oscillator.parameters) {
    const auto is = [&](std::string_view key) { return key == quantity.name; };
    if (is(type_key) || is(stops_key) || std::ranges::any_of(scene::Reference::keys, is))
      throw InputError(fmt::format("oscillator.{} is a key of every oscillator: '{}' needs another name for it",
                                   quantity.name, oscillator.name));
    require(usual, quantity.range, "oscillator." + quantity.name, quantity.meaning, quantity.unit);
  }
  const auto added = std::make_shared<const AddedOscillator>(std::move(oscillator));
  using scene::SceneReader, scene::Table;
  scene::add_oscillator_type(
      {.name = added->name,
       .verbs = scene::verbs_of_structures,
       .read = [added](SceneReader& reader, Table table, bool) { read(reader, std::move(table), *added); },
       .read_drive = [added](SceneReader& reader, Table drive,
                             bool complete) { read_drive(reader, std::move(drive), complete, *added); }});
}

}  // namespace rosin::app
