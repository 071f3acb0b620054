/// A slider in the plane: springs, dampers and forces along x and y, friction against the velocity vector.
#include "app/scene/oscillator.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/signal.hpp"

namespace rosin::app::scene {

namespace {

void read(SceneReader& reader, Table table, bool) {
  const auto& law = *reader.scene.model.law;
  const auto& of_law = reader.document.get("law")->source();
  const auto friction = law.linear();
  if (reader.scene.model.contact_stiffness.present())
    fail(of_law, "law.contact_stiffness does not go with a plane slider, whose contact is rigid");
  if (!friction || friction->slope != 0)
    fail(of_law, "oscillator.type = 'plane-slider' is for Coulomb friction; law '{}' is another", law.card().name);
  auto& mass = reader.scene.plane.emplace().mass;
  table.expect({"type", "mass", "stiffness", "damping"});
  table.find("type");
  table.required("mass", "kg");
  table.read("mass", mass.mass, {"", "kg", {1e-12, 1e12}, "mass of the slider"});
  mass.stiffness = both(table, "stiffness", {"", "N/m", {1e-12, 1e15}, "stiffness of the springs"});
  mass.damping = both(table, "damping", {"", "N s/m", {0, 1e15}, "damping of the motion"});
  table.finish();
  mass.dynamic_friction = friction->constant;
}

void read_plane_drive(SceneReader& reader, Table drive, bool) {
  auto& mass = reader.scene.plane->mass;
  drive.expect({"speed", "normal_load", "force"});
  if (drive.find("speed")) mass.surface_velocity = both(drive, "speed", mechanical("drive.speed"));
  mass.load = read_signal(drive.required("normal_load", "N"), mechanical("drive.normal_load"), reader.folder);
  const auto quantity = mechanical("drive.force");
  mass.force = both(drive.required("force", "two signals, N"), quantity.name,
                    [&](const toml::node& node) { return read_signal(node, quantity, reader.folder); });
  drive.finish();
  mass.static_friction = reader.scene.model.law->static_limit(mass.load.level());
}

}  // namespace

OscillatorType plane_slider_type() { return {"plane-slider", {"run"}, read, read_plane_drive}; }

}  // namespace rosin::app::scene
