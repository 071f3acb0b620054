/// What verbs ask of a scene in common, and the places of its keys.
#include "app/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "app/scene/family.hpp"
#include "app/scene/law.hpp"
#include "app/scene/oscillator.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/structure.hpp"
#include "core/error.hpp"

namespace rosin::app::scene {

namespace {
constexpr std::string_view smoothing_path = "solver.smoothing";
}

void SceneReader::find_smoothing() {
  const auto found = document.at_path(smoothing_path);
  if (!found) return;
  Table table(*found.node(), std::string(smoothing_path));
  table.expect({"type", "width"});
  const auto names = laws::smoothing_names();
  std::vector<std::string> known(names.begin(), names.end());
  constexpr std::string_view by_regions = "multi-region", by_switch = "switch";
  known.emplace_back(by_regions);
  const auto types = fmt::format("one of {}", fmt::join(known, ", "));
  known.emplace_back(by_switch);
  const auto& type = table.required("type", types);
  const auto name = choice(type, table.path("type"), known);
  if (name == by_switch)
    fail(type.source(),
         "{} = '{}' is not available: its friction jumps at the edge of the width, where rosin locates stick and slip "
         "themselves; leave smoothing out, or use {}",
         table.path("type"), name, types);
  const auto& quantity = laws::smoothing_width();
  const double width = number(table.required("width", quantity.meaning + ", m/s"), quantity);
  if (name == by_regions)
    region_width = width;
  else
    smoothing = {laws::Smoothing::Type(std::ranges::find(names, name) - names.begin()), width};
  table.finish();
}

void SceneReader::require_smoothing_to_matter() const {
  if ((!smoothing && region_width == 0) || smooths) return;
  const auto& source = document.at_path(smoothing_path).node()->source();
  if (!scene.model.law) fail(source, "{} has no effect: the scene has no friction law", smoothing_path);
  fail(source, "{} has no effect: no law here is set-valued, '{}' is smooth as it is; leave it out", smoothing_path,
       scene.model.law->card().name);
}

void SceneReader::law() { read_law(*this, Table(need("law", "the friction law"), "law"), scene.model); }

namespace {
constexpr const char* servo_key = "servo";

/// [oscillator] with the keys that every type has.
Table oscillator_table(const toml::node& node) {
  Table table(node, "oscillator");
  for (const auto* key : Reference::keys) table.find(key);
  table.find(servo_key);
  return table;
}

void read_servo_of(SceneReader& reader, const toml::node& oscillator) {
  if (const auto* servo = oscillator.as_table()->get(servo_key)) read_servo(reader, *servo);
}
}  // namespace

void SceneReader::oscillator() {
  const auto& node = need("oscillator", "mass, stiffness and damping of the slider");
  const auto& type = oscillator_type(*this, node);
  scene.structure.reset();  // of a scene that is read again with other numbers
  type.read(*this, oscillator_table(node), true);
  type.read_drive(*this, Table(need("drive", "speed and normal load"), "drive"), true);
  read_servo_of(*this, node);
  if (!scene.plane && !scene.structure && !scene.string) read_slider_as_structure(*this);
  if (!scene.plane && !scene.structure) located(node.source(), [&] { scene.model.check(); });
  if (!scene.structure && scene.model.drive.normal_load.constant())
    note_unread({"law.load_memory"}, "the normal load is constant");
}

void SceneReader::oscillator_if_there(bool complete) {
  const auto *oscillator = root.find("oscillator"), *drive = root.find("drive");
  const auto& type = oscillator ? oscillator_type(*this, *oscillator) : oscillator_types().front();
  if (oscillator) type.read(*this, oscillator_table(*oscillator), complete);
  if (drive) type.read_drive(*this, Table(*drive, "drive"), complete);
  if (oscillator) read_servo_of(*this, *oscillator);
}

void SceneReader::note_unread(std::initializer_list<std::string_view> paths, std::string_view why) {
  for (const auto path : paths)
    if (document.at_path(path)) scene.notes.push_back(fmt::format("{} has no effect: {}", path, why));
}

Quantity Scene::describe(const std::string& of) const { return family ? family->describe(of) : model.describe(of); }

std::string Scene::placed(const std::string& text) const {
  if (text.starts_with(path) || text.starts_with(override_mark)) return text;
  if (const auto place = places.find(text.substr(0, text.find(':'))); place != places.end())
    return fmt::format("{}: {}", place->second, text);
  const auto is_part = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.';
  };
  std::string above;  // the place of a table that a key would stand in
  for (auto begin = text.begin(); begin != text.end();) {
    begin = std::find_if(begin, text.end(), is_part);
    const auto end = std::find_if_not(begin, text.end(), is_part);
    std::string word(begin, end);
    begin = end;
    while (word.ends_with('.')) word.pop_back();
    if (word.find('.') == std::string::npos) continue;
    if (const auto place = places.find(word); place != places.end()) return fmt::format("{}: {}", place->second, text);
    if (const auto place = places.find(word.substr(0, word.rfind('.'))); place != places.end() && above.empty())
      above = place->second;
  }
  return fmt::format("{}: {}", above.empty() ? path : above, text);
}

}  // namespace rosin::app::scene
