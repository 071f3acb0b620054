/// A pin on an elastic arm, pressed on a moving disk.
#include "oscillators/pin_on_disk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/scene/oscillator.hpp"
#include "app/scene/profile.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

namespace {

/// Of translations along and normal to the track, and of rotation; the last has a unit of its own.
template <std::size_t count>
void read_directions(Table& table, std::string_view key, std::array<double, count>& target, Range range,
                     const char* unit, const char* unit_of_rotation, const char* meaning) {
  const auto* node = table.find(key);
  const auto* values = node ? &list(*node, table.path(key), "numbers", count) : nullptr;
  if (values && values->size() != count)
    fail(node->source(), "{} has {} entries, but {} are needed: along the track, normal to it{}", table.path(key),
         values->size(), count, count > 2 ? ", and of rotation" : "");
  for (std::size_t i = 0; i < count; ++i) {
    const Quantity quantity{fmt::format("{}.{}", table.path(key), i + 1), i < 2 ? unit : unit_of_rotation, range,
                            meaning};
    if (values)
      target[i] = number(*values->get(i), quantity);
    else
      NumbersAsked::note(quantity);
  }
}

/// The rig is put together when speed and load are known.
void read_pin_on_disk(SceneReader& reader, Table, bool) { reader.scene.structure.emplace(); }

void read_drive_and_rig(SceneReader& reader, Table drive, bool complete) {
  read_structure_drive(reader, std::move(drive), complete, false);
  const auto& node = *reader.document.at_path("oscillator").node();
  Table table(node, "oscillator");
  table.expect({"type",           "pin_diameter",   "pin_height",    "pin_mass",    "pin_inertia",   "block_mass",
                "block_inertia",  "lever",          "arm_stiffness", "arm_damping", "pin_stiffness", "pin_damping",
                "disk_stiffness", "disk_mass",      "disk_inertia",  "disk_height", "angle",         "convective",
                "stations",       "normal_contact", "profile"});
  table.find("type");
  oscillators::PinOnDisk rig;
  constexpr Range length{1e-9, 1e3}, mass{1e-12, 1e12}, stiffness{0, infinity, 0, 1e18}, damping{0, 1e15};
  table.read("pin_diameter", rig.pin_diameter, {"", "m", length, "diameter of the pin"});
  table.read("pin_height", rig.pin_height, {"", "m", length, "height of the pin"});
  table.read("pin_mass", rig.pin_mass, {"", "kg", mass, "mass of the pin"});
  table.read("pin_inertia", rig.pin_inertia, {"", "kg m^2", {1e-30, 1e12}, "inertia of the pin about its centre"});
  table.read("block_mass", rig.block_mass, {"", "kg", mass, "mass of the block"});
  table.read("block_inertia", rig.block_inertia,
             {"", "kg m^2", {1e-30, 1e12}, "inertia of the block about its centre"});
  table.read("lever", rig.lever, {"", "m", {0, 1e3}, "from the pin's centre to the block's"});
  read_directions(table, "arm_stiffness", rig.arm_stiffness, stiffness, "N/m", "N m", "stiffness of the arm");
  read_directions(table, "arm_damping", rig.arm_damping, damping, "N s/m", "N m s", "damping of the arm");
  read_directions(table, "pin_stiffness", rig.pin_stiffness, stiffness, "N/m", "N m",
                  "stiffness between pin and block");
  read_directions(table, "pin_damping", rig.pin_damping, damping, "N s/m", "N m s", "damping between pin and block");
  read_directions(table, "disk_stiffness", rig.disk_stiffness, stiffness, "N/m", "N m", "stiffness of the disk");
  read_directions(table, "disk_mass", rig.disk_mass, mass, "kg", "", "mass of the disk");
  table.read("disk_inertia", rig.disk_inertia,
             {"", "kg m^2", {1e-30, infinity, 1e-30, 1e12}, "inertia of the disk's piece; inf: it does not rotate"});
  table.read("disk_height", rig.disk_height, {"", "m", {0, 1e3}, "height of the disk's piece"});
  table.read("angle", rig.angle, {"", "rad", {-0.5, 0.5}, "of attack, of the track against the pin's face"});
  read_truth(table, "convective", rig.convective);
  table.read("stations", rig.stations, 4, 4096, "stations of the quadrature over the pin's face");
  laws::PowerContact surfaces{
      .coefficient = 1.25e20, .exponent = 2.5, .bound_coefficient = 1.25e20, .bound_exponent = 2.5};
  rig.normal_law = laws::normal_law(surfaces);
  if (const auto* contact = table.find("normal_contact"))
    rig.normal_law = read_normal_law(Table(*contact, table.path("normal_contact")), true);
  const auto profile = read_profile(reader, table);
  if (profile) rig.profile = *profile;
  table.finish();
  if (std::ranges::all_of(rig.disk_stiffness, [](double k) { return std::isinf(k); }))
    for (const char* key : {"disk_mass", "disk_inertia", "disk_height"})
      if (const auto* given = table.find(key))
        fail(given->source(), "{} has no effect: the disk is rigid; give disk_stiffness (N/m)", table.path(key));
  auto contact = contact_of(reader.scene.model);
  contact.speed = reader.scene.model.drive.speed, contact.normal_load = reader.scene.model.drive.normal_load;
  reader.scene.structure->structure = located(node.source(), [&] { return oscillators::pin_on_disk(rig, contact); });
}

}  // namespace

OscillatorType pin_on_disk_type() { return {"pin-on-disk", verbs_of_structures, read_pin_on_disk, read_drive_and_rig}; }

}  // namespace rosin::app::scene
