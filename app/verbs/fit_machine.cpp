/// A family of scenes, whose motions a fit compares with records.
#include "app/verbs/fit_machine.hpp"

#include <fmt/format.h>

#include "analysis/inference/machine_motion.hpp"
#include "app/scene/family.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/structure.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/run.hpp"

namespace rosin::app::verbs {

namespace {

/// Law, oscillator, drive and solver of a scene, with the start that its data have. A slider with a mass is followed as
/// a structure, in one pass.
void read_machine(scene::SceneReader& reader, const std::string& start) {
  auto& scene = reader.scene;
  reader.law();
  reader.oscillator();
  if (!scene.plane && !scene.structure && scene.model.slider.mass > 0)
    scene.structure.emplace().structure =
        scene::located(reader.root.find("oscillator")->source(), [&] { return oscillators::one_slider(scene.model); });
  if (auto solver = reader.root.table("solver")) read_solver(*solver, reader);
  scene::require_stepping_of_block(scene);
  read_start_of_run(*scene::node_at(reader.document, start), "fit.data.start", scene);
}

/// The scene with another law in place of its own, where one is given.
scene::Family family_of(const scene::SceneReader& of, const toml::node* law, const scene::Family::Read& read) {
  auto document = of.document;
  if (law) document.insert_or_assign("law", *law);
  scene::Scene unused;
  const scene::SceneReader like{of.request, document, scene::Table(document, ""), unused, of.folder, {}};
  return {like, "fit", read};
}

}  // namespace

using analysis::inference::Machine;
using analysis::inference::MachineNumbers;

std::shared_ptr<const Machine> machine_of(const scene::SceneReader& of, const toml::node* law, std::size_t data,
                                          std::string name, std::vector<double> times) {
  const auto start = fmt::format("data.{}.start", data + 1);
  const auto family = std::make_shared<const scene::Family>(
      family_of(of, law, [start](scene::SceneReader& reader) { read_machine(reader, "fit." + start); }));
  // Bounds the work of one motion, as that of a record whose motion is imposed.
  constexpr long most_steps = 20000, for_each_sample = 10;
  const auto run = [family](const MachineNumbers& numbers, const std::vector<double>& at) {
    const auto scene = family->with_numbers({numbers.begin(), numbers.end()});
    auto how = scene.task<analysis::motion::RunOptions>();
    how.times = at, how.duration = at.back();
    how.tolerance = analysis::inference::motion_tolerance, how.once = true;
    how.most_steps = most_steps + for_each_sample * long(at.size());
    return run_of(scene, how);
  };
  return std::make_shared<const Machine>(
      Machine::Family{run,
                      {},
                      [family](const std::string& path) { return family->describe(path); },
                      [family](const std::string& path) { return family->value(path); }},
      std::move(name), start + ".", std::move(times), of.request.threads);
}

std::shared_ptr<const Machine> stick_slip_machine_of(const scene::SceneReader& of, const toml::node* law,
                                                     std::size_t data, std::string name) {
  const auto family = std::make_shared<const scene::Family>(family_of(of, law, scene::read_structure_model));
  return std::make_shared<const Machine>(
      Machine::Family{{},
                      [family](const MachineNumbers& numbers) {
                        return *family->with_numbers({numbers.begin(), numbers.end()}).structure;
                      },
                      [family](const std::string& path) { return family->describe(path); },
                      [family](const std::string& path) { return family->value(path); }},
      std::move(name), fmt::format("data.{}.start.", data + 1), std::vector<double>(), of.request.threads);
}

}  // namespace rosin::app::verbs
