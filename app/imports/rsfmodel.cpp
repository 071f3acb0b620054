/// Scripts for rsfmodel: Leeman, May, Marone and Saffer (2016), github.com/jrleeman/rsfmodel. Lengths are in um, times
/// in s, stiffness is friction per um. rsfmodel starts at friction mu0 with steady states, which is sliding at vref
/// whatever model.v says, and holds the velocity of the load point from each time of model.time to the next.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "app/imports/format.hpp"
#include "app/imports/parameters.hpp"
#include "core/error.hpp"

namespace rosin::app::imports {

namespace {

/// A state relation, rosin's law of one, and of two.
struct Relation {
  const char *name, *one, *two;
};
constexpr std::array relations = {Relation{"DieterichState", "ageing", "two-state-ageing"},
                                  Relation{"RuinaState", "slip", "two-state-slip"},
                                  Relation{"PrzState", "prz", nullptr}, Relation{"NagataState", "nagata", nullptr}};

class Translation {
 public:
  Translation(const std::string& path, std::string_view text)
      : script_(read_python(path, text)),
        scene_(fmt::format("{}, a script for rsfmodel", path.substr(path.rfind('/') + 1))) {}

  SceneText scene() {
    find_model();
    find_relations();
    law();
    scene_.table("oscillator");
    scene_.key("mass", "0", {"rsfmodel is quasi-static", 0});
    const auto k = of_model("k", "stiffness of the machine, friction per um");
    scene_.key("stiffness", quantity(k.value, "N/um"), k.origin("friction per um; N/um at a load of 1 N"));
    drive_and_run();
    return std::move(scene_);
  }

 private:
  void find_model() {
    for (const auto& [name, slot] : script_.variables.slots) {
      const auto record = record_of(slot.value);
      if (!record || record->type != "Model") continue;
      if (model_ && model_ != record)
        script_.refuse(slot.line, fmt::format("is a second model beside '{}'; one scene is one model", model_name_));
      model_ = record, model_name_ = name;
    }
    if (!model_)
      throw InputError(fmt::format("{}: holds no rsf.Model() outside of functions, which are not run", script_.path()));
    const std::array known = {"mu0", "a", "k", "v", "vref", "state_relations", "time", "loadpoint_velocity"};
    const std::set<std::string> results = {"results", "solver_info", "critical_times", "mu", "dmu_dt"};
    script_.refuse(model_->changed);
    for (const auto& [name, slot] : model_->slots) {
      if (std::ranges::find(known, name) != known.end() || results.contains(name)) continue;
      const auto near = nearest_name(name, std::vector<std::string>(known.begin(), known.end()));
      script_.refuse(slot.line, fmt::format("names '{}', which a Model of rsfmodel has not{}", name,
                                            near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
    }
  }

  Parameter of_model(std::string_view name, std::string_view meaning) const {
    return required(script_, *model_, name, fmt::format("{}.{}", model_name_, name), meaning);
  }

  void find_relations() {
    const auto found = model_->slots.find("state_relations");
    if (found == model_->slots.end())
      throw InputError(
          fmt::format("{}: {}.state_relations is not given (which states friction has)", script_.path(), model_name_));
    relations_line_ = found->second.line;
    const auto* list = found->second.value.as<std::shared_ptr<List>>();
    if (list) script_.refuse((*list)->changed);
    if (!list || (*list)->values.empty())
      script_.refuse(relations_line_,
                     "needs a list of states, such as [state1], made by rsf.DieterichState() and others");
    for (const auto& element : (*list)->values) {
      const auto record = record_of(element);
      const auto relation =
          record ? std::ranges::find_if(relations, [&](const auto& one) { return record->type == one.name; })
                 : relations.end();
      if (relation == relations.end())
        script_.refuse(
            relations_line_,
            "names a state that is none of rsfmodel's own (DieterichState, RuinaState, PrzState, NagataState); "
            "a law of your own is a law from text in rosin, docs/formula-laws.md");
      script_.refuse(record->changed);
      for (const auto& [key, slot] : record->slots)
        if (key != "b" && key != "Dc" && key != "c" && key != "state")
          script_.refuse(slot.line, fmt::format("names '{}', which a state of rsfmodel has not", key));
      states_.push_back({record->name.empty() ? "state" : record->name, record, &*relation});
    }
  }

  Parameter of_state(std::size_t i, std::string_view name, std::string_view meaning) const {
    return required(script_, *states_[i].record, name, fmt::format("{}.{}", states_[i].name, name), meaning);
  }

  void law() {
    const auto* kind = states_.front().relation;
    const bool alike = std::ranges::all_of(states_, [&](const auto& state) { return state.relation == kind; });
    const char* type = states_.size() == 1 ? kind->one : states_.size() == 2 && alike ? kind->two : nullptr;
    if (!type)
      script_.refuse(relations_line_,
                     "joins states that no law of rosin joins: one of any kind, two DieterichState, or "
                     "two RuinaState; others as a law from text, docs/formula-laws.md");
    std::string listed;
    for (const auto& state : states_)
      listed += fmt::format("{}{} = {}()", listed.empty() ? "" : ", ", state.name, state.relation->name);
    scene_.table("law");
    scene_.key("type", as_text(type), {listed, relations_line_});
    auto mu0 =
        parameter(script_, *model_, "mu0", model_name_ + ".mu0").value_or(Parameter{0.6, 0, model_name_ + ".mu0"});
    const auto a = of_model("a", "direct effect");
    vref_ = of_model("vref", "reference velocity, um/s");
    scene_.key("mu0", number(mu0.value), mu0.origin());
    scene_.key("a", number(a.value), a.origin());
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const auto suffix = states_.size() > 1 ? fmt::format("{}", i + 1) : std::string();
      const auto b = of_state(i, "b", "evolution effect"), Dc = of_state(i, "Dc", "slip that renews the contacts, um");
      scene_.key("b" + suffix, number(b.value), b.origin());
      scene_.key("L" + suffix, quantity(Dc.value, "um"), Dc.origin("um"));
      if (std::string_view(kind->one) == "nagata") {
        const auto c = of_state(i, "c", "weakening by stress");
        scene_.key("c", number(c.value), c.origin());
      } else if (states_[i].record->slots.contains("c")) {
        script_.refuse(states_[i].record->slots.find("c")->second.line, "is a number of NagataState alone");
      }
      if (const auto state = states_[i].record->slots.find("state"); state != states_[i].record->slots.end())
        scene_.left_out(fmt::format("{}.state (line {})", states_[i].name, state->second.line),
                        "rsfmodel sets states to steady sliding before it solves");
    }
    scene_.key("v0", quantity(vref_.value, "um/s"), vref_.origin("um/s"));
    const auto v = parameter(script_, *model_, "v", model_name_ + ".v");
    if (v && std::string_view(kind->one) == "prz" && v->value != vref_.value)
      script_.refuse(v->line, fmt::format("differs from {0}.vref = {1}: PrzState then starts away from steady sliding; "
                                          "make them equal, or set run.start yourself",
                                          model_name_, vref_.value));
    if (v && v->value != vref_.value)
      scene_.left_out(v->origin("um/s").was,
                      "rsfmodel starts with friction mu0 and steady states, which is sliding at vref");
  }

  std::vector<double> series(std::string_view name, int& line) const {
    const auto found = model_->slots.find(name);
    const auto shown = fmt::format("{}.{}", model_name_, name);
    if (found == model_->slots.end()) throw InputError(fmt::format("{}: {} is not given", script_.path(), shown));
    line = found->second.line;
    const auto& value = found->second.value;
    if (const auto* unknown = value.as<Unknown>())
      script_.refuse(line, fmt::format("gives {}, but {}", shown, unknown->why));
    std::vector<double> numbers;
    if (const auto* vector = value.as<std::shared_ptr<Vector>>()) {
      script_.refuse((*vector)->changed);
      numbers = (*vector)->numbers;
    } else if (const auto* list = value.as<std::shared_ptr<List>>()) {
      script_.refuse((*list)->changed);
      for (const auto& one : (*list)->values) numbers.push_back(one.as<double>() ? *one.as<double>() : NAN);
    }
    if (numbers.size() < 2) script_.refuse(line, fmt::format("gives {}, which has to be two numbers or more", shown));
    for (const double one : numbers)
      if (!std::isfinite(one))
        script_.refuse(line, fmt::format("gives {}, of which not every number is finite", shown));
    return numbers;
  }

  void drive_and_run() {
    int time_line = 0, speed_line = 0;
    const auto time = series("time", time_line), speed = series("loadpoint_velocity", speed_line);
    if (time.size() != speed.size())
      script_.refuse(speed_line, fmt::format("gives {} velocities for {} times", speed.size(), time.size()));
    for (std::size_t i = 1; i < time.size(); ++i)
      if (!(time[i] > time[i - 1])) script_.refuse(time_line, "gives times that do not ascend");
    std::string steps;
    std::size_t changes = 0;
    constexpr std::size_t most = 1000;
    for (std::size_t i = 0; i < speed.size(); ++i) {
      if (i > 0 && speed[i] == speed[i - 1]) continue;
      if (++changes > most)
        script_.refuse(speed_line,
                       fmt::format("changes the velocity more than {} times; write it as a file of time and "
                                   "velocity, and drive.speed = {{ table = \"FILE\" }}",
                                   most));
      steps += fmt::format("{}[{}, {}]", i == 0 ? "" : ", ", number(time[i] - time[0]), quantity(speed[i], "um/s"));
    }
    scene_.table("drive");
    scene_.key("speed", changes == 1 ? quantity(speed[0], "um/s") : fmt::format("{{ steps = [{}] }}", steps),
               {fmt::format("{}.loadpoint_velocity, um/s, held from each time to the next", model_name_), speed_line});
    scene_.key("normal_load", "1", {"rsfmodel has no load: forces are coefficients of friction", 0});

    scene_.table("run");
    const double duration = time.back() - time.front();
    const std::size_t intervals = time.size() - 1;
    bool even = true;
    for (std::size_t i = 0; i < time.size() && even; ++i)
      even = std::abs(time[i] - time[0] - duration * static_cast<double>(i) / static_cast<double>(intervals)) <=
             1e-9 * duration;
    const auto shown = fmt::format("{}.time, s, {} samples", model_name_, time.size());
    if (even) {
      scene_.key("duration", number(duration), {shown, time_line});
      scene_.key("samples", fmt::format("{}", intervals), {shown, time_line});
    } else {
      std::string times;
      for (const double t : time) times += fmt::format("{}{}", times.empty() ? "" : ", ", number(t - time[0]));
      scene_.key("times", fmt::format("[{}]", times), {shown, time_line});
    }
    if (time[0] != 0)
      scene_.left_out(fmt::format("{}.time begins at {} s (line {})", model_name_, number(time[0]), time_line),
                      "the scene begins at 0");
    scene_.key(
        "start", fmt::format("{{ slip_rate = {} }}", quantity(vref_.value, "um/s")),
        {fmt::format("friction {}.mu0 and steady states: sliding at {}.vref", model_name_, model_name_), vref_.line});
  }

  struct State {
    std::string name;
    std::shared_ptr<Record> record;
    const Relation* relation;
  };
  Script script_;
  SceneText scene_;
  std::shared_ptr<Record> model_;
  std::string model_name_;
  std::vector<State> states_;
  int relations_line_ = 0;
  Parameter vref_;
};

int likeness(std::string_view text) {
  int found = 0;
  for (const char* word : {"rsfmodel", "state_relations", "loadpoint_velocity", "DieterichState", "RuinaState"})
    found += text.find(word) != std::string_view::npos ? 2 : 0;
  return found;
}

SceneText translate(const std::string& path, std::string_view text) { return Translation(path, text).scene(); }

}  // namespace

Format rsfmodel_format() { return {"rsfmodel", "a Python script of rsfmodel", likeness, translate}; }

}  // namespace rosin::app::imports
