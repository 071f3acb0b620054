/// Reads the caption off the scene as resolved, so that it has the words and units of whoever wrote the scene.
#include "app/output/caption.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/scene/scene.hpp"
#include "app/scene/toml_document.hpp"

namespace rosin::app::output {

namespace {

/// The unit of a number that stands in a scene without one; "" where the path is no parameter of the model.
std::string unit_of(const scene::Scene& scene, const std::string& path) {
  try {
    return scene.describe(path).unit;
  } catch (const InputError&) {
    return "";
  }
}

/// With spaces at which no row ends.
std::string unbroken(std::string item) {
  for (std::size_t at = 0; (at = item.find(' ', at)) != std::string::npos;) item.replace(at, 1, "\u00A0");
  return item;
}

/// "a = 0.01" of each number and text of a table, and of the tables in it: "contact_stiffness.per_load = 400000".
void collect(const scene::Scene& scene, const toml::table& table, const std::string& path, const std::string& name,
             const std::vector<std::string>& varied, std::vector<std::string>& items) {
  for (const auto& [key, node] : table) {
    const std::string word(key.str()), at = path + '.' + word, shown = name.empty() ? word : name + '.' + word;
    if (std::ranges::find(varied, at) != varied.end()) continue;
    if (const auto* inner = node.as_table()) collect(scene, *inner, at, shown, varied, items);
    if (word == "type") continue;  // stands in front
    if (const auto text = node.value_exact<std::string>())
      items.push_back(unbroken(fmt::format("{} = {}", shown, *text)));
    if (!node.is_number()) continue;
    const auto unit = unit_of(scene, at);
    items.push_back(unbroken(fmt::format("{} = {:g}{}", shown, *node.value<double>(),
                                         unit.empty() || unit == "1" ? "" : ' ' + readable_unit(unit))));
  }
}

}  // namespace

std::string caption(const scene::Scene& scene, const std::vector<std::string>& varied) {
  if (scene.resolved.empty()) return "";
  constexpr std::size_t most = 260;  // characters
  const auto document = scene::parse_toml(scene.resolved, scene.path);
  std::string line;
  for (const char* section : {"law", "oscillator", "drive"}) {
    const auto* table = document[section].as_table();
    if (!table || std::ranges::find(varied, section) != varied.end()) continue;
    std::vector<std::string> items;
    if (const auto type = (*table)["type"].value<std::string>()) items.push_back(*type);
    collect(scene, *table, section, "", varied, items);
    if (items.empty()) continue;
    const auto part = fmt::format("{}{}: ", line.empty() ? "" : "; ", section);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const auto next = (i == 0 ? part : ", ") + items[i];
      if (line.size() + next.size() > most) return line + ", …";
      line += next;
    }
  }
  return line;
}

}  // namespace rosin::app::output
