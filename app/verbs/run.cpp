/// The verb run: the motion from a start.
#include "app/verbs/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/last_oscillation.hpp"
#include "analysis/motion/plane_run.hpp"
#include "analysis/motion/spectrum.hpp"
#include "analysis/motion/stepped_run.hpp"
#include "analysis/motion/structure_run.hpp"
#include "app/output/pictures.hpp"
#include "app/results/events.hpp"
#include "app/scene/oscillator.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/start.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/string.hpp"
#include "app/scene/structure.hpp"
#include "app/tasks/bowing.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/verb.hpp"
#include "core/fourier.hpp"
#include "oscillators/block.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

/// A ramp has no end of its own: it must stay in range for as long as the run lasts.
void check_ramps(scene::SceneReader& reader) {
  const auto& drive = reader.scene.model.drive;
  for (const auto& [signal, name] : {std::pair{&drive.speed, "speed"}, std::pair{&drive.normal_load, "normal_load"},
                                     std::pair{&drive.force, "force"}}) {
    const auto quantity = scene::mechanical(std::string("drive.") + name);
    if (!quantity.range.contains(signal->value(reader.scene.task<analysis::motion::RunOptions>().duration)))
      scene::fail(reader.document.at_path(quantity.name).node()->source(), "{} leaves {} ({}, {}) before run.duration",
                  quantity.name, text(quantity.range), quantity.meaning, quantity.unit);
  }
}

using SpectrumTask = std::optional<analysis::motion::SpectrumOptions>;  // of scenes that ask for one

void read_spectrum(scene::Table table, scene::SceneReader& reader) {
  auto& spectrum = reader.scene.task<SpectrumTask>().emplace();
  table.expect({"columns", "from", "window", "segment", "lines"});
  if (const auto* columns = table.find("columns")) spectrum.columns = scene::texts(*columns, table.path("columns"));
  table.read("from", spectrum.from, {"", "s", {0, 1e15}, "motion before it is left out"});
  table.read("segment", spectrum.segment, {"", "s", {1e-15, 1e15}, "length of the parts of a spectrogram"});
  table.read("lines", spectrum.lines, 0, 1000, "sinusoids told of each column");
  if (const auto* window = table.find("window"))
    spectrum.window = scene::choice(*window, table.path("window"), window_names());
  table.finish();
}

void read_run_table(scene::Table table, scene::SceneReader& reader) {
  auto& run = reader.scene.task<analysis::motion::RunOptions>();
  auto& plane = reader.scene.plane;
  table.expect({"duration", "times", "samples", "start", "spectrum"});
  const Quantity time{table.path("times"), "s", {0, 1e15}, "time of a sample"};
  const auto* times = table.find("times");
  if (times) {
    run.times = scene::numbers(*times, time);
    if (run.times.empty()) scene::fail(times->source(), "run.times is empty");
    if (std::ranges::adjacent_find(run.times, std::greater_equal{}) != run.times.end())
      scene::fail(times->source(), "run.times must ascend");
    run.duration = run.times.back();
  } else if (reader.needs("run")) {
    table.required("duration", "s");
  }
  table.read("duration", run.duration, {"", "s", {1e-15, 1e15}, "time that is computed"});
  if (times && run.times.back() > run.duration)
    scene::fail(times->source(), "run.times ends at {} s, after run.duration = {} s", run.times.back(), run.duration);
  table.read("samples", run.samples, 1, scene::most_points, "equal intervals of the record");
  if (const auto* start = table.find("start")) read_start_of_run(*start, table.path("start"), reader.scene);
  if (const auto* spectrum = table.find("spectrum")) {
    if (times) scene::fail(spectrum->source(), "run.spectrum needs equal intervals: give run.samples, not run.times");
    read_spectrum(scene::Table(*spectrum, table.path("spectrum")), reader);
  }
  table.finish();
  if (reader.needs("run") && !plane) check_ramps(reader);
}

}  // namespace

void read_solver(scene::Table table, scene::SceneReader& reader) {
  auto& run = reader.scene.task<analysis::motion::RunOptions>();
  scene::read_stepping(table, reader);
  const auto* type = table.find("type");
  if (type) {
    auto known = analysis::motion::solver_names();
    known.emplace_back("lanes");
    run.solver = scene::choice(*type, table.path("type"), known);
    if (run.solver == "lanes")
      scene::fail(type->source(), "solver.type = 'lanes' is that of maps and not to be chosen; use one of {}",
                  fmt::join(analysis::motion::solver_names(), ", "));
  }
  // Keys of the force algorithms, and the algorithms that each means something to.
  auto& algorithm = run.algorithm;
  const auto meant = [&](std::string_view key, std::string_view for_these) {
    const auto* node = table.find(key);
    if (node && (" " + std::string(for_these) + " ").find(" " + run.solver + " ") == std::string::npos)
      scene::fail(node->source(), "{} has no meaning for solver '{}', only for {}", table.path(key), run.solver,
                  for_these);
    return node;
  };
  const auto flag = [&](std::string_view key, bool& target, std::string_view for_these) {
    if (const auto* node = meant(key, for_these)) {
      if (!node->is_boolean()) scene::wrong_kind(*node, table.path(key), "true or false");
      target = *node->value<bool>();
    }
  };
  const auto value = [&](std::string_view key, double& target, Quantity quantity, std::string_view for_these) {
    if (meant(key, for_these)) table.read(key, target, std::move(quantity));
  };
  constexpr std::string_view sticking = "o-fbfm r-fbfm aabg-sdfm tr-sdfm", sprung = "aabg-sdfm tr-sdfm";
  if (!run.stepping)
    value("step", algorithm.step, {"", "s", {1e-15, 1e15}, "step of time"},
          "cfm o-fbfm r-fbfm aabg-sdfm tr-sdfm vlfm svlfm meijaard");
  if (const auto* node = meant("stepping", "cfm o-fbfm r-fbfm aabg-sdfm tr-sdfm"))
    algorithm.closed_form =
        scene::choice(*node, table.path("stepping"), {"runge-kutta", "closed-form"}) == "closed-form";
  flag("micro_slip", algorithm.micro_slip, sticking);
  value("window", algorithm.window, {"", "m/s", {1e-15, 1e4}, "speed of slip below which the mass counts as at rest"},
        "o-fbfm");
  value("adherence_stiffness", algorithm.adherence_stiffness, {"", "N/m", {1e-12, 1e18}, "spring of stick"}, sprung);
  value("adherence_damping", algorithm.adherence_damping, {"", "1", {1e-3, 1e6}, "damping ratio of stick"}, sprung);
  flag("original", algorithm.original, "aabg-sdfm");
  flag("refusal", algorithm.refusal, "tr-sdfm");
  if (const auto* node = meant("restart", "tr-sdfm"))
    algorithm.restart_before = scene::choice(*node, table.path("restart"), {"before", "at"}) == "before";
  value("transition_speed", algorithm.transition_speed,
        {"", "m/s", {1e-15, 1e4}, "speed of slip below which friction falls to zero"}, "vlfm svlfm");
  table.find("smoothing");  // of every verb
  table.finish();
}

namespace {

void read_run(scene::SceneReader& reader) {
  reader.law();
  reader.oscillator();
  if (reader.scene.string) return scene::read_string(reader);
  if (!reader.scene.plane && !reader.scene.structure) {
    reader.need("run", "duration and start");
    return read_tables_of_models(reader);
  }
  read_run_table(scene::Table(reader.need("run", "duration and start"), "run"), reader);
  if (auto solver = reader.root.table("solver")) read_solver(*solver, reader);
  scene::require_stepping_of_block(reader.scene);
}

using analysis::motion::SlipEvents;

/// A column of the catalogue of slip events.
struct EventColumn {
  const char *name, *unit;
  std::vector<double> SlipEvents::*values;
  double SlipEvents::Errors::*error;
};
constexpr EventColumn event_columns[] = {
    {"contact", "1", &SlipEvents::contact, nullptr},
    {"onset", "s", &SlipEvents::onset, &SlipEvents::Errors::onset},
    {"duration", "s", &SlipEvents::duration, &SlipEvents::Errors::duration},
    {"force_drop", "N", &SlipEvents::force_drop, &SlipEvents::Errors::force_drop},
    {"friction_drop", "1", &SlipEvents::friction_drop, &SlipEvents::Errors::friction_drop},
    {"slip", "m", &SlipEvents::slip, &SlipEvents::Errors::slip},
    {"peak_slip_rate", "m/s", &SlipEvents::peak_slip_rate, &SlipEvents::Errors::peak_slip_rate},
    {"recurrence", "s", &SlipEvents::recurrence, &SlipEvents::Errors::recurrence}};

/// Stick–slip: two slips or more.
bool lists_slips(const analysis::motion::Run& run) { return run.slips.onset.size() > 1; }

/// The catalogue as a table.
results::Table table_of(const SlipEvents& events) {
  std::vector<results::Column> columns;
  for (const auto& [name, unit, values, error] : event_columns)
    if (!(events.*values).empty())
      columns.push_back(
          {{name, unit}, events.*values, error ? std::vector{events.error.*error} : std::vector<double>()});
  return results::rows("stick-slip", std::move(columns));
}

/// What the events are on average.
void tell_of(const Job& job, const results::Table& events) {
  job.say("{} slip events, on average", events.dimensions.front().length);
  for (const auto& column : events.columns) {
    std::vector<double> known;
    std::ranges::copy_if(column.numbers(), std::back_inserter(known),
                         [](double value) { return std::isfinite(value); });
    if (column.error.empty() || column.of.name == "onset" || known.empty()) continue;
    const auto [low, high] = std::ranges::minmax(known);
    const double mean = std::accumulate(known.begin(), known.end(), 0.0) / double(known.size());
    const double error = column.error.front(), factor = written_unit(column.of.unit).factor;
    job.say("  {:<22} {}{}", column.of.name, justified(mean, error, column.of.unit),
            high - low > 2 * error ? fmt::format(", {:.6g} to {:.6g}", low / factor, high / factor) : "");
  }
}

void add_spectrum(const analysis::motion::MotionSpectrum& spectrum, results::Result& result) {
  auto columns = ordered_json::object(), lines = columns, parts = columns;
  for (std::size_t c = 0; c < spectrum.names.size(); ++c) {
    const auto& name = spectrum.names[c];
    columns[name] = spectrum.amplitude[c];
    lines[name] = ordered_json::array();
    for (const auto& line : spectrum.lines[c]) {
      results::Object sinusoid;
      sinusoid.add({"frequency", "Hz"}, line.frequency, line.frequency_error);
      sinusoid.add({"amplitude", spectrum.units[c]}, line.amplitude, line.amplitude_error);
      lines[name].push_back(sinusoid.entry());
    }
    if (!spectrum.part_amplitude.empty()) parts[name] = spectrum.part_amplitude[c];
  }
  result["spectrum"] = {{"frequency", spectrum.frequency},
                        {"columns", std::move(columns)},
                        {"resolution", spectrum.resolution},
                        {"lines", std::move(lines)}};
  if (!spectrum.part_time.empty())
    result["spectrogram"] = {
        {"time", spectrum.part_time}, {"frequency", spectrum.part_frequency}, {"columns", std::move(parts)}};
}

void say_spectrum(Job& job, const analysis::motion::MotionSpectrum& spectrum) {
  constexpr std::size_t told = 3;
  job.say("spectrum with a resolution of {:.4g} Hz; largest sinusoids:", spectrum.resolution);
  for (std::size_t c = 0; c < spectrum.names.size(); ++c)
    for (std::size_t i = 0; i < std::min(told, spectrum.lines[c].size()); ++i) {
      const auto& line = spectrum.lines[c][i];
      job.say("  {:<22} {} at {}", spectrum.names[c],
              justified(line.amplitude, line.amplitude_error, spectrum.units[c]),
              justified(line.frequency, line.frequency_error, "Hz"));
    }
}

results::Table table_of(const analysis::motion::Run& run) {
  std::vector<results::Column> columns = {{{"time", "s"}, run.time}};
  for (std::size_t c = 0; c < run.columns.size(); ++c)
    columns.push_back({{run.column_names[c], run.column_units[c]},
                       run.columns[c],
                       c < run.column_error.size() ? std::vector{run.column_error[c]} : std::vector<double>()});
  return results::rows("run", std::move(columns));
}

results::Result result_of(const Job& job, const analysis::motion::Run& run) {
  auto result = job.result(run.outcome);
  auto table = table_of(run);
  result.add_record(table);
  for (const auto& [name, of_metric] : run.metric_error) result.describe({name, ""}, of_metric);
  result["events"] = results::events(run.events, job.scene().plane != nullptr);
  result["metrics"] = run.metrics;
  if (lists_slips(run)) {
    auto slips = table_of(run.slips);
    result["stick_slip"] = results::lists_of(slips);
    result.tables.push_back(std::move(slips));
  }
  if (run.outcome.complete() || run.time.size() > 1) result.tables.insert(result.tables.begin(), std::move(table));
  result["solver"] = run.solver;
  result.cost = {{"steps", run.cost.steps}, {"evaluations", run.cost.evaluations}};
  return result;
}

/// A column of one station of a block, which has dozens.
bool is_of_station(const std::string& name) { return name.starts_with("pressure_") || name.starts_with("slip_rate_"); }

/// Of contacts that open and close, whose wear is what one asks of them.
void say_wear(const Job& job, const oscillators::Structure& structure, const analysis::motion::Run& run) {
  const auto& contacts = structure.contacts;
  for (std::size_t j = 0; j < contacts.size(); ++j) {
    const auto name = contacts.size() > 1 ? fmt::format("wear_work_rate_{}", j + 1) : "wear_work_rate";
    const auto found = run.metrics.find(name), error = run.metric_error.find(name);
    if (contacts[j].normal.size() == 0 || found == run.metrics.end()) continue;
    job.say("  {:<22} {}", name, justified(found->second, error == run.metric_error.end() ? 0 : error->second, "W"));
  }
}

/// Of the second half of a motion by steps, each with its difference to half the step.
void say_averages(Job& job, const std::map<std::string, double>& metrics) {
  job.say("second half of the run:");
  const auto say = [&](const char* name, const char* meaning, const char* unit) {
    const auto found = metrics.find(name);
    if (found == metrics.end()) return;
    const auto error = metrics.find(std::string(name) + "_error");
    job.say("  {:<22} {}", meaning, justified(found->second, error == metrics.end() ? 0 : error->second, unit));
  };
  say("apparent_friction", "friction over load", "1");
  say("stick_fraction", "part that sticks", "1");
  say("full_stick_fraction", "time of full stick", "1");
  say("open_fraction", "part that is open", "1");
  say("pressure_min", "lowest pressure", "Pa");
}

Status perform_run(Job& job) {
  if (job.scene().string) return perform_string_run(job);
  auto& scene = job.scene();
  auto& asked = scene.task<analysis::motion::RunOptions>();
  asked.tolerance = job.request().tolerance.value_or(asked.tolerance);
  job.explain_model();
  job.explain("solver: {}; tolerance {}; every column comes with its error", asked.solver, asked.tolerance);
  const auto begin = std::chrono::steady_clock::now();
  auto run = [&] {
    Progress progress(job.request().quiet);
    auto how = asked;
    if (progress.visible()) how.progress = [&](double part) { progress.show_pass(part); };
    return run_of(scene, how);
  }();
  run.outcome = why_stopped(run.outcome);
  job.explain("solver used: {}, {} steps; {}", run.solver, run.cost.steps, run.why);
  if (!run.remark.empty()) job.note(run.remark);

  auto result = result_of(job, run);
  Reached reached;
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    double largest = 0;
    for (const double value : run.columns[c]) largest = std::max(largest, std::abs(value));
    if (c < run.column_error.size()) reached.add(largest, run.column_error[c]);
  }
  auto& manifest = job.manifest();
  manifest.tolerance_asked = asked.tolerance;
  manifest.tolerance_reached = reached.value();
  manifest.cost = {{"seconds", seconds_since(begin)},
                   {"steps", double(run.cost.steps)},
                   {"evaluations", double(run.cost.evaluations)}};
  job.say("{} samples over {:.6g} s, {} events, solver {}", run.time.size(), run.time.empty() ? 0 : run.time.back(),
          run.events.size(), run.solver);
  for (std::size_t c = 0; c < run.columns.size(); ++c)
    if (!run.columns[c].empty() && !(scene.block && is_of_station(run.column_names[c])))
      job.say(
          "  {:<22} ends at {}", run.column_names[c],
          justified(run.columns[c].back(), c < run.column_error.size() ? run.column_error[c] : 0, run.column_units[c]));
  if (scene.structure) say_wear(job, scene.structure->structure, run);
  if (asked.stepping && run.metrics.contains("apparent_friction")) say_averages(job, run.metrics);
  if (lists_slips(run)) tell_of(job, result.tables.back());
  if (run.time.size() < 2) return job.finish(result);
  auto files = scene.block ? output::write_block_picture(job.folder(), scene, run)
                           : output::write_picture(job.folder(), scene, run);
  if (const auto& how = scene.task<SpectrumTask>(); how && run.outcome.complete()) {
    const auto spectrum = analysis::motion::spectrum(run, *how);
    say_spectrum(job, spectrum);
    add_spectrum(spectrum, result);
    for (auto& file : output::write_picture(job.folder(), scene, spectrum)) files.push_back(std::move(file));
  }
  if (scene.block && run.oscillation && !job.request().no_pictures)
    for (auto& file : output::write_block_motion(job.folder(), scene, *run.oscillation))
      files.push_back(std::move(file));
  return job.finish(result, std::move(files));
}

}  // namespace

void read_start_of_run(const toml::node& start, const std::string& path, scene::Scene& scene) {
  if (scene.plane)
    scene::read_plane_start(start, path, *scene.plane);
  else if (scene.structure)
    scene.structure->start = scene::read_start_of_structure(start, path, scene);
  else
    scene.task<analysis::motion::RunOptions>().start = scene::read_start(start, path, *scene.model.law);
}

analysis::motion::Run run_of(const scene::Scene& scene, const analysis::motion::RunOptions& how) {
  const double stick_threshold = scene.task<analysis::cycles::CycleOptions>().stick_threshold;
  return scene.plane       ? analysis::motion::run_plane(*scene.plane, how)
         : how.stepping    ? analysis::motion::run_stepped(*scene.structure, how)
         : scene.structure ? analysis::motion::run_structure(*scene.structure, how, stick_threshold)
                           : analysis::motion::run(scene.model, how, stick_threshold);
}

Verb run_verb() {
  return {.name = "run",
          .help = "motion from a given start",
          .example = "rosin run examples/slide-hold-slide.toml --tolerance 1e-6",
          .operands = {scene_operand},
          .needs = model_tables({{"run", "duration and start"}, {"solver", "a solver by name", true}}),
          .options = scene_options(),
          .tables = {{"run", read_run_table}, {"solver", read_solver}},
          .read = read_run,
          .perform = perform_run};
}

}  // namespace rosin::app::verbs
