/// Reading of oscillators that are followed by steps.
#include "app/scene/stepped.hpp"

#include "analysis/motion/run.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/start.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

using analysis::motion::SteppedOscillator;
using Kept = std::shared_ptr<const SteppedOscillator>;

namespace {

/// From rest on the surface, or as [cycle] starts.
SteppedOscillator read_plane(SceneReader& reader) {
  auto& plane = *reader.scene.plane;
  plane.velocity = plane.mass.surface_velocity;
  if (auto cycle = reader.root.table("cycle"))
    if (const auto* start = cycle->find("start")) read_plane_start(*start, cycle->path("start"), plane);
  return analysis::motion::stepped(plane);
}

SteppedOscillator read_block(SceneReader& reader) {
  auto& model = *reader.scene.structure;
  model.start.kind = analysis::motion::Start::Kind::rest;
  if (auto cycle = reader.root.table("cycle"))
    if (const auto* start = cycle->find("start"))
      model.start = read_start_of_structure(*start, cycle->path("start"), reader.scene);
  if (auto solver = reader.root.table("solver")) {
    read_stepping(*solver, reader);
    solver->find("smoothing");  // of every verb
    solver->finish();
  }
  require_stepping_of_block(reader.scene);
  const auto* reduced = reduced_block_of(reader.scene);
  const auto& mesh = reduced ? reduced->mesh : *reader.scene.block;
  analysis::motion::StartShapes shapes{{{"along", "m"}, {"up", "m"}, {"tilt", "rad"}}, {}};
  shapes.columns.resize(model.structure.size(), 3);
  Eigen::Index column = 0;
  for (const auto& rigid : {mesh.rigid(1, 0, 0), mesh.rigid(0, 1, 0), mesh.rigid(0, 0, 1)})
    shapes.columns.col(column++) = reduced ? reduced->reduction.coordinates(rigid) : rigid;
  return analysis::motion::stepped(model, *reader.scene.task<analysis::motion::RunOptions>().stepping, shapes);
}

}  // namespace

bool read_stepped(SceneReader& reader) {
  auto& scene = reader.scene;
  // A reduced block, a structure, where the scene asks for steps.
  const bool by_steps = reduced_block_of(scene) && reader.document.at_path("solver.scheme");
  if (!scene.plane && !scene.block && !by_steps) return false;
  located(reader.root.find("drive")->source(), [&] {
    scene.task<Kept>() =
        std::make_shared<const SteppedOscillator>(scene.plane ? read_plane(reader) : read_block(reader));
  });
  return true;
}

const SteppedOscillator* stepped_of(const Scene& scene) { return scene.task<Kept>().get(); }

double drive_period_of(const Scene& scene) {
  if (const auto* stepped = stepped_of(scene)) return stepped->drive_period;
  return scene.structure ? common_period(scene.structure->structure) : 0;
}

void require_stepping_of_block(const Scene& scene) {
  if (scene.block && !scene.task<analysis::motion::RunOptions>().stepping)
    throw InputError(
        "the motion of a block goes by steps of a given length: give [solver] with scheme = \"average-acceleration\" "
        "and step (s)");
}

void read_stepping(Table& table, SceneReader& reader) {
  const auto* scheme = table.find("scheme");
  if (!scheme) return;
  if (!reader.scene.structure)
    fail(scheme->source(), "{} serves structures; a slider takes solver.type", table.path("scheme"));
  if (const auto* type = table.find("type"))
    fail(type->source(), "give {} or {}, not both", table.path("type"), table.path("scheme"));
  auto& stepping = reader.scene.task<analysis::motion::RunOptions>().stepping.emplace();
  const auto& names = analysis::motion::scheme_names();
  const auto name = choice(*scheme, table.path("scheme"), names);
  stepping.scheme = analysis::motion::Scheme(std::ranges::find(names, name) - names.begin());
  table.required("step", "length of a step, s");
  table.read("step", stepping.step, {"", "s", {1e-15, 1e15}, "length of a step"});
  if (const auto* radius = table.find("spectral_radius");
      radius && stepping.scheme != analysis::motion::Scheme::generalised_alpha)
    fail(radius->source(), "{} has no meaning for scheme '{}', only for generalised-alpha",
         table.path("spectral_radius"), name);
  table.read("spectral_radius", stepping.spectral_radius,
             {"", "1", {0, 1}, "part of the fastest motion that a step leaves"});
  if (!reader.smoothing)
    fail(scheme->source(),
         "{} needs friction that rises through rest: give solver.smoothing = {{ type = \"parabolic\", width = … }} "
         "with a width (m/s) well below the speed of the surface",
         table.path("scheme"));
  stepping.stick_width = reader.smoothing->width;
}

}  // namespace rosin::app::scene
