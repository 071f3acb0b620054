/// The list of verbs, and what those that take a scene have in common.
#include "app/verbs/verbs.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>

#include "app/results/writers.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/job.hpp"
#include "core/error.hpp"

namespace rosin::app::verbs {

#define ROSIN_VERB(name) Verb name##_verb();
#include "app/verbs/list.def"
#undef ROSIN_VERB

const std::vector<Verb>& verbs() {
  static const std::vector<Verb> list = {
#define ROSIN_VERB(name) name##_verb(),
#include "app/verbs/list.def"
#undef ROSIN_VERB
  };
  return list;
}

const Verb& find_verb(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& verb : verbs()) {
    if (name == verb.name) return verb;
    known.emplace_back(verb.name);
  }
  throw InputError(fmt::format("unknown command '{}'{}", name, scene::suggestion(name, known)));
}

// ---------------------------------------------------------------- what verbs have in common

const Operand scene_operand{"SCENE", &Request::target, "scene file (TOML)"};
const Option json_option{"--json", &Request::json, "print the result as JSON, and nothing else"};
const Option quiet_option{"--quiet", &Request::quiet, "say nothing but errors"};
const Option pdf_option{"--pdf", &Request::pdf, "draw the pictures as PDF, too"};
const Option width_option{"--width", &Request::width,
                          "draw the pictures for print, so many millimetres wide: 85 for a column of a journal"};

Option out_option(std::string_view usual) {
  return {"--out", &Request::out, fmt::format("results folder; default {}", usual)};
}

Option threads_option(std::string help) { return {"--threads", &Request::threads, std::move(help)}; }

std::vector<Option> scene_options(std::vector<Option> own) {
  std::vector<Option> options = {
      {"--set", &Request::overrides, "path=value: change the scene, such as drive.speed=1e-5"},
      {"--tolerance", &Request::tolerance, "relative accuracy of every result; default 1e-8, of planes 1e-6"},
      threads_option("threads of a map or of the motions of a fit, of each process where a launcher starts several; "
                     "results do not depend on it"),
      out_option("out/<scene>/; {drive.speed} in it stands for that value of the scene"),
      json_option,
      quiet_option,
      {"--no-pictures", &Request::no_pictures, "write no pictures, only what 'rosin plot' draws them from"},
      pdf_option,
      width_option,
      {"--explain", &Request::explain, "say on standard error what is computed how, and what is skipped"},
  };
  for (const auto& format : results::writers())
    if (format.option) options.push_back({format.option, &Request::formats, format.help});
  options.insert(options.end(), own.begin(), own.end());
  return options;
}

std::vector<Need> model_tables(std::vector<Need> own) {
  std::vector<Need> needs = {{"law", "the friction law"},
                             {"oscillator", "mass, stiffness and damping of the slider"},
                             {"drive", "speed and normal load"}};
  needs.insert(needs.end(), own.begin(), own.end());
  return needs;
}

void read_tables_of_models(scene::SceneReader& reader) {
  const auto& needs = find_verb(reader.request.verb).needs;
  for (const auto& verb : verbs())
    for (const auto& [name, read] : verb.tables) {
      const bool needed =
          std::ranges::any_of(needs, [&](const auto& need) { return need.table == std::string_view(name); });
      std::optional<scene::KeysRead> only_checked;
      if (!needed && reader.scene.string) continue;  // whose [run] and [cycle] are others
      if (!needed) only_checked.emplace();
      if (auto table = reader.root.table(name)) read(*table, reader);
    }
}

// ---------------------------------------------------------------- scenes

namespace {

/// Where each key stands, by its path.
void note_places(const toml::node& node, const std::string& path, std::map<std::string, std::string>& places) {
  if (!path.empty()) places[path] = scene::place(node.source());
  if (const auto* table = node.as_table())
    for (const auto& [key, inner] : *table)
      note_places(inner, path.empty() ? std::string(key.str()) : fmt::format("{}.{}", path, key.str()), places);
}

/// What the verb has not read, but for the tables of other verbs.
void note_unread(const toml::table& document, const scene::KeysRead& read, const Verb& verb,
                 std::vector<std::string>& notes) {
  auto unread = read.unread(document);
  const auto names_a_verb = [](const std::string& table) {
    return table == "verify" || std::ranges::any_of(verbs(), [&](const auto& other) { return table == other.name; });
  };
  std::erase_if(unread, names_a_verb);
  std::erase_if(unread, [&](const std::string& path) {  // its note says why
    return std::ranges::any_of(notes, [&](const auto& note) { return note.starts_with(path + " has no effect"); });
  });
  if (unread.empty()) return;
  notes.push_back(fmt::format("{} {} no effect: '{}' does not ask for {}", fmt::join(unread, ", "),
                              unread.size() == 1 ? "has" : "have", verb.name, unread.size() == 1 ? "it" : "them"));
}

}  // namespace

scene::Scene read_scene(const Request& request) {
  const auto& verb = find_verb(request.verb);
  if (!verb.read) throw InputError(fmt::format("'{}' is a verb that takes no scene", verb.name));
  scene::Scene scene;
  scene.path = request.target;
  const toml::table document = scene::read_document(request, scene.notes);
  note_places(document, "", scene.places);
  const scene::FilesRead files;
  const scene::UnitsRead units;
  try {
    scene::SceneReader reader{
        request, document, scene::Table(document, ""), scene, std::filesystem::path(scene.path).parent_path(), {}};
    for (const char* key : {"title", "law", "oscillator", "drive", "verify"}) reader.root.find(key);
    for (const auto& other : verbs())
      for (const auto& need : other.needs) reader.root.find(need.table);
    const scene::KeysRead read;
    if (const auto* title = reader.root.find("title")) scene.title = scene::text(*title, "title");
    reader.find_smoothing();
    verb.read(reader);
    if (const auto* reduced = scene::reduced_block_of(scene))
      scene.notes.push_back(scene::reduction_note(reduced->reduction));
    reader.require_smoothing_to_matter();
    for (const auto& name : reader.reference.unused())
      scene.notes.push_back(fmt::format("{} has no effect: no number that '{}' reads refers to it", name, verb.name));
    reader.root.finish();
    note_unread(document, read, verb, scene.notes);
  } catch (const scene::PlacedError&) {
    throw;
  } catch (const InputError& error) {
    throw InputError(scene.placed(error.what()));
  }
  scene.files_read = files.texts;
  scene.units = units.written();
  scene.files_checksum = files.checksum;
  scene.resolved = scene::resolved(document);
  return scene;
}

Status execute(const Request& request) {
  const auto& verb = find_verb(request.verb);
  if (verb.without_scene) return verb.without_scene(request);
  Job job(request);
  if (!verb.spreads) job.claim_folder();  // else who does not write results needs none
  try {
    return verb.perform(job);
  } catch (const InputError& error) {  // what the scene asks turned out to be none
    throw InputError(job.scene().placed(error.what()));
  }
}

}  // namespace rosin::app::verbs
