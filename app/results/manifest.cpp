/// Manifests, and what is printed of work that has no result.
#include "app/results/manifest.hpp"

#include <ctime>

#include "app/results/writers.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/toml_document.hpp"
#include "app/tasks/lab.hpp"

namespace rosin::app::results {

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

ordered_json document_of(const scene::Scene& scene, const Manifest& manifest) {
  auto document = head(scene, manifest.verb, manifest.outcome);
  document["date"] = utc_now();
  document["scene"] = scene.path;
  if (scene.task<tasks::Lab>().experiment) document["experiment"] = scene.task<tasks::Lab>().experiment->name;
  document["overrides"] = manifest.overrides;
  document["scene_resolved"] = scene.resolved;
  auto& parameters = document["parameters"] = ordered_json::object();
  if (scene.model.law) {
    // The model's slider, and of a string its drive, are defaults beside another oscillator.
    const auto type =
        scene::parse_toml(scene.resolved, scene.path)["oscillator"]["type"].value_or(std::string("slider"));
    const auto is_its_own = [&](const std::string& path) {
      return type == "slider" || (!path.starts_with("oscillator.") && !(scene.string && path.starts_with("drive.")));
    };
    for (const auto& quantity : scene.model.parameters())
      if (is_its_own(quantity.name))
        parameters[quantity.name] = {{"value", scene.model.get(quantity.name)}, {"unit", quantity.unit}};
  }
  document["tolerance"] = {{"asked", manifest.tolerance_asked}, {"reached", manifest.tolerance_reached}};
  document["cost"] = manifest.cost;
  document["files"] = manifest.files;
  document["scripts"] = manifest.scripts;
  document["notes"] = scene.notes;
  return document;
}

std::string to_json(const scene::Scene& scene, const Manifest& manifest) { return text(document_of(scene, manifest)); }

std::string to_json(const std::string& verb, const Outcome& outcome) {
  return text({{"title", ""},
               {"verb", verb},
               {"version", ROSIN_VERSION},
               {"schema", schema},
               {"outcome", name(outcome.ending)},
               {"outcome_detail", outcome.detail},
               {"datasets", ordered_json::array()},
               {"notes", ordered_json::array()}});
}

}  // namespace rosin::app::results
