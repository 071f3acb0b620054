/// Scripts of both languages, and those in Python as python.py hands them over.
#include "app/imports/script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.hpp"
#include "core/process.hpp"

namespace rosin::app::imports {

extern const char* const python_reader;  ///< the text of python.py

namespace {

using nlohmann::json;

/// Objects that stand by their places in a list, and the values that refer to them.
class Document {
 public:
  explicit Document(const json& document) : objects_(document["objects"]), made_(objects_.size()) {
    for (std::size_t i = 0; i < made_.size(); ++i) {
      const auto& one = objects_[i];
      if (one.contains("slots"))
        made_[i] = {std::make_shared<Record>()};
      else if (one.contains("list"))
        made_[i] = {std::make_shared<List>()};
      else
        made_[i] = {std::make_shared<Vector>()};
    }
    for (std::size_t i = 0; i < made_.size(); ++i) fill(objects_[i], made_[i]);
  }

  void slots(const json& from, Record& into) const {
    for (const auto& [name, slot] : from.items()) into.slots[name] = {value(slot[0]), slot[1].get<int>()};
  }

 private:
  Value value(const json& of) const {
    if (of.is_number()) return {of.get<double>()};
    if (of.contains("object")) return made_[of["object"].get<std::size_t>()];
    if (of.contains("text")) return {of["text"].get<std::string>()};
    if (of.contains("number")) {  // that JSON has not
      const auto text = of["number"].get<std::string>();
      return {text == "inf" ? INFINITY : text == "-inf" ? -INFINITY : NAN};
    }
    return {Unknown{of["unknown"].get<std::string>()}};
  }

  void fill(const json& from, Value& into) const {
    Changed changed;
    if (const auto& at = from["changed"]; !at.is_null()) changed = {at[0].get<int>(), at[1].get<std::string>()};
    if (const auto record = record_of(into)) {
      record->type = from["type"].get<std::string>();
      record->name = from["name"].get<std::string>();
      record->changed = changed;
      slots(from["slots"], *record);
    } else if (const auto* list = into.as<std::shared_ptr<List>>()) {
      (*list)->changed = changed;
      for (const auto& one : from["list"]) (*list)->values.push_back(value(one));
    } else {
      auto& vector = **into.as<std::shared_ptr<Vector>>();
      vector.changed = changed;
      for (const auto& one : from["numbers"]) vector.numbers.push_back(one.is_null() ? NAN : one.get<double>());
    }
  }

  const json& objects_;
  std::vector<Value> made_;
};

}  // namespace

Dialect dialect_of(std::string_view text) {
  for (const std::string_view sure : {"import ", "set_dict"})
    if (text.find(sure) != std::string_view::npos) return Dialect::python;
  long matlab = text.find("qdyn('") != std::string_view::npos ? 1 : 0;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    auto line = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    line.remove_prefix(std::min(line.size(), line.find_first_not_of(" \t")));
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    if (line.empty()) continue;
    matlab += line.front() == '%' || line.back() == ';' || line.find("; ") != std::string_view::npos ? 1 : 0;
    matlab -= line.front() == '#' || line.find(" # ") != std::string_view::npos ? 1 : 0;
  }
  return matlab > 0 ? Dialect::matlab : Dialect::python;
}

std::shared_ptr<Record> record_of(const Value& value) {
  const auto* pointer = value.as<std::shared_ptr<Record>>();
  return pointer ? *pointer : nullptr;
}

Script::Script(std::string path, std::string_view text) : path_(std::move(path)) {
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines_.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(text.size(), end + 1));
  }
}

std::string Script::line(int number) const {
  if (number < 1 || static_cast<std::size_t>(number) > lines_.size()) return {};
  auto text = lines_[static_cast<std::size_t>(number) - 1];
  const auto begin = std::min(text.find_first_not_of(" \t\r"), text.size());
  text.erase(0, begin);
  while (!text.empty() && std::string_view(" \t\r").find(text.back()) != std::string_view::npos) text.pop_back();
  constexpr std::size_t most = 120;
  if (text.size() > most) text = text.substr(0, most) + "…";
  return text;
}

void Script::refuse(int line, std::string_view why) const {
  throw InputError(fmt::format("{}:{}: '{}' {}", path_, line, this->line(line), why));
}

Script read_python(const std::string& path, std::string_view text) {
  Script script(path, text);
  const auto python = find_program("python3");
  if (!python)
    throw InputError(fmt::format(
        "{}: is a script in Python, which python3 reads (none of it is run), and there is no python3: install it, or "
        "write the scene by the table of names in docs/coming-from.md",
        path));
  constexpr std::size_t longest = 1 << 27;  // bytes of the answer
  const auto ran = run_program({.program = *python,
                                .arguments = {"-I", "-S", "-c", python_reader},
                                .stops_with_us = true,
                                .input = std::string(text),
                                .longest_output = longest});
  if (!ran) throw InputError(fmt::format("{}: {} cannot be started to read it", path, python->string()));
  const auto answer = json::parse(ran->output, nullptr, false);
  if (answer.is_discarded())
    script.refuse(1, fmt::format("begins a script that is too much for python3 to read, which ended with status {}; "
                                 "write its parameters alone",
                                 ran->status));
  if (answer.contains("refused")) script.refuse(answer["line"].get<int>(), answer["refused"].get<std::string>());
  Document(answer).slots(answer["names"], script.variables);
  return script;
}

}  // namespace rosin::app::imports
