/// Reading [frf]: frequencies, families, the normal contact.
#include "app/frf_scene.hpp"

#include <cmath>

#include "app/scene_table.hpp"

namespace rosin::app {

namespace {

namespace fs = std::filesystem;

/// A list in Hz, or { from, to, points, scale }.
std::vector<double> read_frequencies(const toml::node& node, const std::string& path) {
  const Quantity hertz{path, "Hz", {1e-12, 1e12}, "frequency"};
  if (node.is_array()) {
    auto list = numbers(node, hertz);
    if (list.empty()) fail(node.source(), "{} is empty", path);
    if (std::ranges::adjacent_find(list, std::greater_equal{}) != list.end())
      fail(node.source(), "{} must ascend", path);
    return list;
  }
  Table table(node, path);
  table.expect({"from", "to", "points", "scale"});
  double from = 0, to = 0;
  int points = 200;
  table.required("from", "lowest frequency, Hz");
  table.required("to", "highest frequency, Hz");
  table.read("from", from, hertz);
  table.read("to", to, hertz);
  table.read("points", points, 2, "number of frequencies");
  const auto* scale = table.find("scale");
  const bool linear = scale && choice(*scale, table.path("scale"), {"log", "linear"}) == "linear";
  table.finish();
  if (!(from < to)) fail(node.source(), "{}.from = {} must be below {}.to = {}", path, from, path, to);
  std::vector<double> list;
  for (int i = 0; i < points; ++i) {
    const double part = double(i) / (points - 1);
    list.push_back(linear ? std::lerp(from, to, part) : from * std::pow(to / from, part));
  }
  list.back() = to;
  return list;
}

/// A column of a record by name, or { column, unit }.
RecordColumn read_column(const toml::node& node, const std::string& path, const std::string& si) {
  if (node.is_string()) return {text(node, path), "", si};
  Table table(node, path);
  table.expect({"column", "unit"});
  RecordColumn column{text(table.required("column", "its name in the file"), table.path("column")), "", si};
  if (const auto* unit = table.find("unit")) {
    column.unit = text(*unit, table.path("unit"));
    located(unit->source(), [&] { to_si("1 " + column.unit, si); });
  }
  table.finish();
  return column;
}

FrfRecord read_frf_record(Table table, const fs::path& folder) {
  using Second = analysis::Channels::Second;
  FrfRecord record;
  table.expect({"file", "time", "sample_rate", "slip_rate", "force", "normal_load", "approach_rate", "reference",
                "resolution", "overlap", "window", "estimator"});
  const fs::path file = text(table.required("file", "CSV with a header line, or NetCDF (*.nc)"), table.path("file"));
  auto& source = record.source;
  source.file = file.is_absolute() ? file : folder / file;
  const auto *time = table.find("time"), *rate = table.find("sample_rate");
  if (!time == !rate) fail(table.source(), "{} needs time (a column) or sample_rate (Hz), and not both", "frf.record");
  if (time) source.time = read_column(*time, table.path("time"), "s");
  table.read("sample_rate", source.sample_rate, {"", "Hz", {1e-6, 1e12}, "samples per second"});
  const auto add = [&](std::string_view key, const char* si, bool needed) {
    const auto* node = needed ? &table.required(key, si) : table.find(key);
    if (node) source.columns.push_back(read_column(*node, table.path(key), si));
    return node != nullptr;
  };
  add("slip_rate", "m/s", true);
  add("force", "N", true);
  auto& second = record.channels.second;
  if (add("approach_rate", "m/s", false)) {
    second = Second::approach_rate;
    add("normal_load", "N", true);
  } else if (add("normal_load", "N", false)) {
    second = Second::normal_load;
  }
  if (add("reference", "1", false)) {
    record.channels.reference = true;
    if (second != Second::none) fail(table.source(), "frf.record.reference goes with one input only");
  }
  table.required("resolution", "width of a frequency bin, Hz");
  table.read("resolution", record.resolution, {"", "Hz", {1e-9, 1e9}, "width of a frequency bin"});
  table.read("overlap", record.welch.overlap, {"", "1", {0, 0.9}, "overlap of neighbouring segments"});
  if (const auto* window = table.find("window"))
    record.welch.window = choice(*window, table.path("window"), analysis::window_names());
  if (const auto* estimator = table.find("estimator"))
    record.extraction.estimator = choice(*estimator, table.path("estimator"), analysis::estimator_names());
  table.finish();
  return record;
}

void read_simulation(Table table, Scene& scene) {
  table.expect({"type", "amplitude", "resolution", "averages", "seed", "overlap", "window"});
  const auto& f = scene.frf.frequencies;
  const Quantity amplitude{"", "1", {1e-6, 0.9}, "change of slip rate over its mean"};
  const auto type =
      choice(table.required("type", "\"swept-sine\" or \"noise\""), table.path("type"), {"swept-sine", "noise"});
  if (type == "swept-sine") {
    auto& sweep = scene.frf_sweep.emplace();
    sweep.frequencies = f;
    table.read("amplitude", sweep.amplitude, amplitude);
    for (const char* key : {"resolution", "averages", "seed", "overlap", "window"})
      if (const auto* node = table.find(key)) fail(node->source(), "{} belongs to noise", table.path(key));
  } else {
    auto& noise = scene.frf_noise.emplace();
    if (f.size() < 2) fail(table.source(), "frf.frequencies must have two ends: those of the noise's band");
    noise.low = f.front(), noise.high = f.back();
    table.required("resolution", "width of a frequency bin, Hz");
    table.read("amplitude", noise.amplitude, amplitude);
    table.read("resolution", noise.resolution, {"", "Hz", {1e-9, 1e9}, "width of a frequency bin"});
    table.read("averages", noise.averages, 8, "segments");
    int seed = 1;
    table.read("seed", seed, 0, "of the random numbers");
    noise.seed = std::uint64_t(seed);
    table.read("overlap", noise.welch.overlap, {"", "1", {0, 0.9}, "overlap of neighbouring segments"});
    if (const auto* window = table.find("window"))
      noise.welch.window = choice(*window, table.path("window"), analysis::window_names());
  }
  table.finish();
}

}  // namespace

void read_frf(Table& table, Scene& scene, const fs::path& folder) {
  auto& options = scene.frf;
  table.expect(
      {"frequencies", "normal", "normal_contact", "sensor_mass", "sensitivities", "family", "record", "simulate"});
  if (auto record = table.table("record")) scene.frf_record = read_frf_record(*record, folder);
  const auto* frequencies = scene.frf_record ? table.find("frequencies") : &table.required("frequencies", "Hz");
  if (frequencies) options.frequencies = read_frequencies(*frequencies, table.path("frequencies"));
  if (scene.frf_record && frequencies) {
    scene.frf_record->extraction.from = options.frequencies.front();
    scene.frf_record->extraction.to = options.frequencies.back();
  }
  if (auto simulation = table.table("simulate")) {
    if (scene.frf_record) fail(simulation->source(), "[frf] has a record: give record or simulate, not both");
    read_simulation(*simulation, scene);
  }
  if (const auto* normal = table.find("normal")) {
    if (!normal->is_boolean()) wrong_kind(*normal, "frf.normal", "true or false");
    options.matrix = *normal->value<bool>();
  }
  if (auto contact = table.table("normal_contact")) {
    contact->expect({"stiffness", "damping", "lift"});
    contact->required("stiffness", "of the contact normal to the interface, N/m");
    auto& normal = options.normal.emplace();
    contact->read("stiffness", normal.stiffness, {"", "N/m", {0, 1e15}, "normal stiffness of the contact"});
    contact->read("damping", normal.damping, {"", "N s/m", {0, 1e15}, "normal damping of the contact"});
    contact->read("lift", normal.lift, {"", "N s/m", {-1e15, 1e15}, "load gained by slip rate"});
    contact->finish();
    options.matrix = true;
  }
  table.read("sensor_mass", options.sensor_mass, {"", "kg", {0, 1e6}, "live mass between contact and force sensor"});
  if (const auto* list = table.find("sensitivities")) {
    options.sensitivities = texts(*list, table.path("sensitivities"));
    for (std::size_t i = 0; i < options.sensitivities.size(); ++i)
      located(list->as_array()->get(i)->source(), [&] { scene.model.describe(options.sensitivities[i]); });
  }
  if (auto family = table.table("family")) {
    family->expect({"parameter", "values"});
    const auto& parameter = family->required("parameter", "path, such as drive.normal_load");
    options.family = text(parameter, family->path("parameter"));
    auto quantity = located(parameter.source(), [&] { return scene.model.describe(options.family); });
    quantity.name = family->path("values");
    options.family_values = numbers(family->required("values", quantity.meaning), quantity);
    if (options.family_values.empty()) fail(family->source(), "frf.family.values is empty");
    family->finish();
  }
  table.finish();
}

}  // namespace rosin::app
