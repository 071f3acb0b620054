/// Reading cases: TOML files that are scenes as well.
#include "app/verify/case.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <sstream>

#include "analysis/lab/experiment.hpp"
#include "app/scene/scene_table.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/verbs.hpp"
#include "core/units.hpp"

namespace rosin::app::verify {

namespace fs = std::filesystem;

namespace {

/// Names become those of folders and files, and words of commands.
bool plain(const std::string& name) {
  return !name.empty() && name.front() != '-' &&
         std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
}

SourceUnit read_unit(const toml::node& node, const std::string& path) {
  SourceUnit unit{scene::text(node, path)};
  const auto parsed = parse_unit(unit.name);
  if (!parsed || parsed->offset)
    scene::fail(node.source(), "{} = '{}' is not a unit that is a factor to SI", path, unit.name);
  unit.factor = parsed->factor;
  unit.si = coherent_unit(parsed->dimension);
  return unit;
}

/// A number in the unit of the source, in SI.
double read_number(const toml::node& node, const std::string& path, const SourceUnit& unit) {
  return unit.factor * scene::number(node, {path, "1", {-1e300, 1e300}, "as its source gives it"});
}

/// A value as it stands in the case: numbers, a text, or a truth value.
Wanted read_value(const toml::node& node, const std::string& path, const SourceUnit& unit) {
  if (node.is_string()) return scene::text(node, path);
  if (node.is_boolean()) return *node.value<bool>();
  std::vector<double> numbers;
  if (const auto* list = node.as_array()) {
    if (list->empty()) scene::fail(node.source(), "{} is an empty list", path);
    for (const auto& entry : *list) numbers.push_back(read_number(entry, path, unit));
  } else {
    numbers.push_back(read_number(node, path, unit));
  }
  return numbers;
}

/// Of each number wanted: one for all, one for each, or a part of the number.
std::vector<double> read_accuracy(const toml::node& node, const std::string& path, const Question& question) {
  const auto& wanted = std::get<std::vector<double>>(question.wanted);
  std::vector<double> accuracy(wanted.size());
  if (node.is_table()) {
    scene::Table table(node, path);
    table.expect({"relative"});
    double relative = 0;
    table.required("relative", "part of the number");
    table.read("relative", relative, {"", "1", {1e-15, 1}, "part of the number"});
    table.finish();
    std::ranges::transform(wanted, accuracy.begin(), [&](double x) { return relative * std::abs(x); });
    if (std::ranges::find(accuracy, 0.0) != accuracy.end())
      scene::fail(node.source(), "{} of a value that is 0 must be a number, not a part of it", path);
    return accuracy;
  }
  const Quantity quantity{path, "1", {1e-300, 1e300}, "of the source's number"};
  if (node.is_array()) {
    accuracy = scene::numbers(node, quantity);
    if (accuracy.size() != wanted.size())
      scene::fail(node.source(), "{} has {} entries, but there are {} values", path, accuracy.size(), wanted.size());
  } else {
    std::ranges::fill(accuracy, scene::number(node, quantity));
  }
  for (auto& one : accuracy) one *= question.unit.factor;
  return accuracy;
}

/// A text that says something.
std::string sentence(const toml::node& node, const std::string& path) {
  auto words = scene::text(node, path);
  if (words.find_first_not_of(" \t\r\n") == std::string::npos) scene::fail(node.source(), "{} is empty", path);
  std::ranges::replace(words, '\n', ' ');
  return words;
}

Origin read_origin(const toml::node& node, const std::string& path) {
  const auto word = scene::choice(node, path, {"printed", "stored", "closed form", "computed"});
  for (const auto origin : {Origin::printed, Origin::stored, Origin::closed_form})
    if (word == name(origin)) return origin;
  return Origin::computed;
}

/// The words of a command that reads a scene, as `rosin --help` has them.
std::vector<std::string> read_verb(const toml::node& node, const std::string& path) {
  std::istringstream given(scene::text(node, path));
  std::vector<std::string> words;
  for (std::string word; given >> word;) words.push_back(word);
  const bool design = words.size() == 2 && words[0] == "compare" && words[1] == "--design";
  const bool lab = words.size() == 2 && words[0] == "lab";
  if (words.empty() || (words.size() > 1 && !design && !lab) || (words.size() == 1 && words[0] == "lab"))
    scene::fail(node.source(), "{} is one verb, such as \"cycle\", \"lab velocity-step\" or \"compare --design\"",
                path);
  scene::located(node.source(), [&] {
    if (!verbs::find_verb(words[0]).read) throw InputError(fmt::format("'{}' takes no scene", words[0]));
    if (lab) analysis::lab::find_experiment(words[1]);
  });
  return words;
}

/// Refuses what the verb would refuse, before anything is computed.
void check_scene(const Case& one, const Question& question, const toml::source_region& source) {
  Request request;
  request.verb = question.words[0];
  request.experiment = request.verb == "lab" ? question.words[1] : "";
  request.design = question.words.back() == "--design";
  request.target = one.path.string();
  request.overrides = question.overrides;
  try {
    verbs::read_scene(request);
  } catch (const InputError& error) {
    const std::string why = error.what();
    if (!why.starts_with(scene::override_mark)) throw;
    throw scene::PlacedError(fmt::format("{}: in 'set': {}", scene::place(source), why));
  }
}

Question read_question(scene::Table table, const Case& owner) {
  table.expect({"what", "verb", "set", "field", "error", "value", "accuracy", "unit", "origin", "differs", "instead"});
  Question question;
  question.what = sentence(table.required("what", "the number in words"), table.path("what"));
  if (const auto* unit = table.find("unit")) question.unit = read_unit(*unit, table.path("unit"));
  question.origin = owner.origin;
  if (const auto* origin = table.find("origin")) question.origin = read_origin(*origin, table.path("origin"));
  const auto& value = table.required("value", "the number as its source gives it");
  question.wanted = read_value(value, table.path("value"), question.unit);
  question.list = value.is_array();
  if (std::holds_alternative<std::vector<double>>(question.wanted)) {
    question.accuracy = read_accuracy(table.required("accuracy", "of the source's number, absolute or { relative }"),
                                      table.path("accuracy"), question);
  } else {
    for (const char* key : {"accuracy", "unit", "error"})
      if (const auto* node = table.find(key))
        scene::fail(node->source(), "{} has no effect: the value is no number", table.path(key));
  }

  if (!owner.not_reproduced.empty()) {
    for (const char* key : {"verb", "set", "field", "error", "differs", "instead"})
      if (const auto* node = table.find(key))
        scene::fail(node->source(), "{} has no effect: the case says in verify.not_reproduced why rosin is not asked",
                    table.path(key));
    table.finish();
    return question;
  }
  question.words = read_verb(table.required("verb", "as on the command line"), table.path("verb"));
  if (const auto* set = table.find("set")) question.overrides = scene::texts(*set, table.path("set"));
  const auto path = [&](const toml::node& node, const char* key) {
    return scene::located(node.source(), [&] { return Field(scene::text(node, table.path(key))); });
  };
  question.field = path(table.required("field", "where the number stands in the verb's JSON"), "field");
  if (const auto* error = table.find("error")) question.error = path(*error, "error");
  if (const auto* differs = table.find("differs")) {
    question.differs = sentence(*differs, table.path("differs"));
    const auto& instead = table.required("instead", "what rosin is known to give where it differs");
    question.instead = read_value(instead, table.path("instead"), question.unit);
    const auto* numbers = std::get_if<std::vector<double>>(&question.instead);
    if (question.instead.index() != question.wanted.index() || (numbers && numbers->size() != question.accuracy.size()))
      scene::fail(instead.source(), "{} is of another kind than {}", table.path("instead"), table.path("value"));
  } else if (const auto* instead = table.find("instead")) {
    scene::fail(instead->source(), "{} goes with 'differs', the reason", table.path("instead"));
  }
  table.finish();
  check_scene(owner, question, table.source());
  return question;
}

/// Tables that no verb of the case looks at could hold anything.
void refuse_unread(const toml::table& document, const Case& one) {
  std::vector<std::string> read = {"title", "verify"};
  for (const auto& question : one.questions)
    if (!question.words.empty())
      for (const auto& need : verbs::find_verb(question.words[0]).needs) read.emplace_back(need.table);
  if (one.not_reproduced.empty()) {
    read.insert(read.end(), {"law", "oscillator", "drive"});
    for (const auto& verb : verbs::verbs())
      for (const auto& table : verb.tables) read.emplace_back(table.name);
  }
  for (const auto& [key, node] : document)
    if (std::ranges::find(read, key.str()) == read.end())
      scene::fail(key.source(), "[{}] has no effect: no question of the case asks a verb that looks at it", key.str());
}

}  // namespace

const char* name(Origin origin) {
  switch (origin) {
    case Origin::printed:
      return "printed";
    case Origin::stored:
      return "stored";
    case Origin::closed_form:
      return "closed form";
    case Origin::computed:
      return "computed";
  }
  return "";
}

Case read_case(const fs::path& path) {
  const auto document = scene::read_toml(path.string());
  Case one;
  one.path = path;
  one.name = path.stem().string();
  if (!plain(one.name))
    throw InputError(fmt::format("{}: a case's name is made of letters, digits, - and _", path.string()));
  one.group = fs::absolute(path).parent_path().filename().string();
  const auto* node = document.get("verify");
  if (!node)
    throw InputError(fmt::format("{}: is no case: it has no [verify] with source and questions", path.string()));
  const auto* title = document.get("title");
  if (!title) throw InputError(fmt::format("{}: a case needs a title", path.string()));
  one.title = sentence(*title, "title");
  scene::Table table(*node, "verify");
  table.expect({"source", "origin", "note", "not_reproduced", "slow", "tolerance", "questions"});
  one.source = sentence(table.required("source", "who printed or computed the numbers, and where"), "verify.source");
  one.origin = read_origin(table.required("origin", "printed, stored, closed form or computed"), "verify.origin");
  if (const auto* note = table.find("note")) one.note = sentence(*note, "verify.note");
  if (const auto* why = table.find("not_reproduced")) one.not_reproduced = sentence(*why, "verify.not_reproduced");
  if (const auto* slow = table.find("slow")) {
    if (!slow->is_boolean()) scene::wrong_kind(*slow, "verify.slow", "true or false");
    one.slow = *slow->value<bool>();
  }
  table.read("tolerance", one.tolerance, {"", "1", {1e-13, 0.1}, "relative accuracy, as of --tolerance"});
  const auto& questions = table.required("questions", "what is asked, and the numbers");
  for (const auto& question : scene::list(questions, "verify.questions", "tables", scene::most_names))
    one.questions.push_back(read_question(scene::Table(question, "verify.questions"), one));
  table.finish();
  if (one.questions.empty()) scene::fail(questions.source(), "verify.questions is empty");
  refuse_unread(document, one);
  return one;
}

namespace {

/// The files of a dossier by the names of their cases.
std::map<std::string, fs::path> files_of(const fs::path& folder) {
  std::map<std::string, fs::path> files;
  std::error_code problem;
  for (const auto& group : fs::directory_iterator(folder, problem)) {
    if (!group.is_directory()) continue;
    for (const auto& entry : fs::directory_iterator(group.path(), problem)) {
      if (entry.path().extension() != ".toml") continue;
      const auto name = entry.path().stem().string();
      if (!plain(group.path().filename().string()))
        throw InputError(fmt::format("{}: a group's name is made of letters, digits, - and _", group.path().string()));
      if (const auto [known, added] = files.emplace(name, entry.path()); !added)
        throw InputError(fmt::format("{} and {} have the same name; a case is known by it", known->second.string(),
                                     entry.path().string()));
    }
    if (problem) throw InputError(fmt::format("{}: cannot be read: {}", group.path().string(), problem.message()));
  }
  if (problem) throw InputError(fmt::format("{}: cannot be read: {}", folder.string(), problem.message()));
  return files;
}

}  // namespace

std::vector<Case> read_cases(const fs::path& folder, const std::vector<std::string>& named) {
  const auto by_name = files_of(folder);
  std::multimap<std::string, std::string> by_group;
  for (const auto& [name, path] : by_name) by_group.emplace(path.parent_path().filename().string(), name);
  const bool all = named.empty();
  if (all && by_name.empty())
    throw InputError(fmt::format("{}: no cases are there; --cases DIR names a folder of them", folder.string()));

  std::set<fs::path> chosen;
  if (all)
    for (const auto& [name, path] : by_name) chosen.insert(path);
  for (const auto& word : named) {
    if (const auto found = by_name.find(word); found != by_name.end()) {
      chosen.insert(found->second);
    } else if (by_group.contains(word)) {
      const auto [begin, end] = by_group.equal_range(word);
      for (auto it = begin; it != end; ++it) chosen.insert(by_name.at(it->second));
    } else if (fs::path(word).extension() == ".toml") {
      chosen.insert(word);
    } else {
      std::vector<std::string> known;
      std::set<std::string> groups;
      for (const auto& [name, path] : by_name) known.push_back(name);
      for (const auto& [group, name] : by_group) groups.insert(group);
      known.insert(known.end(), groups.begin(), groups.end());
      const auto near = nearest_name(word, known);
      throw InputError(fmt::format("no case or group is called '{}'; {}", word,
                                   near.empty() ? fmt::format("the groups are {}", fmt::join(groups, ", "))
                                                : fmt::format("did you mean '{}'?", near)));
    }
  }
  std::vector<Case> cases;
  std::set<std::string> names;
  for (const auto& path : chosen) {
    cases.push_back(read_case(path));
    if (!names.insert(cases.back().name).second)
      throw InputError(fmt::format("{}: another case is called '{}' too", path.string(), cases.back().name));
  }
  return cases;
}

}  // namespace rosin::app::verify
