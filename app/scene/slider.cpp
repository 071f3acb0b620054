/// The slider on a spring and a damper.
#include "app/scene/oscillator.hpp"
#include "app/scene/profile.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/signal.hpp"
#include "app/scene/structure.hpp"
#include "app/tasks/curve.hpp"

namespace rosin::app::scene {

namespace {

/// \param complete false where the verb has a slider of its own, of which the scene changes what it names
void read_slider(SceneReader& reader, Table table, bool complete) {
  auto& slider = reader.scene.model.slider;
  table.expect({"type", "mass", "stiffness", "damping", "stops", "restitution"});
  table.find("type");
  refuse_profile(table);
  if (const auto* stops = table.find("stops")) refuse_stops_elsewhere(reader, *stops);
  if (complete) {
    table.required("mass", "kg; 0: quasi-static");
    table.required("stiffness", "N/m");
  }
  table.read("mass", slider.mass, mechanical("oscillator.mass"));
  table.read("stiffness", slider.stiffness, mechanical("oscillator.stiffness"));
  table.read("damping", slider.damping, mechanical("oscillator.damping"));
  table.finish();
}

void read_drive_and_stops(SceneReader& reader, Table drive, bool complete) {
  read_drive(reader, std::move(drive), complete);
  if (const auto* oscillator = reader.root.find("oscillator"))
    read_slider_stops(reader, Table(*oscillator, "oscillator"));
}

}  // namespace

void read_drive(SceneReader& reader, Table table, bool complete) {
  auto& drive = reader.scene.model.drive;
  table.expect({"speed", "normal_load", "force"});
  if (complete) {
    table.required("speed", "m/s");
    table.required("normal_load", "N");
  }
  for (const auto& [key, signal] : {std::pair{"speed", &drive.speed}, std::pair{"normal_load", &drive.normal_load},
                                    std::pair{"force", &drive.force}}) {
    const auto* node = table.find(key);
    if (node)
      *signal = read_signal(*node, mechanical(table.path(key)), reader.folder);
    else
      NumbersAsked::note(mechanical(table.path(key)));
  }
  table.finish();
  reader.scene.task<tasks::Curve>().normal_load = drive.normal_load.level();
}

OscillatorType slider_type() { return {"slider", {}, read_slider, read_drive_and_stops}; }

}  // namespace rosin::app::scene
