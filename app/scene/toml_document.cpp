/// Reading TOML with care, changing it by overrides, and writing it.
#include "app/scene/toml_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "app/scene/aliases.hpp"
#include "app/scene/scene_table.hpp"
#include "app/scene/toml_text.hpp"
#include "core/files.hpp"

namespace rosin::app::scene {

namespace {

constexpr std::uintmax_t largest_scene = 10'000'000;  // bytes

constexpr int deepest = 100;  // levels: parsing and every walk over a scene goes as deep into the stack

/// Brackets within brackets and keys with dots, counted before the parser makes tables of them, whose end goes as deep
/// into the stack as they lie. \throws InputError with the line.
void check_depth(std::string_view text, std::string_view origin) {
  std::vector<int> dots = {0};  // of the key at hand, and of those that it lies within
  int line = 1, levels = 0;
  const auto skip_string = [&](std::size_t begin) {  // returns the index of its last character
    const char quote = text[begin];
    const bool multi = text.substr(begin, 3) == std::string(3, quote);
    const auto end = multi ? text.substr(begin, 3) : text.substr(begin, 1);
    std::size_t i = begin + end.size();
    for (; i < text.size() && text.substr(i, end.size()) != end; ++i) {
      if (text[i] == '\n' && !multi) return i - 1;
      line += text[i] == '\n';
      if (quote == '"' && text[i] == '\\') ++i;
    }
    for (int more = 0; multi && more < 2 && i + 3 < text.size() && text[i + 3] == quote; ++more) ++i;  // """x"""""
    return i + end.size() - 1;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = skip_string(i);
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '[' || c == '{') {
      dots.push_back(0), ++levels;
    } else if ((c == ']' || c == '}') && dots.size() > 1) {
      levels -= 1 + dots.back(), dots.pop_back();
    } else if (c == '.') {
      ++dots.back(), ++levels;
    } else if (c == ',' || (c == '\n' && dots.size() == 1)) {
      levels -= std::exchange(dots.back(), 0);
    }
    line += c == '\n';
    if (levels > deepest)
      throw InputError(fmt::format("{}:{}: tables or lists lie more than {} levels deep", origin, line, deepest));
  }
}

/// \throws InputError where tables and lists lie deeper than `deepest`, as headers and overrides together can bring
/// them.
void check_depth(const toml::node& node, int level = 0) {
  if (level > deepest) fail(node.source(), "tables or lists lie more than {} levels deep", deepest);
  if (const auto* table = node.as_table())
    for (const auto& [key, inner] : *table) check_depth(inner, level + 1);
  if (const auto* list = node.as_array())
    for (const auto& inner : *list) check_depth(inner, level + 1);
}

/// Moves `node` to `key`; unlike a copy, a move keeps the place that the value came from.
void place_at(toml::table& table, std::string_view key, toml::node& node) {
  node.visit([&](auto& value) { table.insert_or_assign(key, std::move(value)); });
}

/// Puts a value, with the place that it has, at a path of a scene. \param origin  of the path, "" for none
void put(toml::table& scene, const std::string& path, toml::node& value, const std::string& origin) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(origin.empty() ? why : fmt::format("{}: {}", origin, why));
  };
  toml::node* at = &scene;  // a table, or a list, whose entries are numbered from 1
  const auto entry = [&](toml::array& list, std::size_t begin, std::size_t end) {
    const auto key = path.substr(begin, end - begin);
    std::size_t number = 0;
    const auto [rest, problem] = std::from_chars(key.data(), key.data() + key.size(), number);
    if (problem != std::errc{} || rest != key.data() + key.size() || number < 1 || number > list.size())
      refuse(fmt::format("{} is a list of {}; an entry of it has a number from 1, not '{}'", path.substr(0, begin - 1),
                         list.size(), key));
    return number - 1;
  };
  std::size_t begin = 0;
  for (std::size_t dot; (dot = path.find('.', begin)) != std::string::npos; begin = dot + 1) {
    const auto key = path.substr(begin, dot - begin);
    toml::node* next;
    if (auto* list = at->as_array()) {
      next = list->get(entry(*list, begin, dot));
    } else {
      auto& table = *at->as_table();
      if (!table.contains(key)) {
        auto empty = toml::parse("value = {}", origin);
        place_at(table, key, *empty.get("value"));
        table.get(key)->as_table()->is_inline(false);
      }
      next = table.get(key);
    }
    if (!next->is_table() && !next->is_array())
      refuse(fmt::format("{} is {}, not a table", path.substr(0, dot), kind(*next)));
    at = next;
  }
  if (begin == path.size()) refuse("the path ends with a dot");
  if (auto* list = at->as_array())
    value.visit(
        [&](auto& is) { list->replace(list->begin() + long(entry(*list, begin, path.size())), std::move(is)); });
  else
    place_at(*at->as_table(), path.substr(begin), value);
}

/// A value on one line.
void write_value(std::string& out, const toml::node& node) {
  if (const auto* whole = node.as_integer()) {
    out += fmt::format("{}", whole->get());
  } else if (const auto* number = node.as_floating_point()) {
    out += toml_number(number->get());
  } else if (const auto* text = node.as_string()) {
    out += toml_text(text->get());
  } else if (const auto* list = node.as_array()) {
    out += '[';
    for (const auto& element : *list) {
      if (&element != &list->front()) out += ", ";
      write_value(out, element);
    }
    out += ']';
  } else if (const auto* table = node.as_table()) {
    const char* separator = "{ ";
    for (const auto& [key, value] : *table) {
      out += std::exchange(separator, ", ");
      out += fmt::format("{} = ", toml_key(key.str()));
      write_value(out, value);
    }
    out += table->empty() ? "{}" : " }";
  } else {  // a truth value, a date or a time
    std::ostringstream plain;
    node.visit([&](const auto& value) { plain << toml::toml_formatter(value); });
    out += plain.str();
  }
}

bool reads_back(const std::string& text, const toml::table& scene) {
  try {
    return toml::parse(text) == scene;
  } catch (const toml::parse_error&) {
    return false;
  }
}

/// Paths of numbers and texts.
void list_values(const toml::table& table, const std::string& path, std::vector<std::string>& paths) {
  for (const auto& [key, node] : table) {
    const auto inner = path.empty() ? std::string(key.str()) : fmt::format("{}.{}", path, key.str());
    if (const auto* below = node.as_table())
      list_values(*below, inner, paths);
    else if (node.is_number() || node.is_string())
      paths.push_back(inner);
  }
}

/// A value as a part of a file's name: no separator of folders, no blank, no name of a folder above.
std::string file_name(const toml::node& value) {
  if (value.is_number()) return fmt::format("{}", *value.value<double>());
  std::string name = value.as_string()->get();
  for (char& c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (letter < 0x80 && !std::isalnum(letter) && std::string_view("+-._").find(c) == std::string_view::npos) c = '_';
  }
  if (name.empty() || name.front() == '.') name.insert(name.begin(), '_');
  return name;
}

}  // namespace

toml::table read_toml(const std::string& path) { return parse_toml(read_whole(path, largest_scene), path); }

toml::table parse_toml(std::string_view text, const std::string& origin) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw InputError(fmt::format("{}:1:1: the scene is empty; it needs at least [law] with a type", origin));
  check_depth(text, origin);
  try {
    auto scene = toml::parse(text, origin);
    check_depth(scene);
    return scene;
  } catch (const toml::parse_error& error) {
    fail(error.source(), "not valid TOML: {}", error.description());
  }
}

toml::table read_document(const Request& request, std::vector<std::string>& notes) {
  auto scene = request.text ? parse_toml(*request.text, request.target) : read_toml(request.target);
  resolve_aliases(scene, notes);
  for (const auto& given : request.overrides) {
    apply_override(scene, given);
    check_depth(scene);
    resolve_aliases(scene, notes);
  }
  return scene;
}

void apply_override(toml::table& scene, const std::string& given) {
  constexpr std::size_t shown = 200;
  std::string origin(override_mark);
  origin += given.substr(0, shown);
  if (given.size() > shown) origin += "…";
  const auto equals = given.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(fmt::format("{}: must read path=value, such as --set drive.speed=1e-5", origin));
  const std::string path = path_in_full(scene, given.substr(0, equals)), value = given.substr(equals + 1);
  if (std::ranges::count(path, '.') > deepest)
    throw InputError(fmt::format("{}: tables or lists lie more than {} levels deep", origin, deepest));
  check_depth(value, origin);
  const auto parse = [&](const std::string& text) { return toml::parse("value = " + text, origin); };
  try {
    parse(toml_text(given));
  } catch (const toml::parse_error&) {
    throw InputError(fmt::format("{}: is no text in UTF-8", origin));
  }
  toml::table parsed;
  try {
    parsed = parse(value);
    if (parsed.size() != 1) throw InputError(fmt::format("{}: holds more than one value", origin));
  } catch (const toml::parse_error& error) {
    if (value.empty() || value.find_first_of("[]{}\"'\n") != std::string::npos)
      throw InputError(fmt::format("{}: the value is not valid TOML: {}", origin, error.description()));
    parsed = parse(toml_text(value));  // a bare word: a text that keeps the override as its place
  }

  put(scene, path, *parsed.get("value"), origin);
}

std::string path_in_full(const toml::table& scene, const std::string& path) {
  std::string full = path.starts_with("contacts.") ? "oscillator." + path
                     : path.starts_with("data.")   ? "fit." + path
                                                   : path;
  const auto dot = full.rfind('.');
  if (dot == std::string::npos) return full;
  const auto key = full.substr(dot + 1), signal = full.substr(0, dot);
  const auto* node = node_at(scene, signal);
  if ((key == "amplitude" || key == "angular_frequency" || key == "phase") && node && node->is_table() &&
      node->as_table()->contains("harmonics"))
    full = signal + ".harmonics.1." + key;
  return full;
}

void set_number(toml::table& scene, const std::string& path, double number) {
  toml::value<double> value(number);
  put(scene, path, value, "");
}

const toml::node* node_at(const toml::table& scene, std::string_view path) {
  const toml::node* at = &scene;
  for (std::size_t begin = 0; at && begin <= path.size();) {
    const auto dot = std::min(path.find('.', begin), path.size());
    const auto key = path.substr(begin, dot - begin);
    if (const auto* table = at->as_table()) {
      at = table->get(key);
    } else if (const auto* list = at->as_array()) {
      std::size_t number = 0;
      std::from_chars(key.data(), key.data() + key.size(), number);
      at = number >= 1 && number <= list->size() ? list->get(number - 1) : nullptr;
    } else {
      at = nullptr;
    }
    begin = dot + 1;
  }
  return at;
}

std::string filled_in(const std::string& pattern, const toml::table& scene) {
  std::string filled;
  for (std::size_t at = 0; at < pattern.size();) {
    const auto open = std::min(pattern.find('{', at), pattern.size());
    filled += pattern.substr(at, open - at);
    if (open == pattern.size()) break;
    const auto close = pattern.find('}', open);
    if (close == std::string::npos)
      throw InputError(fmt::format("'{}' has a {{ without }}; it takes paths such as {{drive.speed}}", pattern));
    const auto path = pattern.substr(open + 1, close - open - 1);
    const auto* value = node_at(scene, path_in_full(scene, path));
    if (!value || !(value->is_number() || value->is_string())) {
      std::vector<std::string> paths;
      list_values(scene, "", paths);
      throw InputError(fmt::format(
          "'{}' in '{}' {}{}", path, pattern,
          value ? fmt::format("is {}, not a number or a text of the scene", kind(*value)) : "is not given in the scene",
          suggestion(path, paths)));
    }
    filled += file_name(*value);
    at = close + 1;
  }
  return filled;
}

std::string resolved(const toml::table& scene) {
  std::string text;
  const auto write_entry = [&](const toml::key& key, const toml::node& value) {
    text += fmt::format("{} = ", toml_key(key.str()));
    write_value(text, value);
    text += '\n';
  };
  for (const auto& [key, value] : scene)
    if (!value.is_table()) write_entry(key, value);
  for (const auto& [name, table] : scene) {
    if (!table.is_table()) continue;
    text += fmt::format("\n[{}]\n", toml_key(name.str()));
    for (const auto& [key, value] : *table.as_table()) write_entry(key, value);
  }
  if (!reads_back(text, scene))
    throw std::logic_error("the scene as resolved reads back as another one: a fault of rosin, please report it");
  return text;
}

}  // namespace rosin::app::scene
