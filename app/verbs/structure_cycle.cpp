/// Periodic motion of a structure, or of an oscillator that is followed by steps, as a result: metrics, switches,
/// multipliers, table and picture.
#include "app/verbs/structure_cycle.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/stepped_cycle.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "app/output/files.hpp"
#include "app/output/json.hpp"
#include "app/output/pictures.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/verbs/job.hpp"

namespace rosin::app::verbs {

using analysis::cycles::StructureCycle;
using nlohmann::ordered_json;

namespace {

std::string document_of(const scene::Scene& scene, const StructureCycle& cycle) {
  auto document = output::begin(scene, "cycle", cycle.outcome);
  auto error = ordered_json::object();
  for (const auto& [name, measure] : cycle.metrics) document[name] = measure.value, error[name] = measure.error;
  document["stick_threshold"] = scene.task<analysis::cycles::CycleOptions>().stick_threshold;
  document["coordinate_max"] = cycle.coordinate_max;
  document["coordinate_min"] = cycle.coordinate_min;
  document["returns"] = cycle.returns;
  document["multipliers"] = output::pairs(cycle.multipliers);
  document["stable"] = cycle.returns > 0 ? ordered_json(cycle.stable) : ordered_json();
  if (!cycle.symmetry.empty()) document["symmetry"] = cycle.symmetry;
  auto& events = document["events"] = ordered_json::array();
  for (const auto& event : cycle.events) {
    events.push_back({{"time", event.time}, {"kind", event.kind}, {"displacement", event.displacement}});
    if (event.contact > 0) events.back()["contact"] = event.contact;
    output::add_stop(events.back(), event);
  }
  auto& section = document["section"] = ordered_json::object();
  for (std::size_t c = 0; c < cycle.columns.size(); ++c)
    if (!cycle.columns[c].empty()) section[cycle.column_names[c]] = cycle.columns[c].front();
  error["multipliers"] = cycle.multiplier_errors;
  if (cycle.exponent) document["exponent"] = cycle.exponent->value, error["exponent"] = cycle.exponent->error;
  document["error"] = std::move(error);
  document["cost"] = {
      {"steps", cycle.cost.steps}, {"evaluations", cycle.cost.evaluations}, {"cycles", cycle.cost.cycles}};
  auto notes = scene.notes;
  if (!cycle.multipliers_left_out.empty()) notes.push_back(cycle.multipliers_left_out);
  document["notes"] = notes;
  return output::text(document);
}

}  // namespace

bool is_told(std::string_view metric) {
  const bool extreme = metric.ends_with("_max") || metric.ends_with("_min");
  return metric == "period" || metric.starts_with("stick_fraction") ||
         (extreme && (metric.find("displacement") != std::string_view::npos || metric.starts_with("slip")));
}

Status perform_structure_cycle(Job& job) {
  auto& scene = job.scene();
  analysis::cycles::StructureCycleOptions options;
  options.tolerance = job.request().tolerance.value_or(options.tolerance);
  options.stick_threshold = scene.task<analysis::cycles::CycleOptions>().stick_threshold;
  options.exponent = true;
  const auto* stepped = scene::stepped_of(scene);
  const double drive = stepped ? stepped->drive_period : common_period(scene.structure->structure);
  if (stepped)
    job.explain("followed by steps from the start until it recurs, and then again by finer ones");
  else
    job.explain("structure of {} coordinates and {} contacts, followed from the start until it recurs",
                scene.structure->structure.size(), scene.structure->structure.contacts.size());
  job.explain("{}", drive > 0 ? fmt::format("section: each period of the drive, {:.9g} s", drive)
                              : "section: the maxima of the coordinate that moves most");
  if (!stepped)
    job.explain("then closed by Newton's method at two tolerances or more, with derivatives exact through stick");
  const auto begin = std::chrono::steady_clock::now();
  const auto cycle = stepped ? analysis::cycles::find_cycle(*stepped, options)
                             : analysis::cycles::find_cycle(*scene.structure, options);
  auto& manifest = job.manifest();
  manifest.tolerance_asked = options.tolerance;
  manifest.cost = {{"seconds", seconds_since(begin)},
                   {"steps", double(cycle.cost.steps)},
                   {"evaluations", double(cycle.cost.evaluations)},
                   {"cycles", double(cycle.cost.cycles)}};
  if (cycle.returns == 0) return job.finish(document_of(scene, cycle), {}, cycle.outcome);

  Reached reached;
  const auto say = [&](const std::string& name) {
    const auto& metric = cycle.metrics.at(name);
    reached.add(metric.value, metric.error);
    job.say("{:<28} {}", name, justified(metric.value, metric.error, metric.unit));
  };
  say("period");
  if (drive > 0 && cycle.returns > 1) job.say("a period of the motion is {} of the drive", cycle.returns);
  const auto is_extreme_of_coordinate = [&](std::string_view metric) {
    const auto first = stepped->channels.begin();
    return std::any_of(first, first + stepped->coordinates, [&](const auto& channel) {
      return metric == channel.name + "_max" || metric == channel.name + "_min";
    });
  };
  for (const auto& [name, measure] : cycle.metrics)
    if (name != "period" && (is_told(name) || (stepped && is_extreme_of_coordinate(name)))) say(name);
  manifest.tolerance_reached = reached.value();
  if (!cycle.multipliers.empty())
    job.say("{}: largest multiplier {}", cycle.stable ? "stable" : "unstable",
            justified(std::abs(cycle.multipliers.front()), cycle.multiplier_errors.front(), "1"));
  if (!cycle.multipliers_left_out.empty()) job.note(cycle.multipliers_left_out);
  if (cycle.symmetry == "symmetric") job.say("symmetric: half a period later all coordinates are reversed");
  if (cycle.symmetry == "twin")
    job.say("not symmetric although the drive is: its mirror image half a period later is another motion");

  std::vector<output::Column> table = {{"time (s)", cycle.time}};
  for (std::size_t c = 0; c < cycle.columns.size(); ++c)
    table.push_back({output::column_header(cycle.column_names[c], cycle.column_units[c]), cycle.columns[c]});
  output::write_csv(job.folder() / "cycle.csv", table);
  auto files = output::write_picture(job.folder(), scene, cycle);
  files.push_back("cycle.csv");
  return job.finish(document_of(scene, cycle), std::move(files), cycle.outcome);
}

}  // namespace rosin::app::verbs
