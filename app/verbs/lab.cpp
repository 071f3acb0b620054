/// The verb lab: an experiment as it is done in the laboratory.
#include "app/tasks/lab.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>

#include "analysis/lab/experiment.hpp"
#include "app/output/lab_picture.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/signal.hpp"
#include "app/tasks/bowing.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

/// Numbers by name of a column of the experiment's record.
std::map<std::string, double> read_columns(scene::Table table, const std::vector<std::string>& columns,
                                           std::string_view meaning) {
  std::map<std::string, double> values;
  for (const auto& column : columns) {
    std::optional<double> value;
    table.read(column, value, {"", "1", {0, 1e300}, std::string(meaning)});
    if (value) values[column] = *value;
  }
  table.finish();
  return values;
}

analysis::lab::Sensor read_sensor(scene::Table table, const std::vector<std::string>& columns) {
  analysis::lab::Sensor sensor;
  table.read("sample_rate", sensor.sample_rate, {"", "Hz", {1e-15, 1e15}, "samples per second"});
  table.read("low_pass", sensor.low_pass, {"", "Hz", {1e-15, 1e15}, "corner frequency of the pole before sampling"});
  int seed = 1;
  table.read("seed", seed, 0, scene::largest_seed, "of the noise");
  sensor.seed = static_cast<std::uint64_t>(seed);
  if (auto noise = table.table("noise")) sensor.noise = read_columns(*noise, columns, "rms of white noise, SI");
  if (const auto* given = sensor.noise.empty() ? table.find("seed") : nullptr)
    scene::fail(given->source(), "{} has no effect without noise", table.path("seed"));
  if (auto step = table.table("resolution"))
    sensor.resolution = read_columns(*step, columns, "step of the converter, SI");
  if (auto range = table.table("range")) sensor.range = read_columns(*range, columns, "largest reading, SI");
  table.finish();
  return sensor;
}

void read_settings(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  const auto& experiment = *scene.task<tasks::Lab>().experiment;
  auto& task = *scene.task<tasks::Lab>().task;
  for (const auto& setting : experiment.settings) {
    auto quantity = setting.quantity;
    const auto name = std::exchange(quantity.name, table.path(setting.quantity.name));
    const auto* node = table.find(name);
    if (!node) continue;
    scene::located(node->source(), [&] {
      if (quantity.is_list)
        task.settings.set(name, scene::numbers(*node, quantity));
      else if (setting.whole)
        task.settings.set(
            name, double(scene::count(*node, quantity.name, static_cast<int>(quantity.range.low),
                                      static_cast<int>(std::min<double>(quantity.range.high, scene::most_points)),
                                      quantity.meaning)));
      else
        task.settings.set(name, scene::number(*node, quantity));
    });
  }
  if (task.string) {
    const auto read_force = [&](const char* key) {
      const auto* file = table.find(key);
      std::optional<Signal::Table> force;
      if (file)
        scene::located(file->source(), [&] {
          force = scene::read_table_file(*file, table.path(key), "N", reader.folder);
          Signal{*force};  // refuses empty records and times that do not ascend
        });
      return force;
    };
    auto bridge = read_force("bridge_force"), nut = read_force("nut_force");
    if (bridge.has_value() != nut.has_value())
      throw InputError(fmt::format("{} is there and {} is not: friction follows from the forces at both ends",
                                   table.path(bridge ? "bridge_force" : "nut_force"),
                                   table.path(bridge ? "nut_force" : "bridge_force")));
    if (bridge) {
      task.end_forces = {std::move(*bridge), std::move(*nut)};
      for (const char* key : {"duration", "skip", "sensor"})
        if (const auto* node = table.find(key))
          scene::fail(node->source(), "{} has no effect on forces that were measured", table.path(key));
      reader.note_unread({"law", "drive.normal_load"}, "friction follows from the measured forces");
    }
    if (const auto* record = table.find("record"))
      scene::fail(record->source(), "{} is the motion of a slider; of a string give bridge_force and nut_force, in N",
                  table.path("record"));
  } else if (experiment.takes_motion) {
    if (const auto* record = table.find("record"))
      scene::located(record->source(), [&] {
        task.motion = scene::read_table_file(*record, table.path("record"), "m", reader.folder);
        Signal{*task.motion};  // refuses empty records and times that do not ascend
      });
  }
  if (auto sensor = table.table("sensor"))
    task.sensor = read_sensor(*sensor, analysis::lab::column_names(experiment, task));
  table.finish();
}

/// A structure in place of the experiment's slider, whose contacts all have the speed of the load point.
void read_machine(scene::SceneReader& reader) {
  auto& scene = reader.scene;
  auto& asked = scene.task<tasks::Lab>();
  const auto& oscillator = *reader.root.find("oscillator");
  reader.need("drive", "normal load, and what else the protocol does not set");
  if (const auto* contacts = reader.document.at_path("oscillator.contacts").as_array())
    for (const auto& contact : *contacts)
      if (const auto* speed = contact.as_table() ? contact.as_table()->get("speed") : nullptr)
        scene::fail(speed->source(),
                    "oscillator.contacts: a surface with a speed of its own is not pulled at the load point, whose "
                    "speed is drive.speed; 'rosin run' follows such a machine");
  asked.task->structure = scene.structure->structure;
  const auto& prescribed = asked.experiment->prescribed;
  const auto sets = [&](std::string_view path) { return std::ranges::find(prescribed, path) != prescribed.end(); };
  if (sets("drive.speed") && reader.document.at_path("oscillator.convective").value_or(false))
    scene::fail(reader.document.at_path("oscillator.convective").node()->source(),
                "oscillator.convective: Coriolis forces change with drive.speed, which '{}' changes; leave it out",
                asked.experiment->name);
  // Of types that take drive.force it acts on the first coordinate.
  if (sets("drive.force") && reader.document.at_path("drive.force")) asked.task->structure->force[0] = 0.0;
  scene::located(oscillator.source(), [&] { asked.experiment->require_served(*asked.task); });
}

void read_lab(scene::SceneReader& reader) {
  auto& scene = reader.scene;
  auto& asked = scene.task<tasks::Lab>();
  asked.experiment = &analysis::lab::find_experiment(reader.request.experiment);
  reader.law();
  asked.task = analysis::lab::task_for(*asked.experiment, scene.model.law);
  scene.model.slider = asked.experiment->slider;
  scene.model.drive = asked.experiment->drive;
  reader.oscillator_if_there(false);
  asked.task->model = scene.model;
  if (scene.structure) read_machine(reader);
  if (scene.string) {
    reader.need("drive", "speed and load of the bow");
    asked.task->string = scene.string->model;
    scene::located(reader.root.find("oscillator")->source(), [&] { asked.experiment->require_served(*asked.task); });
  }
  read_tables_of_models(reader);
  if (auto table = reader.root.table("lab")) read_settings(*table, reader);
  for (const auto& path : asked.experiment->prescribed)
    reader.note_unread({path}, fmt::format("{} sets it itself", asked.experiment->name));
}

results::Result result_of(const Job& job, const analysis::lab::Result& of) {
  auto result = job.result(of.outcome);
  result["experiment"] = job.scene().task<tasks::Lab>().experiment->name;
  const auto meaning = [&](const std::string& column) {  // that of the reading which is made of it
    const auto reading = std::ranges::find(of.readings, column, &analysis::lab::Reading::name);
    return reading == of.readings.end() ? std::string() : reading->meaning;
  };
  std::vector<results::Column> columns = {{{"time", "s"}, of.record.time}};
  for (std::size_t c = 0; c < of.record.columns.size(); ++c)
    columns.push_back({{of.record.names[c], of.record.units[c], meaning(of.record.names[c])}, of.record.columns[c]});
  auto record = results::rows("lab", std::move(columns));
  result.add_record(record);
  result["readings"] = result["tables"] = ordered_json::object();
  for (const auto& reading : of.readings) {
    result["readings"][reading.name] = reading.value;
    result.describe({reading.name, reading.unit, reading.meaning}, reading.error);
  }
  result.tables.push_back(std::move(record));
  for (const auto& table : of.tables) {
    std::vector<results::Column> of_table;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      result["tables"][table.name][table.columns[c]] = table.values[c];
      of_table.push_back({{table.columns[c], table.units[c], meaning(table.columns[c])}, table.values[c]});
    }
    result.tables.push_back(results::rows(fmt::format("lab-{}", table.name), std::move(of_table)));
  }
  auto& events = result["events"] = ordered_json::array();
  for (const auto& event : of.events) events.push_back({{"time", event.time}, {"kind", event.kind}});
  result["warnings"] = of.warnings;
  return result;
}

/// A reading that is yes or no has a meaning that begins so.
bool is_truth(const analysis::lab::Reading& reading) { return reading.meaning.starts_with("1 if "); }

Status perform_lab(Job& job) {
  auto& scene = job.scene();
  auto& task = *scene.task<tasks::Lab>().task;
  task.tolerance = job.request().tolerance.value_or(task.tolerance);
  job.explain_model();
  const auto begin = std::chrono::steady_clock::now();
  auto result = scene.task<tasks::Lab>().experiment->perform(task);
  result.outcome = why_stopped(result.outcome);
  for (const auto& line : result.plan) job.explain("{}", line);
  for (const auto& warning : result.warnings) job.note(warning);

  Reached reached;
  for (const auto& reading : result.readings) {
    reached.add(reading.value, reading.error);
    job.say("{:<24} {}", reading.name,
            is_truth(reading) ? (reading.value != 0 ? "yes" : "no")
                              : justified(reading.value, reading.error, reading.unit));
  }
  auto& manifest = job.manifest();
  manifest.tolerance_asked = task.tolerance;
  manifest.tolerance_reached = reached.value();
  manifest.cost = {{"seconds", seconds_since(begin)}, {"samples", double(result.record.time.size())}};
  auto whole = result_of(job, result);
  // A part of a record without readings is kept, but not in place of a whole result.
  if (!result.outcome.complete() && result.readings.empty() &&
      (result.record.time.size() < 2 || job.whole_result_is_there())) {
    whole.tables.clear();
    return job.finish(whole);
  }
  return job.finish(whole, result.panels.empty() ? std::vector<std::string>()
                                                 : output::write_lab_picture(job.folder(), scene, result));
}

}  // namespace

Verb lab_verb() {
  std::vector<std::string> experiments;
  for (const auto& experiment : analysis::lab::experiments()) experiments.emplace_back(experiment.name);
  return {.name = "lab",
          .help = "an experiment as it is done in the laboratory: its record and what is read off it",
          .example = "rosin lab velocity-step examples/lab-velocity-step.toml",
          .operands = {{"EXPERIMENT", &Request::experiment, fmt::format("{}", fmt::join(experiments, ", ")), true,
                        experiments},
                       scene_operand},
          .needs = {{"law", "the friction law"},
                    {"lab", "the protocol and its sensor", true},
                    {"oscillator", "the machine, in place of the experiment's", true},
                    {"drive", "what the protocol does not set", true}},
          .options = scene_options(),
          .read = read_lab,
          .perform = perform_lab};
}

}  // namespace rosin::app::verbs
