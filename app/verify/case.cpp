/// Reading cases: TOML files that are scenes as well.
#include "app/verify/case.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "app/scene/scene_table.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/verbs.hpp"
#include "core/units.hpp"

namespace rosin::app::verify {

namespace fs = std::filesystem;

namespace {

SourceUnit read_unit(const toml::node& node, const std::string& path) {
  SourceUnit unit{text(node, path)};
  const auto parsed = parse_unit(unit.name);
  if (!parsed || parsed->offset) fail(node.source(), "{} = '{}' is not a unit that is a factor to SI", path, unit.name);
  unit.factor = parsed->factor;
  unit.si = coherent_unit(parsed->dimension);
  return unit;
}

/// A number in the unit of the source, in SI.
double read_number(const toml::node& node, const std::string& path, const SourceUnit& unit) {
  return unit.factor * number(node, {path, "1", {-1e300, 1e300}, "as its source gives it"});
}

std::vector<double> read_accuracy(const toml::node& node, const std::string& path, const Question& question) {
  const auto& wanted = std::get<std::vector<double>>(question.wanted);
  std::vector<double> accuracy(wanted.size());
  if (node.is_table()) {
    Table table(node, path);
    table.expect({"relative"});
    double relative = 0;
    table.required("relative", "part of the number");
    table.read("relative", relative, {"", "1", {1e-15, 1}, "part of the number"});
    table.finish();
    std::ranges::transform(wanted, accuracy.begin(), [&](double x) { return relative * std::abs(x); });
    if (std::ranges::find(accuracy, 0.0) != accuracy.end())
      fail(node.source(), "{} of a value that is 0 must be a number, not a part of it", path);
    return accuracy;
  }
  const double one = number(node, {path, "1", {1e-300, 1e300}, "of the source's number"});
  std::ranges::fill(accuracy, question.unit.factor * one);
  return accuracy;
}

/// The words of a command that reads a scene, as `rosin --help` has them.
std::vector<std::string> read_verb(const toml::node& node, const std::string& path) {
  std::istringstream given(text(node, path));
  std::vector<std::string> words;
  for (std::string word; given >> word;) words.push_back(word);
  const bool design = words.size() == 2 && words[0] == "compare" && words[1] == "--design";
  const bool lab = words.size() == 2 && words[0] == "lab";
  if (words.empty() || (words.size() > 1 && !design && !lab) || (words.size() == 1 && words[0] == "lab"))
    fail(node.source(), "{} is one verb, such as \"cycle\", \"lab velocity-step\" or \"compare --design\"", path);
  located(node.source(), [&] {
    if (!find_verb(words[0]).read) throw InputError(fmt::format("'{}' takes no scene", words[0]));
  });
  return words;
}

Question read_question(Table table, const Case& owner) {
  table.expect({"what", "verb", "set", "field", "error", "value", "accuracy", "unit", "differs"});
  Question question;
  question.what = text(table.required("what", "the number in words"), table.path("what"));
  if (const auto* unit = table.find("unit")) question.unit = read_unit(*unit, table.path("unit"));

  const auto& value = table.required("value", "the number as its source gives it");
  if (value.is_string()) {
    question.wanted = text(value, table.path("value"));
  } else if (value.is_boolean()) {
    question.wanted = *value.value<bool>();
  } else {
    std::vector<double> wanted;
    question.list = value.is_array();
    if (question.list && value.as_array()->empty()) fail(value.source(), "{} is an empty list", table.path("value"));
    if (question.list)
      for (const auto& entry : *value.as_array())
        wanted.push_back(read_number(entry, table.path("value"), question.unit));
    else
      wanted.push_back(read_number(value, table.path("value"), question.unit));
    question.wanted = std::move(wanted);
    question.accuracy = read_accuracy(table.required("accuracy", "of the source's number, absolute or { relative }"),
                                      table.path("accuracy"), question);
  }
  if (question.accuracy.empty())
    for (const char* key : {"accuracy", "unit", "error"})
      if (const auto* node = table.find(key))
        fail(node->source(), "{} has no effect: the value is no number", table.path(key));

  if (!owner.not_reproduced.empty()) {
    for (const char* key : {"verb", "set", "field", "error", "differs"})
      if (const auto* node = table.find(key))
        fail(node->source(), "{} has no effect: the case says in verify.not_reproduced why rosin is not asked",
             table.path(key));
    table.finish();
    return question;
  }
  question.words = read_verb(table.required("verb", "as on the command line"), table.path("verb"));
  if (const auto* set = table.find("set")) question.overrides = texts(*set, table.path("set"));
  const auto path = [&](const toml::node& node, const char* key) {
    return located(node.source(), [&] { return Field(text(node, table.path(key))); });
  };
  question.field = path(table.required("field", "where the number stands in the verb's JSON"), "field");
  if (const auto* error = table.find("error")) question.error = path(*error, "error");
  if (const auto* differs = table.find("differs")) question.differs = text(*differs, table.path("differs"));
  table.finish();
  return question;
}

/// Refuses what the verb would refuse, before anything is computed.
void check_scene(const Case& one, const Question& question) {
  Request request;
  request.verb = question.words[0];
  request.experiment = request.verb == "lab" ? question.words[1] : "";
  request.design = question.words.back() == "--design";
  request.target = one.path.string();
  request.overrides = question.overrides;
  read_scene(request);
}

}  // namespace

Case read_case(const fs::path& path) {
  const auto document = read_toml(path.string());
  Case one;
  one.path = path;
  one.shown = path.string();
  one.name = path.stem().string();
  one.group = fs::absolute(path).parent_path().filename().string();
  const auto* node = document.get("verify");
  if (!node)
    throw InputError(fmt::format("{}: is no case: it has no [verify] with source and questions", path.string()));
  const auto* title = document.get("title");
  if (!title) throw InputError(fmt::format("{}: a case needs a title", path.string()));
  one.title = text(*title, "title");
  Table table(*node, "verify");
  table.expect({"source", "note", "not_reproduced", "slow", "tolerance", "questions"});
  one.source = text(table.required("source", "who printed or computed the numbers, and where"), "verify.source");
  if (const auto* note = table.find("note")) one.note = text(*note, "verify.note");
  if (const auto* why = table.find("not_reproduced")) one.not_reproduced = text(*why, "verify.not_reproduced");
  if (const auto* slow = table.find("slow")) {
    if (!slow->is_boolean()) wrong_kind(*slow, "verify.slow", "true or false");
    one.slow = *slow->value<bool>();
  }
  table.read("tolerance", one.tolerance, {"", "1", {1e-13, 0.1}, "relative accuracy, as of --tolerance"});
  const auto& questions = table.required("questions", "what is asked, and the numbers");
  for (const auto& question : list(questions, "verify.questions", "tables", most_names))
    one.questions.push_back(read_question(Table(question, "verify.questions"), one));
  table.finish();
  if (one.questions.empty()) fail(questions.source(), "verify.questions is empty");
  for (const auto& question : one.questions)
    if (!question.words.empty()) check_scene(one, question);
  return one;
}

std::vector<Case> read_cases(const fs::path& folder, const std::vector<std::string>& named) {
  std::map<std::string, fs::path> by_name;
  std::multimap<std::string, std::string> by_group;
  std::error_code problem;
  for (const auto& entry : fs::recursive_directory_iterator(folder, problem)) {
    if (entry.path().extension() != ".toml") continue;
    const auto name = entry.path().stem().string();
    if (const auto [known, added] = by_name.emplace(name, entry.path()); !added)
      throw InputError(fmt::format("{} and {} have the same name; a case is known by it", known->second.string(),
                                   entry.path().string()));
    by_group.emplace(entry.path().parent_path().filename().string(), name);
  }
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
    if (by_name.contains(cases.back().name) && by_name.at(cases.back().name) == path)
      cases.back().shown = (fs::path("cases") / fs::relative(path, folder)).string();
    if (!names.insert(cases.back().name).second)
      throw InputError(fmt::format("{}: another case is called '{}' too", path.string(), cases.back().name));
  }
  return cases;
}

}  // namespace rosin::app::verify
