/// The verb cycle: the periodic motion of any oscillator, its multipliers and metrics, table and picture.
#include "app/verbs/cycle.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/cycles/irregular_motion.hpp"
#include "analysis/cycles/stepped_cycle.hpp"
#include "app/output/pictures.hpp"
#include "app/results/events.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/start.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/string.hpp"
#include "app/scene/structure.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using analysis::cycles::IrregularMotion;
using analysis::cycles::StructureCycle;
using nlohmann::ordered_json;

std::vector<std::string> told_metrics(const scene::Scene& scene, const std::vector<std::string>& known) {
  std::vector<std::string> told;
  for (const auto& metric : analysis::cycles::metric_names())
    if (std::ranges::find(known, metric.name) != known.end()) told.emplace_back(metric.name);
  const auto* stepped = scene::stepped_of(scene);
  const auto is_of_coordinate = [&](std::string_view name) {
    if (name.find("displacement") != std::string_view::npos || name.starts_with("slip")) return true;
    return stepped && std::any_of(stepped->channels.begin(), stepped->channels.begin() + stepped->coordinates,
                                  [&](const auto& channel) { return name.substr(0, name.size() - 4) == channel.name; });
  };
  for (const auto& name : known) {
    if (std::ranges::find(told, name) != told.end()) continue;
    const bool extreme = name.ends_with("_max") || name.ends_with("_min");
    if (name.starts_with("stick_fraction") || name.starts_with("friction_drop") || (extreme && is_of_coordinate(name)))
      told.push_back(name);
  }
  return told;
}

namespace {

void read_cycle_table(scene::Table table, scene::SceneReader& reader) {
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

/// Under a periodic drive also the answer at its frequency, which is a harmonic of a motion that takes several periods.
std::vector<std::string> told_metrics(const scene::Scene& scene, const StructureCycle& cycle) {
  std::vector<std::string> known;
  for (const auto& [name, measure] : cycle.metrics) known.push_back(name);
  auto told = verbs::told_metrics(scene, known);
  if (scene::drive_period_of(scene) > 0)
    for (const char* of : {"_harmonic_", "_phase_"})
      for (const auto& name : known)
        if (name.ends_with(fmt::format("{}{}", of, cycle.returns))) told.push_back(name);
  return told;
}

/// The motion over one period.
results::Table table_of(const StructureCycle& cycle) {
  std::vector<results::Column> columns = {{{"time", "s"}, cycle.time}};
  for (std::size_t c = 0; c < cycle.columns.size(); ++c)
    columns.push_back({{cycle.column_names[c], cycle.column_units[c]}, cycle.columns[c]});
  return results::rows("cycle", std::move(columns));
}

/// A small change neither grows nor dies out, within the error of the largest multiplier: an element that sticks
/// throughout keeps its offset.
bool is_marginal(const StructureCycle& cycle) {
  if (cycle.multipliers.empty()) return false;
  constexpr double rounding = 1e-13;
  const double error = cycle.multiplier_errors.front();
  return std::isfinite(error) && std::abs(std::abs(cycle.multipliers.front()) - 1) <= std::max(error, rounding);
}

results::Result result_of(const Job& job, const StructureCycle& cycle) {
  const auto& scene = job.scene();
  auto result = job.result(cycle.outcome);
  const auto add = [&](const std::string& name) {
    const auto& measure = cycle.metrics.at(name);
    result.add({name, measure.unit}, measure.value, measure.error);
  };
  std::ranges::for_each(told_metrics(scene, cycle), add);  // what a summary tells stands first
  for (const auto& [name, measure] : cycle.metrics)
    if (!result.contains(name)) add(name);
  result["stick_threshold"] = scene.task<analysis::cycles::CycleOptions>().stick_threshold;
  if (!scene.structure && !scene.plane) result["ill_conditioned_stick"] = cycle.ill_conditioned_stick;
  result["coordinate_max"] = cycle.coordinate_max;
  result["coordinate_min"] = cycle.coordinate_min;
  result["returns"] = cycle.returns;
  result.add({"multipliers"}, results::pairs(cycle.multipliers), cycle.multiplier_errors);
  const bool decided = cycle.returns > 0 && !cycle.growth && !is_marginal(cycle);
  result["stable"] = decided ? ordered_json(cycle.stable) : ordered_json();
  result["marginal"] = is_marginal(cycle);
  if (cycle.growth) result.add({"growth"}, *cycle.growth);
  if (!cycle.symmetry.empty()) result["symmetry"] = cycle.symmetry;
  result["events"] = results::events(cycle.events);
  auto& section = result["section"] = ordered_json::object();
  for (std::size_t c = 0; c < cycle.columns.size(); ++c)
    if (!cycle.columns[c].empty()) section[cycle.column_names[c]] = cycle.columns[c].front();
  section["state"] = ordered_json::object();
  for (const auto& state : scene.model.law->states())
    if (section.contains(state.name)) section["state"][state.name] = section[state.name];
  if (cycle.returns > 0) result["regime"] = fmt::format("period {}", cycle.returns);
  if (cycle.exponent) result.add({"exponent", "1/s"}, cycle.exponent->value, cycle.exponent->error);
  result.cost = {{"steps", cycle.cost.steps}, {"evaluations", cycle.cost.evaluations}, {"cycles", cycle.cost.cycles}};
  for (const auto* left_out : {&cycle.multipliers_left_out, &cycle.metrics_left_out})
    if (!left_out->empty()) result.notes.push_back(*left_out);
  if (cycle.returns > 0) result.tables = {table_of(cycle)};
  return result;
}

/// A slider under a drive that varies is a structure of one coordinate: its periodic motions are those of a structure.
void read_cycle(scene::SceneReader& reader) {
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
  if (auto table = reader.root.table("cycle")) read_cycle_table(*table, reader);
}

/// The motion that was looked for, and what is known of one without a period.
struct Found {
  StructureCycle cycle;
  IrregularMotion irregular;
};

Found find(Job& job, double drive) {
  auto& scene = job.scene();
  auto& asked = scene.task<analysis::cycles::CycleOptions>();
  asked.tolerance = job.request().tolerance.value_or(asked.tolerance);
  const auto* stepped = scene::stepped_of(scene);
  const auto with_averages = [&](StructureCycle cycle, const analysis::motion::StructureModel& model) -> Found {
    if (cycle.returns > 0 || !cycle.exponent) return {std::move(cycle), {}};
    auto irregular = analysis::cycles::irregular_motion(model, *cycle.exponent, asked.tolerance, asked.stick_threshold);
    return {std::move(cycle), std::move(irregular)};
  };
  if (!scene.structure && !stepped) {
    job.explain_model();
    job.explain("the cycle that is reached from stick, tolerance {} of every metric, at most {} cycles of transient",
                asked.tolerance, asked.max_cycles);
    analysis::motion::StructureModel from_stick{oscillators::one_slider(scene.model), {}};
    from_stick.start.kind = analysis::motion::Start::Kind::rest;
    return with_averages(analysis::cycles::find_measured_cycle(scene.model, asked), from_stick);
  }
  const analysis::cycles::StructureCycleOptions options{
      .tolerance = asked.tolerance, .stick_threshold = asked.stick_threshold, .exponent = true};
  if (stepped)
    job.explain("followed by steps from the start until it recurs, and then again by finer ones");
  else
    job.explain("structure of {} coordinates and {} contacts, followed from the start until it recurs",
                scene.structure->structure.size(), scene.structure->structure.contacts.size());
  job.explain("{}", drive > 0 ? fmt::format("section: each period of the drive, {:.9g} s", drive)
                              : "section: the maxima of the coordinate that moves most");
  if (stepped) {
    const auto cycle = analysis::cycles::find_cycle(*stepped, options);
    if (cycle.returns > 0 || !cycle.exponent) return {cycle, {}};
    return {cycle, analysis::cycles::irregular_motion(*stepped, cycle, asked.tolerance)};
  }
  job.explain("then closed by Newton's method at two tolerances or more, with derivatives exact through stick");
  return with_averages(analysis::cycles::find_cycle(*scene.structure, options), *scene.structure);
}

/// The motion through its first returns, and its power spectral density.
std::vector<results::Table> tables_of(const IrregularMotion& irregular) {
  std::vector<results::Column> motion = {{{"time", "s"}, irregular.time}},
                               spectrum = {{{"frequency", "Hz"}, irregular.frequency}};
  for (std::size_t c = 0; c < irregular.names.size(); ++c) {
    motion.push_back({{irregular.names[c], irregular.units[c]}, irregular.columns[c]});
    const auto& density = irregular.density[c];
    if (density.empty()) continue;
    spectrum.push_back({{irregular.names[c], irregular.density_units[c]}, density});
    for (const double value : density) spectrum.back().error.push_back(irregular.density_error * value);
  }
  return {results::rows("cycle", std::move(motion)), results::rows("cycle-spectrum", std::move(spectrum))};
}

/// Chaos and quasi-periodic motion are answers: until when the motion is known, and then its averages.
Status finish_irregular(Job& job, const Found& found) {
  const auto& irregular = found.irregular;
  const auto& exponent = *found.cycle.exponent;
  auto result = job.result(irregular.outcome);
  result["regime"] = irregular.regime;
  result["returns"] = 0;
  result.add({"exponent", "1/s"}, exponent.value, exponent.error);
  const bool chaotic = irregular.regime == "chaotic";
  job.say("{}: {} {}, the largest Lyapunov exponent", irregular.regime,
          chaotic ? "neighbouring motions diverge at" : "neighbouring motions stay apart, by",
          justified(exponent.value, exponent.error, "1/s"));
  if (std::isfinite(irregular.known_until)) {
    result.add({"known_until", "s", "until then two passes differ by less than a hundredth of the range"},
               irregular.known_until);
    job.say("{:<22} {:.4g} s from the start, to a hundredth of its range", "known until", irregular.known_until);
  }
  result.add({"duration", "s", "duration of the averages"}, irregular.duration);
  result.add({"mean_return", "s", "mean time between returns"}, irregular.duration / double(irregular.returns));
  job.say("averages over {:.5g} s, {} returns:", irregular.duration, irregular.returns);
  Reached reached;
  for (const auto& [name, measure] : irregular.averages) {
    result.add({name, measure.unit, measure.meaning}, measure.value, measure.error);
    reached.add(measure.value, measure.error);
    job.say("{:<22} {}", name, justified(measure.value, measure.error, measure.unit));
  }
  result["coordinate_max"] = irregular.coordinate_max;
  result["coordinate_min"] = irregular.coordinate_min;
  result.cost = {{"steps", found.cycle.cost.steps + irregular.steps}, {"cycles", found.cycle.cost.cycles}};
  result.notes.push_back(found.cycle.outcome.detail);
  result.tables = tables_of(irregular);
  job.manifest().tolerance_reached = reached.value();
  return job.finish(result, output::write_picture(job.folder(), job.scene(), irregular));
}

Status perform_cycle(Job& job) {
  auto& scene = job.scene();
  if (scene.string) return perform_string_cycle(job);
  const double drive = scene::drive_period_of(scene);
  const auto begin = std::chrono::steady_clock::now();
  const auto found = find(job, drive);
  const auto& cycle = found.cycle;
  auto& manifest = job.manifest();
  manifest.tolerance_asked = scene.task<analysis::cycles::CycleOptions>().tolerance;
  manifest.cost = {{"seconds", seconds_since(begin)},
                   {"steps", double(cycle.cost.steps)},
                   {"evaluations", double(cycle.cost.evaluations)},
                   {"cycles", double(cycle.cost.cycles)}};
  if (!found.irregular.regime.empty()) return finish_irregular(job, found);
  const auto result = result_of(job, cycle);
  if (cycle.returns == 0) return job.finish(result);

  Reached reached;
  for (const auto& name : told_metrics(scene, cycle)) {
    const auto& metric = cycle.metrics.at(name);
    reached.add(metric.value, metric.error);
    job.say("{:<22} {}", name, justified(metric.value, metric.error, metric.unit));
    if (name == "period" && drive > 0 && cycle.returns > 1)
      job.say("a period of the motion is {} of the drive", cycle.returns);
  }
  manifest.tolerance_reached = reached.value();
  if (cycle.ill_conditioned_stick)
    job.note("the lowest speed touches the stick threshold: the stick fraction jumps nearby");
  if (cycle.growth)
    job.say(
        "free oscillation, whose amplitude is that of the start: friction changes it by {:.1e} of itself in a period",
        *cycle.growth);
  if (!cycle.multipliers.empty())
    job.say("{}: largest multiplier {}",
            is_marginal(cycle) ? "marginal"
            : cycle.stable     ? "stable"
                               : "unstable",
            justified(std::abs(cycle.multipliers.front()), cycle.multiplier_errors.front(), "1"));
  for (const auto* left_out : {&cycle.multipliers_left_out, &cycle.metrics_left_out})
    if (!left_out->empty()) job.note(*left_out);
  if (cycle.symmetry == "symmetric") job.say("symmetric: half a period later all coordinates are reversed");
  if (cycle.symmetry == "twin")
    job.say("not symmetric although the drive is: its mirror image half a period later is another motion");

  return job.finish(result, output::write_picture(job.folder(), scene, cycle));
}

}  // namespace

Verb cycle_verb() {
  return {.name = "cycle",
          .help = "periodic motion, its multipliers and metrics",
          .example = "rosin cycle examples/leine-belt-block.toml",
          .operands = {scene_operand},
          .needs = model_tables({{"cycle", "stick threshold, and where the search starts", true}}),
          .options = scene_options(),
          .tables = {{"cycle", read_cycle_table}},
          .read = read_cycle,
          .perform = perform_cycle};
}

}  // namespace rosin::app::verbs
