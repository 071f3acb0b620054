/// Reading [fit]: parameters, candidates, and tables of data.
#include "app/verbs/fit_scene.hpp"

#include "app/scene/law.hpp"
#include "app/scene/scene_table.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;
using analysis::inference::Measurement;
using Kind = Measurement::Kind;

/// What a kind of measurement is read from: x, then y, in columns with these names unless the scene has others.
struct KindOfData {
  const char* name;
  Kind kind;
  struct Column {
    const char *name, *si;
  };
  std::vector<Column> columns;
};
const std::vector<KindOfData>& kinds() {
  static const std::vector<KindOfData> list = {
      {"frequency-response",
       Kind::frequency_response,
       {{"frequency", "Hz"}, {"real", "N s/m"}, {"imaginary", "N s/m"}}},
      {"velocity-step", Kind::velocity_step, {{"time", "s"}, {"friction_coefficient", "1"}}},
      {"steady-curve", Kind::steady_curve, {{"slip_rate", "m/s"}, {"friction_coefficient", "1"}}},
      {"hold", Kind::hold, {{"hold_time", "s"}, {"friction_coefficient", "1"}}}};
  return list;
}

Measurement read_data(const toml::node& node, scene::Scene& scene, const fs::path& folder) {
  scene::Table table(node, "fit.data");
  table.expect({"type", "file", "columns", "standard_error", "speed", "from", "to", "normal_load", "low", "high",
                "names_line", "decimal"});
  std::vector<std::string> names;
  for (const auto& kind : kinds()) names.emplace_back(kind.name);
  const auto type = scene::choice(table.required("type", "what was measured"), table.path("type"), names);
  const auto& kind = *std::ranges::find_if(kinds(), [&](const auto& k) { return k.name == type; });
  Measurement data;
  data.kind = kind.kind;
  data.slip_rate = data.next_slip_rate = scene.model.drive.speed.level();
  data.normal_load = scene.model.drive.normal_load.level();
  const Quantity speed{"", "m/s", {1e-15, 1e4}, "slip rate"};
  if (kind.kind == Kind::velocity_step) {
    table.required("from", "slip rate before the step, m/s");
    table.required("to", "slip rate after the step, m/s");
    table.read("from", data.slip_rate, speed);
    table.read("to", data.next_slip_rate, speed);
  } else {
    table.read("speed", data.slip_rate, speed);
  }
  table.read("normal_load", data.normal_load, {"", "N", {1e-15, 1e15}, "normal load"});
  double low = -infinity, high = infinity;
  table.read("low", low, {"", kind.columns.front().si, {-1e300, 1e300}, "points below are left out"});
  table.read("high", high, {"", kind.columns.front().si, {-1e300, 1e300}, "points above are left out"});

  auto source = scene::read_file(table, folder);
  const auto& file_node = *table.find("file");
  data.name = source.file.filename().string();
  source.gaps = true;
  auto columns = table.table("columns");
  for (const auto& column : kind.columns) {
    const auto* given = columns ? columns->find(column.name) : nullptr;
    source.columns.push_back(given ? scene::read_column(*given, columns->path(column.name), column.si)
                                   : scene::RecordColumn{column.name, "", column.si});
  }
  if (columns) columns->finish();
  const auto& error = table.required("standard_error", "of each number: a value, or the name of a column");
  const bool by_column =
      error.is_table() || (error.is_string() && !std::isdigit(static_cast<unsigned char>(error.as_string()->get()[0])));
  double constant = 0;
  if (by_column)
    source.columns.push_back(scene::read_column(error, table.path("standard_error"), kind.columns.back().si));
  else
    constant =
        scene::number(error, {table.path("standard_error"), kind.columns.back().si, {1e-300, 1e300}, "standard error"});
  table.finish();
  scene::located(file_node.source(), [&] {
    std::vector<std::vector<double>> values(source.columns.size());
    const auto end = scene::read_record(source, [&](double, std::span<const std::span<const double>> block) {
      for (std::size_t c = 0; c < block.size(); ++c)
        values[c].insert(values[c].end(), block[c].begin(), block[c].end());
    });
    if (end.gaps > 0)
      scene.notes.push_back(
          fmt::format("{}: {} of {} rows lack a number and are left out", data.name, end.gaps, end.samples));
    for (std::size_t i = 0; i < values[0].size(); ++i) {
      if (std::ranges::any_of(values, [&](const auto& column) { return std::isnan(column[i]); })) continue;
      if (values[0][i] < low || values[0][i] > high) continue;
      data.x.push_back(values[0][i]);
      for (std::size_t c = 1; c < kind.columns.size(); ++c) {
        data.y.push_back(values[c][i]);
        data.error.push_back(by_column ? values.back()[i] : constant);
      }
    }
    if (data.x.empty()) throw InputError(fmt::format("{}: holds no point between low and high", data.name));
  });
  return data;
}

}  // namespace

void read_fit(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  auto& task = scene.fit;
  auto& options = task.options;
  table.expect({"parameters", "data", "candidates", "starts", "seed", "profiles", "folds", "confidence"});
  const auto read_parameters = [](const toml::node& node, const std::string& path, const oscillators::Model& model) {
    const auto paths = scene::texts(node, path);
    for (std::size_t i = 0; i < paths.size(); ++i)
      scene::located(node.as_array()->get(i)->source(),
                     [&] { analysis::inference::require_fittable(model, paths[i]); });
    if (paths.empty()) scene::fail(node.source(), "{} is empty", path);
    return paths;
  };
  task.candidates.push_back(
      {std::string(scene.model.law->card().name), scene.model,
       read_parameters(table.required("parameters", "paths, such as law.a"), "fit.parameters", scene.model)});
  if (const auto* candidates = table.find("candidates"))
    for (const auto& element : scene::list(*candidates, "fit.candidates", "tables", scene::most_names)) {
      scene::Table keys(element, "fit.candidates");
      keys.expect({"name", "law", "parameters"});
      scene::FitTask::Candidate candidate{"", scene.model, {}};
      candidate.model.lambda = 1;
      candidate.model.contact_stiffness = {};
      candidate.model.load_memory = 0;
      const auto& law = keys.required("law", "the friction law");
      scene::read_law(reader, scene::Table(law, "fit.candidates.law"), candidate.model);
      candidate.name = candidate.model.law->card().name;
      if (const auto* name = keys.find("name")) candidate.name = scene::text(*name, keys.path("name"));
      candidate.parameters =
          read_parameters(keys.required("parameters", "paths"), "fit.candidates.parameters", candidate.model);
      keys.finish();
      for (const auto& other : task.candidates)
        if (other.name == candidate.name)
          scene::fail(element.source(), "fit.candidates: two are named '{}'; give one of them a name", candidate.name);
      task.candidates.push_back(std::move(candidate));
    }
  const auto& data = table.required("data", "tables with type and file");
  for (const auto& element : scene::list(data, "fit.data", "tables", scene::most_names))
    task.data.push_back(read_data(element, scene, reader.folder));
  if (task.data.empty()) scene::fail(data.source(), "fit.data is empty");
  table.read("starts", options.starts, 1, 1000, "starts of the least squares");
  int seed = 1;
  table.read("seed", seed, 0, scene::largest_seed, "of the random starts");
  options.seed = std::uint64_t(seed);
  table.read("folds", options.folds, 0, 1000, "of cross-validation");
  table.read("confidence", options.confidence, {"", "1", {0.5, 0.9999}, "of intervals"});
  if (const auto* profiles = table.find("profiles")) {
    if (!profiles->is_boolean()) scene::wrong_kind(*profiles, "fit.profiles", "true or false");
    options.profiles = *profiles->value<bool>();
  }
  table.finish();
}

}  // namespace rosin::app::verbs
