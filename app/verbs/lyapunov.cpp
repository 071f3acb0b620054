/// The verb lyapunov: the rates at which neighbouring motions part.
#include "analysis/cycles/lyapunov.hpp"

#include <chrono>
#include <cmath>

#include "analysis/cycles/stepped_exponent.hpp"
#include "analysis/strings/string_exponent.hpp"
#include "app/output/pictures.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/string.hpp"
#include "app/scene/structure.hpp"
#include "app/tasks/bowing.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using analysis::cycles::LyapunovSpectrum;
using nlohmann::ordered_json;

namespace {

constexpr const char* meaning = "duration of the average (s), or tolerance of the largest exponent (1/s)";

void read_lyapunov_table(scene::Table table, scene::SceneReader& reader) {
  auto& lyapunov = reader.scene.task<analysis::cycles::LyapunovOptions>();
  table.expect({"duration", "transient", "tolerance"});
  table.read("duration", lyapunov.duration, {"", "s", {1e-12, 1e15}, "duration of the average"});
  table.read("transient", lyapunov.transient, {"", "s", {0, 1e15}, "duration that is left out before the average"});
  table.read("tolerance", lyapunov.tolerance, {"", "1/s", {1e-15, 1e15}, "standard error of the largest exponent"});
  if (!table.find("duration") && !table.find("tolerance"))
    scene::fail(table.source(), "[lyapunov] has neither 'duration' nor 'tolerance' ({})", meaning);
  table.finish();
}

void read_lyapunov(scene::SceneReader& reader) {
  reader.need("lyapunov", meaning);
  reader.law();
  reader.oscillator();
  if (reader.scene.string) {
    scene::read_string_cycle(reader);
  } else if (!scene::read_stepped(reader)) {
    scene::read_structure_model(reader);
    scene::located(reader.root.find("drive")->source(), [&] { common_period(reader.scene.structure->structure); });
  }
  read_tables_of_models(reader);
}

results::Result result_of(const Job& job, const LyapunovSpectrum& spectrum) {
  auto result = job.result(spectrum.outcome);
  result["from"] = spectrum.from;
  auto exponents = ordered_json::array(), errors = ordered_json::array(), trivial = ordered_json::array();
  for (std::size_t i = 0; i < spectrum.exponents.size(); ++i) {
    const auto& exponent = spectrum.exponents[i];
    exponents.push_back(std::isinf(exponent.value) ? ordered_json("-inf") : ordered_json(exponent.value));
    errors.push_back(exponent.error);
    if (exponent.trivial) trivial.push_back(i);
  }
  result["standard_error"] = errors;
  result.add({"exponents", "1/s"}, std::move(exponents), std::move(errors));
  result["trivial"] = std::move(trivial);
  result["clock_exponents"] = std::vector<double>(std::size_t(spectrum.clocks), 0.0);
  result.add({"sum", "1/s"}, spectrum.sum);
  result.add({"divergence", "1/s"}, spectrum.divergence);
  result.add({"duration", "s"}, spectrum.duration);
  result.add({"transient", "s"}, spectrum.transient);
  result["switches"] = spectrum.switches;
  result["stick_fraction"] = spectrum.stick_fraction;
  if (spectrum.from == "cycle") result["returns"] = spectrum.cycle.returns;
  result.cost = {{"steps", spectrum.cost.steps}, {"evaluations", spectrum.cost.evaluations}};
  if (spectrum.course.empty() || spectrum.time.size() < 2) return result;
  std::vector<results::Column> columns = {{{"time", "s"}, spectrum.time}};
  const bool is_cycle = spectrum.from == "cycle";
  for (std::size_t c = 0; c < spectrum.course.size(); ++c)
    columns.push_back({{fmt::format("{}_{}", is_cycle ? "log_growth" : "exponent", c + 1), is_cycle ? "1" : "1/s"},
                       spectrum.course[c]});
  result.tables = {results::rows("lyapunov", std::move(columns))};
  return result;
}

Status perform_lyapunov(Job& job) {
  auto& scene = job.scene();
  auto options = scene.task<analysis::cycles::LyapunovOptions>();
  options.accuracy = job.request().tolerance.value_or(options.accuracy);
  const auto* stepped = scene::stepped_of(scene);
  if (stepped || scene.string) {
    job.explain("two neighbouring motions by steps, whose difference is scaled back time and again; errors by blocks");
    scene.notes.emplace_back("of a motion by steps the largest exponent alone is computed: sum and divergence are not");
  } else {
    job.explain("the periodic motion first: its exponents are ln|multiplier| over the period");
    job.explain("else disturbances carried along the motion, orthonormalised after each step, errors by blocks");
  }
  const auto begin = std::chrono::steady_clock::now();
  auto spectrum = [&] {
    Progress progress(job.request().quiet);
    if (progress.visible()) options.progress = [&](double part) { progress.show_pass(part); };
    if (scene.string) return analysis::strings::lyapunov_spectrum(scene.string->model, options);
    return stepped ? analysis::cycles::lyapunov_spectrum(*stepped, options)
                   : analysis::cycles::lyapunov_spectrum(*scene.structure, options);
  }();
  spectrum.outcome = why_stopped(spectrum.outcome);
  if (!spectrum.levelled)
    scene.notes.push_back(
        "the standard error still grows with the length of blocks: it is a lower bound; give lyapunov.duration more");
  auto& manifest = job.manifest();
  manifest.tolerance_asked = options.accuracy;
  manifest.cost = {{"seconds", seconds_since(begin)},
                   {"steps", double(spectrum.cost.steps)},
                   {"evaluations", double(spectrum.cost.evaluations)}};
  if (spectrum.from == "cycle")
    job.say("periodic motion, {:.9g} s: from its multipliers", spectrum.duration);
  else if (spectrum.from == "steady")
    job.say("the motion settles on steady sliding: from its eigenvalues");
  else
    job.say("average over {:.9g} s, after {:.9g} s", spectrum.duration, spectrum.transient);
  Reached reached;
  for (std::size_t i = 0; i < spectrum.exponents.size(); ++i) {
    const auto& exponent = spectrum.exponents[i];
    if (std::isinf(exponent.value)) {
      job.say("exponent {}             -inf: forgotten", i + 1);
      continue;
    }
    reached.add(exponent.value, exponent.error);
    job.say("exponent {}             {}{}", i + 1, justified(exponent.value, exponent.error, "1/s"),
            exponent.trivial ? ", along the flow" : "");
  }
  manifest.tolerance_reached = reached.value();
  if (!spectrum.levelled) job.note(scene.notes.back());

  const auto result = result_of(job, spectrum);
  return job.finish(result, result.tables.empty() ? std::vector<std::string>()
                                                  : output::write_picture(job.folder(), scene, spectrum));
}

}  // namespace

Verb lyapunov_verb() {
  return {.name = "lyapunov",
          .help = "Lyapunov exponents: how fast neighbouring motions part",
          .example = "rosin lyapunov examples/belt-chaos.toml",
          .operands = {scene_operand},
          .needs = model_tables({{"lyapunov", meaning}}),
          .options = scene_options(),
          .tables = {{"lyapunov", read_lyapunov_table}},
          .read = read_lyapunov,
          .perform = perform_lyapunov};
}

}  // namespace rosin::app::verbs
