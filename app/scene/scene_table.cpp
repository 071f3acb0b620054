/// Keys that nobody has read.
#include "app/scene/scene_table.hpp"

#include <cctype>

namespace rosin::app::scene {

std::string without_numbers(const std::string& path) {
  std::string kept;
  for (std::size_t begin = 0; begin <= path.size();) {
    const auto dot = std::min(path.find('.', begin), path.size());
    const auto key = path.substr(begin, dot - begin);
    const bool is_number =
        !key.empty() && std::ranges::all_of(key, [](unsigned char c) { return std::isdigit(c) != 0; });
    if (!is_number) kept += (kept.empty() ? "" : ".") + key;
    begin = dot + 1;
  }
  return kept;
}

bool KeysRead::within(const std::string& path) const {
  const auto next = paths_.lower_bound(path + '.');
  return next != paths_.end() && next->starts_with(path + '.');
}

std::vector<std::string> KeysRead::unread(const toml::table& table, const std::string& path) const {
  std::vector<std::string> found;
  const auto add = [&](const std::vector<std::string>& more) {
    for (const auto& one : more)
      if (std::ranges::find(found, one) == found.end()) found.push_back(one);
  };
  for (const auto& [key, node] : table) {
    const auto name = without_numbers(path.empty() ? std::string(key.str()) : fmt::format("{}.{}", path, key.str()));
    if (!within(name)) {  // or its entries were taken as a whole
      if (!paths_.contains(name)) add({name});
    } else if (const auto* inner = node.as_table()) {
      add(unread(*inner, name));
    } else if (const auto* list = node.as_array()) {
      for (const auto& element : *list)
        if (const auto* one = element.as_table()) add(unread(*one, name));
    }
  }
  return found;
}

}  // namespace rosin::app::scene
