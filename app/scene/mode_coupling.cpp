/// A block on springs at angles, pressed on a belt.
#include "app/scene/oscillator.hpp"
#include "app/scene/profile.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

namespace {

void read_mode_coupling(SceneReader& reader, Table table, bool) {
  table.expect({"type", "mass", "springs", "damping", "contact", "profile", "stops"});
  table.find("type"), table.find("profile");  // which needs the speed of the drive
  oscillators::ModeCoupling model;
  const Quantity mass{"", "kg", {1e-12, 1e12}, "mass, along and into the belt"};
  table.required("mass", "a number, or a pair along and into the belt, kg");
  const auto masses = one_or_list(table, "mass", 2, mass, 1),
             damping = one_or_list(table, "damping", 2, {"", "N s/m", {0, 1e15}, "damping along and into the belt"}, 0);
  for (const int i : {0, 1}) model.mass[i] = masses[i], model.damping[i] = damping[i];
  const auto& springs = table.required("springs", "tables { stiffness, angle }");
  for (const auto& element : list(springs, table.path("springs"), "tables", most_names)) {
    Table spring(element, table.path("springs"));
    spring.expect({"stiffness", "angle"});
    spring.required("stiffness", "N/m");
    spring.required("angle", "to the direction of sliding, rad");
    auto& added = model.springs.emplace_back();
    spring.read("stiffness", added.stiffness, {"", "N/m", {0, 1e15}, "stiffness of a spring"});
    spring.read("angle", added.angle, {"", "rad", {-10, 10}, "angle of a spring to the direction of sliding"});
    spring.finish();
  }
  model.contact =
      read_normal_law(Table(table.required("contact", "stiffness normal to the belt"), table.path("contact")), false);
  table.finish();
  located(table.source(), [&] {
    reader.scene.structure.emplace().structure = oscillators::mode_coupling(model, contact_of(reader.scene.model), 0.0);
  });
  read_stops(reader, table);
}

void read_drive_and_profile(SceneReader& reader, Table drive, bool complete) {
  read_drive_of_one(reader, std::move(drive), complete);
  Table table(*reader.document.at_path("oscillator").node(), "oscillator");
  read_profile_under(reader, table, reader.scene.structure->structure.contacts[0]);
}

}  // namespace

OscillatorType mode_coupling_type() {
  return {"mode-coupling", verbs_of_structures, read_mode_coupling, read_drive_and_profile};
}

}  // namespace rosin::app::scene
