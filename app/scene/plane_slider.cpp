/// A slider in the plane: springs, dampers and forces along x and y, friction against the velocity vector.
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "analysis/motion/plane_model.hpp"
#include "analysis/steady/plane_sliding.hpp"
#include "app/scene/oscillator.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/signal.hpp"
#include "app/scene/stepped.hpp"
#include "laws/plane_form.hpp"

namespace rosin::app::scene {

namespace {

/// True for verbs that ask of steady sliding alone: as a structure, under laws that may have states.
bool asks_of_steady_sliding(const SceneReader& reader) {
  const auto& verb = reader.request.verb;
  return verb == "stability" || verb == "branch" || verb == "frf";
}

/// Friction that remembers needs a vector form, and its memory.
void require_form_in_plane(SceneReader& reader) {
  const auto& law = *reader.scene.model.law;
  if (!law.has_states()) return;
  const auto& source = reader.document.get("law")->source();
  const auto serve = [] { return fmt::format("{}", fmt::join(laws::names_in_plane(), ", ")); };
  if (const auto why = laws::refusal_in_plane(law, reader.scene.plane->mass.load.level()); !why.empty())
    fail(source, "law '{}' on a plane slider {}; of laws with states {} serve, and laws without", law.card().name, why,
         serve());
  if (reader.scene.model.lambda == 0)
    fail(source,
         "law.lambda = 0 leaves law '{}' no memory: on a plane slider give its curve itself, a law without states "
         "(such as "
         "stribeck or a table), or lambda > 0",
         law.card().name);
}

void read_plane_slider(SceneReader& reader, Table table, bool) {
  const auto& law = reader.scene.model.law;
  const auto& of_law = reader.document.get("law")->source();
  if (reader.scene.model.contact_stiffness.present())
    fail(of_law, "law.contact_stiffness does not go with a plane slider, whose contact is rigid");
  if (reader.scene.model.load_memory > 0) fail(of_law, "law.load_memory does not go with a plane slider");
  auto& mass = (reader.scene.plane = std::make_shared<analysis::motion::PlaneModel>())->mass;
  table.expect({"type", "mass", "stiffness", "damping"});
  table.find("type");
  table.required("mass", "kg");
  table.read("mass", mass.mass, {"", "kg", {1e-12, 1e12}, "mass of the slider"});
  mass.stiffness = both(table, "stiffness", {"", "N/m", {1e-12, 1e15}, "stiffness of the springs"});
  mass.damping = both(table, "damping", {"", "N s/m", {0, 1e15}, "damping of the motion"});
  table.finish();
  const auto linear = law->linear();
  if (!linear || linear->slope != 0) reader.scene.plane->law = law;
  reader.scene.plane->lambda = reader.scene.model.lambda;
}

void read_plane_drive(SceneReader& reader, Table drive, bool) {
  auto& mass = reader.scene.plane->mass;
  drive.expect({"speed", "normal_load", "force"});
  if (drive.find("speed")) mass.surface_velocity = both(drive, "speed", mechanical("drive.speed"));
  mass.load = read_signal(drive.required("normal_load", "N"), mechanical("drive.normal_load"), reader.folder);
  const auto quantity = mechanical("drive.force");
  if (const auto* force = drive.find("force"))
    mass.force =
        both(*force, quantity.name, [&](const toml::node& node) { return read_signal(node, quantity, reader.folder); });
  drive.finish();
  if (asks_of_steady_sliding(reader))
    reader.scene.structure.emplace().structure = located(reader.root.find("drive")->source(), [&] {
      return analysis::steady::sliding_in_plane(mass, contact_of(reader.scene.model));
    });
  if (!asks_of_steady_sliding(reader)) require_form_in_plane(reader);
  const auto& law = *reader.scene.model.law;
  if (!law.set_valued() || law.has_states()) {
    mass.static_friction = mass.dynamic_friction = 0;
    return;
  }
  const auto coefficients = [&](double load) {
    const double at_rest = law.static_limit(load),
                 moving = law.friction({std::numeric_limits<double>::min(), load}, {});
    return std::pair{at_rest, std::min(moving, at_rest)};  // rounding may leave them the other way
  };
  const double load = mass.load.level();
  std::tie(mass.static_friction, mass.dynamic_friction) = coefficients(load);
  if (!mass.load.constant() && coefficients(2 * load) != coefficients(load))
    fail(reader.document.get("law")->source(),
         "law '{}' depends on the load, which of a plane slider must then be constant; drive.normal_load varies",
         law.card().name);
}

}  // namespace

OscillatorType plane_slider_type() {
  return {"plane-slider",
          verbs_by_steps,
          read_plane_slider,
          read_plane_drive,
          {{"lab",
            "friction in the plane turns with the slip, and experiments read it along one line; 'run' follows "
            "any drive"}}};
}

}  // namespace rosin::app::scene
