/// Reading [fit]: parameters, candidates, and tables of data.
#include "app/verbs/fit_scene.hpp"

#include <cmath>

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
      {"hold", Kind::hold, {{"hold_time", "s"}, {"friction_coefficient", "1"}}},
      {"record", Kind::record, {{"time", "s"}, {"friction_coefficient", "1"}}}};
  return list;
}

/// Keys that only some kinds of measurement listen to.
void refuse_without_effect(scene::Table& table, const KindOfData& kind) {
  const struct {
    const char* key;
    std::vector<Kind> kinds;
  } listeners[] = {{"speed", {Kind::frequency_response, Kind::hold}},
                   {"from", {Kind::velocity_step}},
                   {"to", {Kind::velocity_step}},
                   {"steps", {Kind::velocity_step}},
                   {"step_at", {Kind::velocity_step}},
                   {"over", {Kind::velocity_step}},
                   {"trend", {Kind::velocity_step, Kind::record}},
                   {"clock_offset", {Kind::velocity_step, Kind::record}},
                   {"base", {Kind::velocity_step, Kind::record, Kind::steady_curve, Kind::hold}}};
  for (const auto& [key, those] : listeners)
    if (const auto* node = table.find(key); node && std::ranges::find(those, kind.kind) == those.end())
      scene::fail(node->source(), "{} has no effect on a {}", table.path(key), kind.name);
}

bool truth(scene::Table& table, const char* key) {
  const auto* node = table.find(key);
  if (!node) return false;
  if (!node->is_boolean()) scene::wrong_kind(*node, table.path(key), "true or false");
  return *node->value<bool>();
}

/// Of a velocity step: its program, over time or over the displacement that is imposed.
void read_program(scene::Table& table, KindOfData& kind, const Quantity& speed, Measurement& data) {
  if (const auto* over = table.find("over"))
    if (scene::choice(*over, table.path("over"), {"time", "displacement"}) == "displacement") {
      data.over = Measurement::Over::displacement;
      kind.columns.front() = {"displacement", "m"};
    }
  const auto* unit = kind.columns.front().si;
  table.required("from", "slip rate before the step, m/s");
  table.read("from", data.slip_rate, speed);
  const Quantity at{"", unit, {-1e15, 1e15}, "of a step"};
  if (const auto* steps = table.find("steps")) {
    for (const char* key : {"to", "step_at"})
      if (const auto* other = table.find(key))
        scene::fail(other->source(), "{}: steps say it already", table.path(key));
    std::vector<Measurement::Step> program;
    const auto path = table.path("steps");
    for (const auto& element : scene::list(*steps, path, "pairs [at, slip rate]", scene::most_names)) {
      const auto& pair = scene::list(element, path, "a place and a slip rate");
      if (pair.size() != 2) scene::fail(element.source(), "{}: each step is [at, slip rate]", path);
      auto place = at, rate = speed;
      place.name = rate.name = path;
      program.push_back({scene::number(*pair.get(0), place), scene::number(*pair.get(1), rate)});
      if (program.size() > 1 && !(program.back().at > program[program.size() - 2].at))
        scene::fail(element.source(), "{}: the steps must follow each other", path);
    }
    if (program.empty()) scene::fail(steps->source(), "{} is empty", path);
    data.step_at = program.front().at, data.next_slip_rate = program.front().slip_rate;
    data.later.assign(program.begin() + 1, program.end());
  } else {
    table.required("to", "slip rate after the step, m/s (or steps = [[at, slip rate], ...])");
    table.read("to", data.next_slip_rate, speed);
    table.read("step_at", data.step_at, at);
  }
}

/// What a laboratory adds to friction.
void read_terms(scene::Table& table, Measurement& data) {
  using Trend = Measurement::Terms::Trend;
  if (const auto* trend = table.find("trend")) {
    if (trend->is_boolean())
      data.terms.trend = !*trend->value<bool>()                         ? Trend::none
                         : data.over == Measurement::Over::displacement ? Trend::displacement
                                                                        : Trend::time;
    else if (trend->is_string())
      data.terms.trend = scene::choice(*trend, table.path("trend"), {"time", "displacement"}) == "time"
                             ? Trend::time
                             : Trend::displacement;
    else
      scene::wrong_kind(*trend, table.path("trend"), "true, \"time\" or \"displacement\"");
  }
  data.terms.base = truth(table, "base");
  data.terms.clock_offset = truth(table, "clock_offset");
}

bool has_column(scene::RecordSource source, const scene::RecordColumn& column) {
  struct Found {};
  source.columns = {column};
  try {
    scene::read_record(source, [](double, std::span<const std::span<const double>>) { throw Found{}; });
  } catch (const Found&) {
    return true;
  } catch (const InputError&) {
  }
  return false;
}

/// The columns of a record beside time and friction: those that move and load it, of which a file has one or the other.
struct MotionColumns {
  bool displacement = false, normal_load = false;
  std::vector<scene::RecordColumn> columns;
};
MotionColumns choose_columns(KindOfData& kind, std::optional<scene::Table>& columns, const scene::RecordSource& source,
                             Measurement& data) {
  const auto column = [&](const char* name, const char* si) {
    const auto* given = columns ? columns->find(name) : nullptr;
    return given ? scene::read_column(*given, columns->path(name), si) : scene::RecordColumn{name, "", si};
  };
  const auto there = [&](const char* name, const char* si) {
    return (columns && columns->find(name)) || has_column(source, column(name, si));
  };
  data.in_force = !there("friction_coefficient", "1") && there("friction_force", "N");
  if (data.in_force) kind.columns.back() = {"friction_force", "N"};
  MotionColumns motion;
  motion.displacement = !there("slip_rate", "m/s") && there("displacement", "m");
  motion.columns.push_back(motion.displacement ? column("displacement", "m") : column("slip_rate", "m/s"));
  motion.normal_load = there("normal_load", "N");
  if (motion.normal_load) motion.columns.push_back(column("normal_load", "N"));
  return motion;
}

/// The motion of a record from its columns: time, slip rate or displacement, and the load if it was recorded.
Measurement::History read_history(const std::vector<double>& time, const std::vector<double>& motion,
                                  const std::vector<double>* normal_load, bool displacement, const Measurement& data) {
  Measurement::History history;
  history.held = displacement;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double load = normal_load ? (*normal_load)[i] : data.normal_load;
    if (!std::isfinite(time[i]) || !std::isfinite(motion[i]) || !std::isfinite(load)) continue;
    if (!history.time.empty() && !(time[i] > history.time.back()))
      throw InputError(
          fmt::format("{}: time does not ascend: {} s follows {} s", data.name, time[i], history.time.back()));
    if (!(load > 0))
      throw InputError(fmt::format("{}: normal load {} N at {} s; it must be above 0 for friction to be told",
                                   data.name, load, time[i]));
    history.time.push_back(time[i]), history.slip_rate.push_back(motion[i]), history.normal_load.push_back(load);
  }
  if (history.time.size() < 2) throw InputError(fmt::format("{}: a motion needs two times at least", data.name));
  if (displacement) {
    auto& rate = history.slip_rate;
    for (std::size_t i = 0; i + 1 < rate.size(); ++i)
      rate[i] = (rate[i + 1] - rate[i]) / (history.time[i + 1] - history.time[i]);
    rate.back() = rate[rate.size() - 2];
  }
  return history;
}

Measurement read_data(const toml::node& node, scene::Scene& scene, const fs::path& folder) {
  scene::Table table(node, "fit.data");
  table.expect({"type", "file", "columns", "standard_error", "speed", "from", "to", "normal_load", "low", "high",
                "names_line", "decimal"});
  std::vector<std::string> names;
  for (const auto& kind : kinds()) names.emplace_back(kind.name);
  const auto type = scene::choice(table.required("type", "what was measured"), table.path("type"), names);
  auto kind = *std::ranges::find_if(kinds(), [&](const auto& k) { return k.name == type; });
  refuse_without_effect(table, kind);
  Measurement data;
  data.kind = kind.kind;
  data.slip_rate = data.next_slip_rate = scene.model.drive.speed.level();
  data.normal_load = scene.model.drive.normal_load.level();
  const Quantity speed{"", "m/s", {1e-15, 1e4}, "slip rate"};
  if (kind.kind == Kind::velocity_step)
    read_program(table, kind, speed, data);
  else
    table.read("speed", data.slip_rate, speed);
  read_terms(table, data);
  table.read("normal_load", data.normal_load, {"", "N", {1e-15, 1e15}, "normal load"});
  double low = -infinity, high = infinity;
  table.read("low", low, {"", kind.columns.front().si, {-1e300, 1e300}, "points below are left out"});
  table.read("high", high, {"", kind.columns.front().si, {-1e300, 1e300}, "points above are left out"});

  auto source = scene::read_file(table, folder);
  const auto& file_node = *table.find("file");
  data.name = source.file.filename().string();
  source.gaps = true;
  auto columns = table.table("columns");
  MotionColumns motion;
  if (kind.kind == Kind::record) motion = choose_columns(kind, columns, source, data);
  for (const auto& column : kind.columns) {
    const auto* given = columns ? columns->find(column.name) : nullptr;
    source.columns.push_back(given ? scene::read_column(*given, columns->path(column.name), column.si)
                                   : scene::RecordColumn{column.name, "", column.si});
  }
  source.columns.insert(source.columns.end(), motion.columns.begin(), motion.columns.end());
  if (columns) columns->finish();
  const auto* error = data.pairs()
                          ? &table.required("standard_error", "of each number: a value, or the name of a column")
                          : table.find("standard_error");
  const bool by_column =
      error && (error->is_table() ||
                (error->is_string() && !std::isdigit(static_cast<unsigned char>(error->as_string()->get()[0]))));
  double constant = 0;
  if (by_column)
    source.columns.push_back(scene::read_column(*error, table.path("standard_error"), kind.columns.back().si));
  else if (error)
    constant = scene::number(*error,
                             {table.path("standard_error"), kind.columns.back().si, {1e-300, 1e300}, "standard error"});
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
        if (error) data.error.push_back(by_column ? values.back()[i] : constant);
      }
    }
    if (data.x.empty()) throw InputError(fmt::format("{}: holds no point between low and high", data.name));
    if (kind.kind == Kind::record) {
      const auto first = kind.columns.size();
      data.history = read_history(values[0], values[first], motion.normal_load ? &values[first + 1] : nullptr,
                                  motion.displacement, data);
    }
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
  if (int starts = 1; table.find("starts")) {
    table.read("starts", starts, 1, 1000, "starts of the least squares");
    options.starts = starts;
  }
  int seed = 1;
  table.read("seed", seed, 0, scene::largest_seed, "of the random starts");
  options.seed = std::uint64_t(seed);
  if (task.candidates.size() > 1) options.folds = 5;  // which ranks them
  table.read("folds", options.folds, 0, 1000, "of cross-validation");
  table.read("confidence", options.confidence, {"", "1", {0.5, 0.9999}, "of intervals"});
  if (table.find("profiles")) options.profiles = truth(table, "profiles");
  table.finish();
}

}  // namespace rosin::app::verbs
