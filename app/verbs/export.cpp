/// The verb export: the series of a run in another program's columns.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "app/exports/series.hpp"
#include "app/output/document.hpp"
#include "app/program_list.hpp"
#include "app/scene/scene_table.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/verb.hpp"
#include "app/verbs/verbs.hpp"
#include "core/console.hpp"
#include "core/error.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;

/// ∫ of a signal from `from` to `to`, piece by piece.
double integral(const Signal& signal, double from, double to) {
  double sum = 0;
  for (double t = from; t < to;) {
    const double next = std::min(signal.next_break(t), to), length = next - t;
    const auto piece = signal.piece(t);
    sum += piece.value * length + piece.rate * length * length / 2;
    for (const auto& [amplitude, frequency, phase] : piece.terms)
      sum += frequency == 0
                 ? amplitude * std::cos(phase) * length
                 : amplitude / frequency * (std::sin(frequency * next + phase) - std::sin(frequency * t + phase));
    t = next;
  }
  return sum;
}

exports::Series series_of(const fs::path& folder) {
  const auto read = [&](const char* name) {
    constexpr std::uintmax_t largest = 2'000'000'000;  // bytes
    const auto path = folder / name;
    return output::parse_document(path.string(), read_found(path, largest));
  };
  const auto result = read("run.json"), manifest = read("run.manifest.json");
  exports::Series series;
  try {
    series.title = result.value("title", "");
    series.time = result.at("time").get<std::vector<double>>();
    const auto& columns = result.at("columns");
    std::vector<std::string> known;
    for (const auto& [name, to] :
         {std::pair{"slip_rate", &series.slip_rate}, std::pair{"velocity", &series.velocity},
          std::pair{"displacement", &series.displacement}, std::pair{"friction_force", &series.friction_force},
          std::pair{"friction_coefficient", &series.friction_coefficient}}) {
      if (!columns.contains(name))
        throw InputError(fmt::format("{}: has no column {}; only runs of one slider are exported",
                                     (folder / "run.json").string(), name));
      *to = columns.at(name).get<std::vector<double>>();
    }
    Request request;
    request.verb = "run";
    request.target = manifest.value("scene", "");
    request.text = manifest.at("scene_resolved").get<std::string>();
    const auto scene = read_scene(request);
    for (const auto& state : scene.model.law->states())
      if (columns.contains(state.name))
        series.states.push_back({state.name, columns.at(state.name).get<std::vector<double>>()});
    series.stiffness = scene.model.slider.stiffness;
    series.area = scene::Reference(scene::parse_toml(*request.text, request.target)).area().value_or(1);
    const auto& drive = scene.model.drive;
    double before = 0, way = 0;
    for (const double t : series.time) {
      way += integral(drive.speed, before, t);
      before = t;
      series.load_displacement.push_back(way);
      series.normal_load.push_back(drive.normal_load.value(t));
    }
  } catch (const nlohmann::ordered_json::exception&) {
    throw InputError(fmt::format("{}: is no result that rosin wrote", (folder / "run.json").string()));
  }
  const auto whole = [&](const std::vector<double>& column) { return column.size() == series.time.size(); };
  if (series.time.empty() || !whole(series.slip_rate) || !whole(series.velocity) || !whole(series.displacement) ||
      !whole(series.friction_force) || !whole(series.friction_coefficient) ||
      !std::ranges::all_of(series.states, [&](const auto& state) { return whole(state.values); }))
    throw InputError(fmt::format("{}: its columns differ in length", (folder / "run.json").string()));
  return series;
}

Status print_export(const Request& request) {
  std::vector<std::string> names;
  const exports::Format* chosen = nullptr;
  for (const auto& format : exports::formats()) {
    names.emplace_back(format.name);
    if (request.as == format.name) chosen = &format;
  }
  if (!chosen)
    throw InputError(request.as.empty()
                         ? fmt::format("--as is missing; there are {}", fmt::join(names, ", "))
                         : fmt::format("--as {} is no format that is written{}; there are {}", request.as,
                                       scene::suggestion(request.as, names), fmt::join(names, ", ")));
  const fs::path folder = request.target;
  if (!fs::exists(folder / "run.json"))
    throw InputError(fmt::format("{}: holds no run; compute one first, such as with 'rosin run scene.toml'",
                                 (folder / "").string()));
  print("{}", chosen->text(series_of(folder)));
  return done;
}

}  // namespace

Verb export_verb() {
  return {.name = "export",
          .help = "print the series of a run in the columns of another program",
          .example = "rosin export out/slide-hold-slide --as rsfmodel > results.csv",
          .operands = {{"DIR", &Request::target, "results folder of a run"}},
          .options = {{"--as", &Request::as, "the program: " + listed(exports::formats())}},
          .without_scene = print_export};
}

}  // namespace rosin::app::verbs
