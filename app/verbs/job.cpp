/// The scene of a verb, its summary, and its results folder.
#include "app/verbs/job.hpp"

#include <fmt/ranges.h>

#include <map>
#include <set>

#include "app/output/digits.hpp"
#include "app/output/document.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/report/verdicts.hpp"
#include "app/results/writers.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/stopping.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::verbs {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {
/// Of the scene that is being computed in this thread.
const scene::WrittenUnits*& units_in_use() {
  static thread_local const scene::WrittenUnits* units = nullptr;
  return units;
}
}  // namespace

scene::WrittenUnit written_unit(std::string_view si) {
  if (const auto* units = units_in_use())
    if (const auto found = units->find(si); found != units->end()) return found->second;
  return {std::string(si), 1};
}

std::string justified(double value, double error, std::string_view si) {
  const auto unit = written_unit(si);
  value /= unit.factor, error /= unit.factor;
  const auto suffix = unit.behind();
  if (!std::isfinite(value)) return "none";
  if (std::isinf(error)) return fmt::format("{:.6g}{}, of unknown error", value, suffix);
  if (!(error > 0)) return fmt::format("{:.10g}{}", value, suffix);
  return fmt::format("{} ± {:.0e}{}", output::digits_by_error(value, error), error, suffix);
}

std::string justified_above_zero(double value, double error, std::string_view si) {
  if (!(value >= 0 && std::isfinite(error) && error > value)) return justified(value, error, si);
  const auto unit = written_unit(si);
  return fmt::format("0 … {:.2g}{}", (value + error) / unit.factor, unit.behind());
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

fs::path results_folder(const Request& request) {
  if (request.out.find('{') != std::string::npos) {
    std::vector<std::string> notes;  // known to whoever reads the scene
    const auto document = scene::read_document(request, notes);
    try {
      return scene::filled_in(request.out, document);
    } catch (const InputError& error) {
      throw InputError(fmt::format("--out: {}", error.what()));
    }
  }
  if (!request.out.empty()) return request.out;
  const fs::path scene = request.target;
  const auto stem = scene.stem();
  return "out" / (stem == "." || stem == ".." ? scene.filename() : stem);  // "...toml" would be the folder above
}

Job::Job(const Request& request)
    : request_(request),
      scene_(read_scene(request)),
      folder_(results_folder(request)),
      label_(request.design ? "design" : request.verb) {
  for (const auto& [option, given] : {std::pair{"--pdf", request.pdf}, {"--width", request.width.has_value()}})
    if (request.no_pictures && given)
      throw InputError(fmt::format("{} has no effect beside --no-pictures: leave one out", option));
  std::error_code problem;
  fs::create_directories(folder_, problem);
  if (problem) throw InputError(fmt::format("--out {}: cannot be made: {}", folder_.string(), problem.message()));
  for (const auto& text : scene_.notes) note(text);
  for (const auto& text : scene_.files_read) explain("{}", text);
  manifest_.verb = request.verb;
  manifest_.overrides = request.overrides;
  units_before_ = std::exchange(units_in_use(), &scene_.units);
}

Job::~Job() {
  units_in_use() = units_before_;
  std::error_code unused;
  if (!staging_.empty()) fs::remove_all(staging_, unused);
}

const fs::path& Job::folder() {
  if (staging_.empty()) {
    staging_ = folder_ / fmt::format(".{}.new", request_.verb);
    std::error_code problem;
    fs::remove_all(staging_, problem);  // of a process that was killed
    if (!problem) fs::create_directory(staging_, problem);
    if (problem) throw InputError(fmt::format("--out {}: cannot be made: {}", staging_.string(), problem.message()));
  }
  return staging_;
}

void Job::results_of(std::string verb) {
  manifest_.verb = verb;
  label_ = std::move(verb);
}

void Job::note(std::string_view text) const {
  if (!request_.quiet) tell("note: {}\n", text);
}

void Job::explain_model() const {
  if (!request_.explain) return;
  const auto& model = scene_.model;
  const auto& law = *model.law;
  std::vector<std::string> states;
  for (const auto& state : law.states())
    states.push_back(state.name + (state.scale == Scale::log ? " (as its logarithm)" : ""));
  explain("law '{}': {}", law.card().name,
          states.empty()      ? std::string("no states")
          : model.lambda == 0 ? std::string("lambda = 0, so its states are in equilibrium: a friction curve")
                              : fmt::format("states {}", fmt::join(states, ", ")));
  if (!law.approximation().empty()) explain("approximation: {}", law.approximation());
  explain("contact: {}", law.has_slip_rate()
                             ? "the friction coefficient is an unknown, because the slip rate is explicit"
                         : law.set_valued() ? "sticks exactly; switches between stick and slip are located events"
                                            : "friction follows from slip rate and states");
  explain("contact stiffness: {}", !model.contact_stiffness.present() ? "none, the contact is rigid"
                                   : model.contact_stiffness.damped() ? "a spring and a damper in series with the law"
                                                                      : "a spring in series with the law");
  if (model.load_memory > 0)
    explain("load memory: {}", model.drive.normal_load.constant()
                                   ? "without effect, because the normal load is constant"
                                   : "the states answer to the rate of the normal load");
  if (model.slider.mass == 0) explain("slider without mass: inertia is left out");
}

namespace {

constexpr std::uintmax_t largest_manifest = 100'000'000, largest_script = 10'000'000;  // bytes

std::string checksum_of(const fs::path& script) {
  return fmt::format("{:016x}", checksum(read_found(script, largest_script)));
}

/// A manifest that is there and can be read; else an empty document, and why it cannot.
struct FoundManifest {
  ordered_json document = ordered_json::object();
  std::string problem = {};
};
FoundManifest read_manifest(const fs::path& path) {
  try {
    if (!fs::exists(fs::symlink_status(path))) return {};
    return {output::parse_document(path.string(), read_found(path, largest_manifest))};
  } catch (const InputError& error) {
    return {.problem = error.what()};
  }
}

/// The files of a manifest that are of its folder.
std::vector<std::string> files_of(const ordered_json& manifest) {
  std::vector<std::string> names;
  if (const auto files = manifest.find("files"); files != manifest.end() && files->is_array())
    for (const auto& file : *files)
      if (file.is_string() && fs::path(file.get<std::string>()).filename() == file.get<std::string>())
        names.push_back(file.get<std::string>());
  return names;
}

}  // namespace

void Job::say_what_is_replaced() const {
  const auto found = read_manifest(folder_ / (label_ + ".manifest.json"));
  const auto& old = found.document;
  if (!found.problem.empty()) note(fmt::format("{}: what is replaced is not known", found.problem));
  if (old.empty()) return;
  const auto now = results::document_of(scene_, manifest_);
  const auto of = [](const ordered_json& manifest, const char* key) { return manifest.value(key, ordered_json()); };
  const auto tolerance = [&](const ordered_json& manifest) {
    const auto both = of(manifest, "tolerance");
    return both.is_object() ? of(both, "asked") : ordered_json();
  };
  const auto differs = [&](const char* key) { return of(old, key) != of(now, key); };
  std::string how;
  if (differs("overrides")) {
    how += of(old, "overrides").empty() ? " without --set" : " with";
    for (const auto& given : of(old, "overrides")) how += fmt::format(" --set {}", given.dump());
  }
  if (differs("experiment")) how += fmt::format(" of experiment {}", of(old, "experiment").dump());
  if (tolerance(old) != tolerance(now)) how += fmt::format(" to tolerance {}", tolerance(old).dump());
  if (how.empty() && differs("scene_resolved"))
    how = differs("scene") ? fmt::format(" of {}", of(old, "scene").dump()) : " of another text of the scene";
  if (how.empty()) return;
  std::string example;  // a folder for each value of what is varied
  for (const auto* overrides : {&now, &old})
    for (const auto& given : of(*overrides, "overrides"))
      if (given.is_string() && example.empty()) {
        const auto text = given.get<std::string>();
        example = fmt::format(", such as --out \"out/{{{}}}\"", text.substr(0, text.find('=')));
      }
  note(fmt::format("{} replaces a result{}; --out keeps results apart{}", (folder_ / (label_ + ".json")).string(), how,
                   example));
}

bool Job::whole_result_is_there() const {
  const auto old = read_manifest(folder_ / (label_ + ".manifest.json")).document;
  const auto outcome = old.find("outcome");
  return outcome != old.end() && *outcome == name(Outcome{}.ending);
}

/// Files of the earlier result that this one does not have go: beside new numbers they would be taken for theirs.
void Job::put_in_place() const {
  std::set<std::string> kept = {"manifest.json", "result.json"};
  for (const auto& entry : fs::directory_iterator(staging_)) kept.insert(entry.path().filename().string());
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const auto name = entry.path().filename().string();
    if (!name.ends_with(".manifest.json") || name == label_ + ".manifest.json") continue;
    for (const auto& file : files_of(read_manifest(entry.path()).document)) kept.insert(file);
  }
  for (const auto& file : files_of(read_manifest(folder_ / (label_ + ".manifest.json")).document))
    if (!kept.contains(file) && fs::is_regular_file(fs::symlink_status(folder_ / file))) fs::remove(folder_ / file);
  for (const auto& entry : fs::directory_iterator(staging_))
    fs::rename(entry.path(), folder_ / entry.path().filename());
}

void draw_pictures(const Request& request, const fs::path& folder, results::Manifest& manifest) {
  std::vector<std::string> scripts;
  for (const auto& file : manifest.files)
    if (fs::path(file).extension() == ".gp") {
      scripts.push_back(file);
      manifest.scripts[file] = checksum_of(folder / file);
    }
  if (request.no_pictures) return;
  const auto drawn = output::draw(folder, scripts, {request.pdf, request.width.value_or(0)});
  if (!request.quiet)
    for (const auto& problem : drawn.problems) tell("note: {}\n", problem);
  manifest.files.insert(manifest.files.end(), drawn.files.begin(), drawn.files.end());
}

void write_results(const fs::path& folder, const std::string& label, const std::string& document,
                   const std::string& manifest) {
  for (const auto& [name, content] : {std::pair{label + ".manifest.json", &manifest},
                                      {"manifest.json", &manifest},
                                      {label + ".json", &document},
                                      {"result.json", &document}})
    write_whole(folder / name, *content);
}

Status Job::finish(const results::Result& result, std::vector<std::string> files) {
  results_are_due();
  const auto& outcome = result.outcome;
  report::Result told{label_, result.document(), results::document_of(scene_, manifest_), {}};
  told.document["verdict"] = report::verdict_of(told);
  const auto document = results::text(told.document);
  manifest_.files = results::write_tables(folder(), result, request_);
  manifest_.files.insert(manifest_.files.end(), files.begin(), files.end());
  const bool failed = !outcome.complete() && manifest_.files.empty();
  draw_pictures(request_, folder(), manifest_);
  manifest_.files.push_back(label_ + ".json");
  manifest_.outcome = outcome;
  const bool keeps = failed && whole_result_is_there();
  if (!keeps) {
    say_what_is_replaced();
    write_results(staging_, label_, document, results::to_json(scene_, manifest_));
    put_in_place();
  }
  if (request_.json) write_output(document);
  if (!outcome.complete() && !request_.quiet)
    tell("{}: {}{}{}\n", scene_.path, name(outcome.ending), outcome.detail.empty() ? "" : ": ", outcome.detail);
  if (keeps) {
    note(fmt::format("{} is of an earlier computation, and is left alone", (folder_ / (label_ + ".json")).string()));
    return status_of(outcome);
  }
  say("Results: {}", (folder_ / "").string());
  return status_of(outcome);
}

Scripts scripts_of(const fs::path& folder) {
  std::map<std::string, std::set<std::string>> known;
  std::vector<std::string> there;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto name = entry.path().filename().string();
    if (name.ends_with(".gp")) there.push_back(name);
    if (!name.ends_with("manifest.json")) continue;
    const auto manifest = read_manifest(entry.path()).document;
    if (const auto scripts = manifest.find("scripts"); scripts != manifest.end() && scripts->is_object())
      for (const auto& [script, sum] : scripts->items())
        if (sum.is_string()) known[script].insert(sum.get<std::string>());
  }
  std::ranges::sort(there);
  Scripts scripts;
  for (const auto& script : there) {
    const bool regular = fs::is_regular_file(fs::symlink_status(folder / script));
    (regular && known[script].contains(checksum_of(folder / script)) ? scripts.ours : scripts.foreign)
        .push_back(script);
  }
  return scripts;
}

}  // namespace rosin::app::verbs
