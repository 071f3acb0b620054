/// The verb cycle: the periodic motion, its multipliers and metrics.
#include "analysis/cycles/cycle.hpp"

#include <chrono>
#include <cmath>

#include "app/output/files.hpp"
#include "app/output/json.hpp"
#include "app/output/pictures.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/start.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/string.hpp"
#include "app/scene/structure.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/structure_cycle.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

void read_table(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  auto& cycle = scene.task<analysis::cycles::CycleOptions>();
  table.expect({"start", "stick_threshold"});
  table.read("stick_threshold", cycle.stick_threshold, {"", "1", {1e-6, 0.999}, "stick is |v| <= threshold times V"});
  // The start of a structure is read with it.
  if (const auto* start = scene.structure || scene.plane ? nullptr : table.find("start")) {
    cycle.start = scene::read_start(*start, table.path("start"), *scene.model.law);
    if (scene.model.law->set_valued())
      scene.notes.push_back("cycle.start has no effect under a set-valued law: stick forgets how the motion began");
  }
  table.finish();
}

std::string document_of(const scene::Scene& scene, const analysis::cycles::Cycle& cycle) {
  auto document = output::begin(scene, "cycle", cycle.outcome);
  const bool found = cycle.metrics.period > 0;  // known, if less accurately than asked
  const auto none = [] {
    analysis::cycles::Metrics absent;
    for (const auto& metric : analysis::cycles::metric_names()) absent.*metric.member = std::nan("");
    return absent;
  };
  document.update(output::metrics(found ? cycle.metrics : none()));
  document["stick_threshold"] = scene.task<analysis::cycles::CycleOptions>().stick_threshold;
  document["ill_conditioned_stick"] = cycle.ill_conditioned_stick;
  document["multipliers"] = output::pairs(cycle.multipliers);
  document["stable"] = found && !cycle.growth ? ordered_json(cycle.stable) : ordered_json();
  if (cycle.growth) document["growth"] = *cycle.growth;
  document["section"] = {{"displacement", found ? cycle.section_displacement : std::nan("")},
                         {"state", output::states(*scene.model.law, cycle.section_state)}};
  document["error"] = output::metrics(found ? cycle.error : none());
  document["error"]["multipliers"] = cycle.multiplier_errors;
  if (cycle.exponent)
    document["exponent"] = cycle.exponent->value, document["error"]["exponent"] = cycle.exponent->error;
  document["cost"] = {
      {"steps", cycle.cost.steps}, {"evaluations", cycle.cost.evaluations}, {"cycles", cycle.cost.cycles}};
  auto notes = scene.notes;
  if (!cycle.multipliers_left_out.empty()) notes.push_back(cycle.multipliers_left_out);
  document["notes"] = notes;
  return output::text(document);
}

/// A slider under a drive that varies is a structure of one coordinate: its periodic motions are those of a structure.
void read(scene::SceneReader& reader) {
  const auto& scene = reader.scene;
  reader.law();
  reader.oscillator();
  if (scene.string) return scene::read_string_cycle(reader);
  if (scene::read_stepped(reader))
    reader.note_unread({"cycle.stick_threshold"}, "stick is what the motion's steps show");
  else if (!scene.structure && scene.model.drive.constant())
    return read_tables_of_models(reader);
  else
    scene::read_structure_model(reader);
  if (auto table = reader.root.table("cycle")) read_table(*table, reader);
}

Status perform(Job& job) {
  auto& scene = job.scene();
  auto& asked = scene.task<analysis::cycles::CycleOptions>();
  if (scene.string) return perform_string_cycle(job);
  if (scene.structure || scene.plane) return perform_structure_cycle(job);
  asked.tolerance = job.request().tolerance.value_or(asked.tolerance);
  job.explain_model();
  job.explain("the cycle that is reached from stick, tolerance {} of every metric, at most {} cycles of transient",
              asked.tolerance, asked.max_cycles);
  const auto begin = std::chrono::steady_clock::now();
  const auto cycle = analysis::cycles::find_cycle(scene.model, asked);
  auto& manifest = job.manifest();
  manifest.tolerance_asked = asked.tolerance;
  manifest.cost = {{"seconds", seconds_since(begin)},
                   {"steps", double(cycle.cost.steps)},
                   {"evaluations", double(cycle.cost.evaluations)},
                   {"cycles", double(cycle.cost.cycles)}};
  if (!(cycle.metrics.period > 0)) return job.finish(document_of(scene, cycle), {}, cycle.outcome);

  Reached reached;
  for (const auto& metric : analysis::cycles::metric_names()) {
    const double value = cycle.metrics.*metric.member, error = cycle.error.*metric.member;
    reached.add(value, error);
    job.say("{:<22} {}", metric.name, justified(value, error, metric.unit));
  }
  manifest.tolerance_reached = reached.value();
  if (cycle.ill_conditioned_stick)
    job.note("the lowest speed touches the stick threshold: the stick fraction jumps nearby");
  if (cycle.growth)
    job.say("free swing, as the start made it: friction changes its amplitude by {:.1e} of itself in a period",
            *cycle.growth);
  if (!cycle.multipliers.empty())
    job.say("{}: largest multiplier {}", cycle.stable ? "stable" : "unstable",
            justified(std::abs(cycle.multipliers.front()), cycle.multiplier_errors.front(), "1"));
  if (!cycle.multipliers_left_out.empty()) job.note(cycle.multipliers_left_out);

  const auto states = scene.model.law->states().size();
  std::vector<std::vector<double>> columns(4 + states);
  for (const auto& point : cycle.orbit) {
    const double numbers[] = {point.time, point.displacement, point.slip_rate, point.friction_coefficient};
    for (std::size_t c = 0; c < 4; ++c) columns[c].push_back(numbers[c]);
    for (std::size_t s = 0; s < states; ++s)
      columns[4 + s].push_back(s < point.state.size() ? point.state[s] : std::nan(""));
  }
  std::vector<output::Column> table = {{"time (s)", columns[0]},
                                       {"displacement (m)", columns[1]},
                                       {"slip_rate (m/s)", columns[2]},
                                       {"friction_coefficient", columns[3]}};
  for (std::size_t s = 0; s < states; ++s) {
    const auto& state = scene.model.law->states()[s];
    table.push_back({output::column_header(state.name, state.unit), columns[4 + s]});
  }
  output::write_csv(job.folder() / "cycle.csv", table);
  auto files = output::write_picture(job.folder(), scene, cycle);
  files.push_back("cycle.csv");
  return job.finish(document_of(scene, cycle), std::move(files), cycle.outcome);
}

}  // namespace

Verb cycle_verb() {
  return {.name = "cycle",
          .help = "periodic motion, its multipliers and metrics",
          .example = "rosin cycle examples/leine-belt-block.toml",
          .operands = {scene_operand},
          .needs = model_tables({{"cycle", "stick threshold, and where the search starts", true}}),
          .options = scene_options(),
          .tables = {{"cycle", read_table}},
          .read = read,
          .perform = perform};
}

}  // namespace rosin::app::verbs
