/// Reads the caption off the scene as resolved, so that it has the words and units of whoever wrote the scene.
#include "app/output/caption.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "app/output/gnuplot.hpp"
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

/// "a = 0.01" of each number and text of a table, and of the tables in it: "contact_stiffness.per_load = 400000".
void collect(const scene::Scene& scene, const toml::table& table, const std::string& path, const std::string& name,
             std::vector<std::string>& items) {
  for (const auto& [key, node] : table) {
    const std::string word(key.str()), at = path + '.' + word, shown = name.empty() ? word : name + '.' + word;
    if (const auto* inner = node.as_table()) collect(scene, *inner, at, shown, items);
    if (word == "type") continue;  // stands in front
    if (const auto text = node.value_exact<std::string>()) items.push_back(fmt::format("{} = {}", shown, *text));
    if (!node.is_number()) continue;
    const auto unit = unit_of(scene, at);
    items.push_back(
        fmt::format("{} = {:g}{}", shown, *node.value<double>(), unit.empty() || unit == "1" ? "" : ' ' + unit));
  }
}

}  // namespace

std::string caption(const scene::Scene& scene) {
  if (scene.resolved.empty()) return "";
  constexpr std::size_t most = 130;  // characters, of a picture of 820 pixels
  const auto document = scene::parse_toml(scene.resolved, scene.path);
  std::string line;
  for (const char* section : {"law", "oscillator", "drive"}) {
    const auto* table = document[section].as_table();
    if (!table) continue;
    std::vector<std::string> items;
    if (const auto type = (*table)["type"].value<std::string>()) items.push_back(*type);
    collect(scene, *table, section, "", items);
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

std::string captioned(std::string script, const scene::Scene& scene) {
  const auto text = caption(scene);
  const auto last = std::max(script.rfind("\nplot ") + 1, script.rfind("\nsplot ") + 1);  // 0 where there is none
  if (text.empty() || last == 0) return script;
  const auto quoted = single_quoted(text);
  return script.insert(
      last, fmt::format("set label 99 '{{/*0.75 '.{}.'}}' at screen 0.5,screen 0 center offset 0,0.5 textcolor "
                        "'#555555'\n",
                        quoted));
}

}  // namespace rosin::app::output
