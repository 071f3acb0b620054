/// A block on a belt before a second mass.
#include "app/scene/oscillator.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

namespace {

void read(SceneReader& reader, Table table, bool) {
  table.expect({"type", "mass", "stiffness", "damping", "second_mass", "second_stiffness", "second_damping", "stops"});
  table.find("type");
  oscillators::TwoMassBelt belt;
  table.required("mass", "of the block on the belt, kg");
  table.required("stiffness", "of the spring between the masses, N/m");
  table.required("second_mass", "kg");
  const Quantity mass{"", "kg", {1e-12, 1e12}, "mass"}, stiffness{"", "N/m", {0, 1e15}, "stiffness of a spring"},
      damping{"", "N s/m", {0, 1e15}, "damping"};
  belt.second = {1, 0, 0};
  table.read("mass", belt.block.mass, mass);
  table.read("stiffness", belt.block.stiffness, stiffness);
  table.read("damping", belt.block.damping, damping);
  table.read("second_mass", belt.second.mass, mass);
  table.read("second_stiffness", belt.second.stiffness, stiffness);
  table.read("second_damping", belt.second.damping, damping);
  table.finish();
  reader.scene.structure.emplace().structure = oscillators::two_mass_belt(belt, contact_of(reader.scene.model), 0.0);
  read_stops(reader, table);
}

}  // namespace

OscillatorType two_mass_belt_type() { return {"two-mass-belt", {"run", "stability", "cycle", "map"}, read, read_drive_of_one}; }

}  // namespace rosin::app::scene
