/// The list of experiments, and settings by name.
#include "analysis/lab/experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "analysis/lab/machine.hpp"

namespace rosin::analysis::lab {

namespace {

std::string hint(std::string_view name, const std::vector<std::string>& known) {
  const auto near = nearest_name(name, known);
  return near.empty() ? fmt::format("; known: {}", fmt::join(known, ", ")) : fmt::format("; did you mean '{}'?", near);
}

}  // namespace

Settings::Settings(const std::vector<Setting>& known) {
  for (const auto& setting : known) {
    known_.push_back(setting.quantity);
    if (setting.value) values_[setting.quantity.name] = *setting.value;
  }
}

const Quantity& Settings::describe(std::string_view name) const {
  const auto at = std::ranges::find(known_, name, &Quantity::name);
  if (at != known_.end()) return *at;
  std::vector<std::string> names;
  for (const auto& quantity : known_) names.push_back(quantity.name);
  throw InputError(fmt::format("the experiment has no setting '{}'{}", name, hint(name, names)));
}

void Settings::set(std::string_view name, Value value) {
  const auto& quantity = describe(name);
  const auto* list = std::get_if<std::vector<double>>(&value);
  if (bool(list) != quantity.is_list)
    throw InputError(fmt::format("lab.{} takes {} ({}, {})", name,
                                 quantity.is_list ? "a list of numbers" : "one number", quantity.meaning,
                                 readable_unit(quantity.unit)));
  const auto path = fmt::format("lab.{}", name);
  if (list)
    for (const double x : *list) require(x, quantity.range, path, quantity.meaning, quantity.unit);
  else
    require(std::get<double>(value), quantity.range, path, quantity.meaning, quantity.unit);
  if (list && list->empty()) throw InputError(fmt::format("{} is empty ({})", path, quantity.meaning));
  values_[std::string(name)] = std::move(value);
}

double Settings::number(std::string_view name) const {
  const auto& quantity = describe(name);
  if (!given(name)) throw InputError(fmt::format("[lab] has no '{}' ({})", name, quantity.meaning));
  return std::get<double>(values_.at(std::string(name)));
}

const std::vector<double>& Settings::list(std::string_view name) const {
  const auto& quantity = describe(name);
  if (!given(name)) throw InputError(fmt::format("[lab] has no '{}' ({})", name, quantity.meaning));
  return std::get<std::vector<double>>(values_.at(std::string(name)));
}

const Reading& Result::reading(std::string_view name) const {
  const auto at = std::ranges::find(readings, name, &Reading::name);
  if (at != readings.end()) return *at;
  std::vector<std::string> names;
  for (const auto& reading : readings) names.push_back(reading.name);
  throw InputError(fmt::format("the experiment has no reading '{}'{}", name, hint(name, names)));
}

void Experiment::require_served(const Task& task) const {
  if (task.string && !takes_string)
    throw InputError(fmt::format(
        "'{}' is no experiment on a string, which vibrates under the bow at all speeds, so that no friction "
        "of steady sliding is there to be read; 'lab inverse' has its friction from the forces at its "
        "ends, and 'sweep' its motions over speed or load of the bow",
        name));
  if (task.structure && !only_slider.empty())
    throw InputError(fmt::format("'{}' is an experiment on a slider: {}", name, only_slider));
}

Result Experiment::perform(const Task& task) const {
  require_served(task);
  try {
    return protocol(task);
  } catch (NothingRecorded& end) {
    return std::move(end.result);
  }
}

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> list = {
      inclined_plane(), impulse(),   velocity_step(),      slide_hold_slide(), spring_pulled(),
      reciprocation(),  ring_down(), frequency_response(), inverse(),
  };
  return list;
}

const Experiment& find_experiment(std::string_view name) {
  const auto at = std::ranges::find(experiments(), name, &Experiment::name);
  if (at != experiments().end()) return *at;
  std::vector<std::string> names;
  for (const auto& experiment : experiments()) names.emplace_back(experiment.name);
  throw InputError(fmt::format("unknown experiment '{}'{}", name, hint(name, names)));
}

Task task_for(const Experiment& experiment, std::shared_ptr<const FrictionLaw> law) {
  Task task{.model = {}, .settings = Settings(experiment.settings)};
  task.model.law = std::move(law);
  task.model.slider = experiment.slider;
  task.model.drive = experiment.drive;
  return task;
}

std::vector<std::string> column_names(const Experiment& experiment, const Task& task) {
  if (task.string) return {"bridge_force", "nut_force"};
  auto names = machine_of(task)->column_names();
  names.insert(names.end(), experiment.extra_columns.begin(), experiment.extra_columns.end());
  return names;
}

}  // namespace rosin::analysis::lab
