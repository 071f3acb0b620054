/// Manifests, and what documents have in common.
#include "app/output/results.hpp"

#include <ctime>

#include "analysis/cycles/cycle.hpp"
#include "analysis/planes/map.hpp"
#include "app/output/json.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/lab.hpp"

namespace rosin::app::output {

ordered_json values(const std::vector<Quantity>& names, const std::vector<Value>& list) {
  auto object = ordered_json::object();
  for (std::size_t i = 0; i < names.size(); ++i)
    std::visit([&](const auto& value) { object[names[i].name] = value; }, list[i]);
  return object;
}

ordered_json states(const FrictionLaw& law, std::span<const double> state) {
  auto object = ordered_json::object();
  for (std::size_t i = 0; i < state.size(); ++i) object[law.states()[i].name] = state[i];
  return object;
}

ordered_json axis(const analysis::planes::Axis& axis, const scene::Scene& scene) {
  return {{"parameter", axis.parameter},
          {"unit", scene.describe(axis.parameter).unit},
          {"scale", axis.logarithmic ? "log" : "linear"},
          {"values", axis.values}};
}

namespace {

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char buffer[32];
  std::strftime(buffer, sizeof buffer, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return buffer;
}

}  // namespace

std::string to_json(const scene::Scene& scene, const Manifest& manifest) {
  auto document = begin(scene, manifest.verb.c_str(), manifest.outcome);
  document["date"] = utc_now();
  document["scene"] = scene.path;
  if (scene.task<tasks::Lab>().experiment) document["experiment"] = scene.task<tasks::Lab>().experiment->name;
  document["overrides"] = manifest.overrides;
  document["scene_resolved"] = scene.resolved;
  auto& parameters = document["parameters"] = ordered_json::object();
  if (scene.model.law)
    for (const auto& quantity : scene.model.parameters())
      parameters[quantity.name] = {{"value", scene.model.get(quantity.name)}, {"unit", quantity.unit}};
  document["tolerance"] = {{"asked", manifest.tolerance_asked}, {"reached", manifest.tolerance_reached}};
  document["cost"] = manifest.cost;
  document["files"] = manifest.files;
  document["scripts"] = manifest.scripts;
  document["notes"] = scene.notes;
  return text(document);
}

std::string to_json(const std::string& verb, const Outcome& outcome) {
  return text({{"verb", verb},
               {"version", ROSIN_VERSION},
               {"outcome", name(outcome.ending)},
               {"outcome_detail", outcome.detail}});
}

}  // namespace rosin::app::output
