/// A rigid block on a belt.
#include "oscillators/rigid_block.hpp"

#include "app/scene/oscillator.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

namespace {

void read_rigid_block(SceneReader& reader, Table table, bool) {
  table.expect({"type", "mass", "length", "height", "thickness", "spring_stiffness", "foundation", "stations",
                "normal_contact"});
  table.find("type");
  oscillators::RigidBlock block;
  constexpr Range length{1e-9, 1e6};
  table.required("mass", "kg");
  table.required("length", "along the belt, m");
  table.required("height", "m");
  table.required("spring_stiffness", "between the block's centre and the frame, N/m");
  table.read("mass", block.mass, {"", "kg", {1e-12, 1e12}, "mass of the block"});
  table.read("length", block.length, {"", "m", length, "length of the block along the belt"});
  table.read("height", block.height, {"", "m", length, "height of the block"});
  table.read("thickness", block.thickness, {"", "m", length, "thickness of the block across the belt"});
  table.read("spring_stiffness", block.spring_stiffness, {"", "N/m", {1e-15, 1e15}, "stiffness of the spring"});
  if (const auto* foundation = table.find("foundation"))
    block.on_feet = choice(*foundation, table.path("foundation"), {"face", "feet"}) == "feet";
  if (const auto* stations = table.find("stations"); stations && block.on_feet)
    fail(stations->source(), "{} has no effect on a block that stands on two feet", table.path("stations"));
  table.read("stations", block.stations, 2, 256, "Gauss points of the face");
  const auto& contact = table.required("normal_contact", "pressure of the face by its approach");
  block.contact = read_normal_law(Table(contact, table.path("normal_contact")), true);
  table.finish();
  located(table.source(), [&] {
    reader.scene.structure.emplace().structure =
        oscillators::rigid_block_on_belt(block, contact_of(reader.scene.model));
  });
}

void read_drive_of_face(SceneReader& reader, Table drive, bool complete) {
  read_structure_drive(reader, std::move(drive), complete, false);
  auto& contact = reader.scene.structure->structure.contacts[0];
  contact.speed = reader.scene.model.drive.speed, contact.normal_load = reader.scene.model.drive.normal_load;
}

}  // namespace

OscillatorType rigid_block_type() { return {"rigid-block", verbs_of_structures, read_rigid_block, read_drive_of_face}; }

}  // namespace rosin::app::scene
