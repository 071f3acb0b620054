/// Numbers of a scene by their paths, and the structure read with others.
#include "app/scene/family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/scene/stepped.hpp"
#include "app/scene/structure.hpp"
#include "app/scene/toml_document.hpp"
#include "app/tasks/bowing.hpp"
#include "laws/one_coefficient.hpp"
#include "oscillators/bowed_string.hpp"

namespace rosin::app::scene {

namespace {

/// Without the numbers of entries of lists, and without the mean of a signal, which goes by the signal's own name.
std::string named(const std::string& path) {
  auto kept = without_numbers(path);
  if (kept.ends_with(".mean")) kept.resize(kept.size() - 5);
  return kept;
}

/// The path of the coefficient in motion for that of both, law.mu.
std::string of_motion(const std::string& path) {
  const auto dot = path.rfind('.') + 1;
  return path.substr(dot) == laws::one_coefficient ? path.substr(0, dot) + std::string(laws::rest_and_motion.back())
                                                   : path;
}

void read_slider(SceneReader& reader) { reader.law(), reader.oscillator(); }

Scene scene_of(const Request& request, const toml::table& document, const std::filesystem::path& folder,
               const Family::Read& read) {
  Scene scene;
  scene.path = request.target;
  SceneReader reader{request, document, Table(document, ""), scene, folder, {}};
  reader.find_smoothing();
  read(reader);
  return scene;
}

}  // namespace

Family::Family(const SceneReader& like, std::string varied_by, bool as_slider)
    : Family(like, std::move(varied_by), Read(as_slider ? read_slider : read_structure_model)) {}

Family::Family(const SceneReader& like, std::string varied_by, Read read)
    : request_(like.request),
      document_(like.document),
      folder_(like.folder),
      varied_by_(std::move(varied_by)),
      read_(std::move(read)) {
  const NumbersAsked asked;
  scene_of(request_, document_, folder_, read_);
  known_ = asked.quantities;
}

std::string Family::in_full(const std::string& path) const {
  auto full = path_in_full(document_, path);
  // A signal's mean goes by the name of the signal.
  const auto* node = node_at(document_, full);
  if (node && node->is_table() && node->as_table()->contains("mean")) full += ".mean";
  return full;
}

Quantity Family::describe(const std::string& path) const {
  const std::string full = in_full(path), wanted = named(full);
  std::vector<std::string> names;
  for (const auto& quantity : known_) {
    if (named(quantity.name) == wanted) {
      auto found = quantity;
      found.name = full;
      // That it can be set shows where the path leads through the document.
      auto document = document_;
      set_number(document, full, 1);
      return found;
    }
    if (std::ranges::find(names, quantity.name) == names.end()) names.push_back(quantity.name);
  }
  throw InputError(fmt::format("'{}' is no number of this scene{}", path, suggestion(path, names)));
}

double Family::value(const std::string& path) const {
  const auto quantity = describe(path);
  const auto* node = node_at(document_, quantity.name);
  if (!node) node = node_at(document_, of_motion(quantity.name));
  if (!node) throw InputError(fmt::format("'{}' is left to its default: give it in the scene", path));
  const Reference reference(document_);
  return number(*node, quantity);
}

Scene Family::scene_with(const std::vector<std::pair<std::string, double>>& values, const Read& read) const {
  auto document = document_;
  std::string at;
  for (const auto& [path, value] : values) {
    set_number(document, in_full(path), value);
    at += fmt::format("{}{} = {:.10g}", at.empty() ? "" : ", ", path, value);
  }
  try {
    return scene_of(request_, document, folder_, read);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: at {}: {}", varied_by_, at, error.what()));
  }
}

Scene Family::with_numbers(const std::vector<std::pair<std::string, double>>& values) const {
  return scene_with(values, read_);
}

analysis::motion::StructureModel Family::with(const std::vector<std::pair<std::string, double>>& values) const {
  return *with_numbers(values).structure;
}

oscillators::BowedStringModel Family::string_with(const std::vector<std::pair<std::string, double>>& values) const {
  return with_numbers(values).string->model;
}

oscillators::Model Family::slider_with(const std::vector<std::pair<std::string, double>>& values) const {
  return with_numbers(values).model;
}

analysis::motion::SteppedOscillator Family::stepped_with(
    const std::vector<std::pair<std::string, double>>& values) const {
  return *stepped_of(scene_with(values, [&](SceneReader& reader) { read_(reader), read_stepped(reader); }));
}

}  // namespace rosin::app::scene
