/// A block on a belt before a second mass.
#include "app/scene/oscillator.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

namespace {

/// That of the block and "second_…", or a pair of the two.
void read_both(Table& table, const std::string& key, double& block, double& second, const Quantity& quantity,
               bool required = false) {
  const std::string other = "second_" + key;
  if (const auto* node = table.find(key); node && node->is_array()) {
    if (const auto* also = table.find(other))
      fail(also->source(), "{}: give a pair {} or {}, not both", table.path(other), key, other);
    const auto pair = both(table, key, quantity);
    block = pair[0], second = pair[1];
    return;
  }
  if (required) table.required(other, quantity.unit);
  table.read(key, block, quantity);
  table.read(other, second, quantity);
}

void read_two_mass_belt(SceneReader& reader, Table table, bool) {
  table.expect({"type", "mass", "stiffness", "damping", "second_mass", "second_stiffness", "second_damping", "stops"});
  table.find("type");
  oscillators::TwoMassBelt belt;
  table.required("mass", "of the block on the belt, kg");
  table.required("stiffness", "of the spring between the masses, N/m");
  const Quantity mass{"", "kg", {1e-12, 1e12}, "mass"}, stiffness{"", "N/m", {0, 1e15}, "stiffness of a spring"},
      damping{"", "N s/m", {0, 1e15}, "damping"};
  belt.second = {1, 0, 0};
  read_both(table, "mass", belt.block.mass, belt.second.mass, mass, true);
  read_both(table, "stiffness", belt.block.stiffness, belt.second.stiffness, stiffness);
  read_both(table, "damping", belt.block.damping, belt.second.damping, damping);
  table.finish();
  reader.scene.structure.emplace().structure = oscillators::two_mass_belt(belt, contact_of(reader.scene.model), 0.0);
  read_stops(reader, table);
}

}  // namespace

OscillatorType two_mass_belt_type() {
  return {"two-mass-belt", verbs_of_structures, read_two_mass_belt, read_drive_of_one};
}

}  // namespace rosin::app::scene
