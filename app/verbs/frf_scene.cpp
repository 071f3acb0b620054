/// Reading [frf]: frequencies, families, the normal contact.
#include "app/verbs/frf_scene.hpp"

#include <cmath>
#include <numbers>

#include "analysis/response/contact_slopes.hpp"
#include "analysis/response/sliding_receptance.hpp"
#include "analysis/strings/sliding.hpp"
#include "app/scene/matrix_file.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/scene_table.hpp"
#include "app/scene/uncertain.hpp"
#include "app/tasks/bowing.hpp"
#include "app/tasks/frf.hpp"
#include "core/fourier.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;

/// The keys of a table that are the members of an object; the first of them must be there.
template <class Fields, class Object>
void read_fields(scene::Table& table, const Fields& fields, Object& object) {
  for (const auto& f : fields)
    table.read(f.name, object.*f.member, {"", std::string(f.unit), f.range, std::string(f.meaning)});
  table.finish();
  const auto& first = *std::begin(fields);
  table.required(first.name, fmt::format("{}, {}", first.meaning, first.unit));
}

constexpr int most_frequencies = 100'000;

/// A list in Hz, or { from, to, points, scale }.
std::vector<double> read_frequencies(const toml::node& node, const std::string& path) {
  const Quantity hertz{path, "Hz", {1e-12, 1e12}, "frequency"};
  if (node.is_array()) {
    auto list = scene::numbers(node, hertz, most_frequencies);
    if (list.empty()) scene::fail(node.source(), "{} is empty", path);
    if (std::ranges::adjacent_find(list, std::greater_equal{}) != list.end())
      scene::fail(node.source(), "{} must ascend", path);
    return list;
  }
  scene::Table table(node, path);
  table.expect({"from", "to", "points", "scale"});
  double from = 0, to = 0;
  int points = 200;
  table.required("from", "lowest frequency, Hz");
  table.required("to", "highest frequency, Hz");
  table.read("from", from, hertz);
  table.read("to", to, hertz);
  table.read("points", points, 2, most_frequencies, "number of frequencies");
  const auto* scale = table.find("scale");
  const bool linear = scale && scene::choice(*scale, table.path("scale"), {"log", "linear"}) == "linear";
  table.finish();
  if (!(from < to)) scene::fail(node.source(), "{}.from = {} must be below {}.to = {}", path, from, path, to);
  std::vector<double> list;
  for (int i = 0; i < points; ++i) {
    const double part = double(i) / (points - 1);
    list.push_back(linear ? std::lerp(from, to, part) : from * std::pow(to / from, part));
  }
  list.back() = to;
  return list;
}

tasks::FrfRecord read_frf_record(scene::Table table, const fs::path& folder) {
  using Second = analysis::response::Channels::Second;
  tasks::FrfRecord record;
  table.expect({"file", "time", "sample_rate", "slip_rate", "displacement", "force", "normal_load", "approach_rate",
                "reference", "resolution", "overlap", "window", "estimator", "names_line", "decimal"});
  auto& source = record.source;
  source = scene::read_file(table, folder);
  source.gaps = true;
  const auto *time = table.find("time"), *rate = table.find("sample_rate");
  if (!time == !rate)
    scene::fail(table.source(), "{} needs time (a column) or sample_rate (Hz), and not both", "frf.record");
  if (time) source.time = scene::read_column(*time, table.path("time"), "s");
  table.read("sample_rate", source.sample_rate, {"", "Hz", {1e-6, 1e12}, "samples per second"});
  const auto add = [&](std::string_view key, const char* si, bool needed) {
    const auto* node = needed ? &table.required(key, si) : table.find(key);
    if (node) source.columns.push_back(scene::read_column(*node, table.path(key), si));
    return node != nullptr;
  };
  const auto* displacement = table.find("displacement");
  if (displacement && table.find("slip_rate"))
    scene::fail(displacement->source(), "frf.record has slip_rate and displacement; give one of them");
  record.displacement = displacement != nullptr;
  if (record.displacement)
    add("displacement", "m", true);
  else
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
    if (second != Second::none) scene::fail(table.source(), "frf.record.reference goes with one input only");
  }
  table.required("resolution", "width of a frequency bin, Hz");
  table.read("resolution", record.resolution, {"", "Hz", {1e-9, 1e9}, "width of a frequency bin"});
  table.read("overlap", record.welch.overlap, {"", "1", {0, 0.9}, "overlap of neighbouring segments"});
  if (const auto* window = table.find("window"))
    record.welch.window = scene::choice(*window, table.path("window"), window_names());
  if (const auto* estimator = table.find("estimator"))
    record.extraction.estimator =
        scene::choice(*estimator, table.path("estimator"), analysis::response::estimator_names());
  table.finish();
  return record;
}

/// A file by name, or { file, … } with columns.
tasks::FrfUse::Measured read_complex_table(const toml::node& node, const std::string& path, const char* unit,
                                           const fs::path& folder) {
  scene::RecordSource source;
  source.columns = {{"frequency", "", "Hz"}, {"real", "", unit}, {"imaginary", "", unit}};
  if (node.is_string()) {
    const fs::path file = scene::text(node, path);
    source.file = file.is_absolute() ? file : folder / file;
  } else {
    scene::Table table(node, path);
    table.expect({"file", "names_line", "decimal", "frequency", "real", "imaginary", "standard_error"});
    auto columns = std::move(source.columns);
    source = scene::read_file(table, folder);
    for (auto& column : columns)
      if (const auto* given = table.find(column.name))
        column = scene::read_column(*given, table.path(column.name), column.si);
    if (const auto* error = table.find("standard_error"))
      columns.push_back(scene::read_column(*error, table.path("standard_error"), unit));
    source.columns = std::move(columns);
    table.finish();
  }
  tasks::FrfUse::Measured table;
  scene::located(node.source(), [&] {
    scene::read_record(source, [&](double, std::span<const std::span<const double>> block) {
      for (std::size_t i = 0; i < block[0].size(); ++i) {
        table.frequency.push_back(block[0][i]);
        table.value.emplace_back(block[1][i], block[2][i]);
        if (block.size() > 3) table.error.push_back(block[3][i]);
      }
    });
    if (std::ranges::adjacent_find(table.frequency, std::greater_equal{}) != table.frequency.end())
      throw InputError(fmt::format("{}: frequencies must ascend", source.file.string()));
    if (std::ranges::any_of(table.error, [](double e) { return e < 0; }))
      throw InputError(fmt::format("{}: standard errors must not be negative", source.file.string()));
  });
  return table;
}

tasks::FrfUse read_use(scene::Table table, const scene::Scene& scene, const toml::node* oscillator,
                       const fs::path& folder) {
  tasks::FrfUse use;
  use.sliding.model = scene.model;
  use.sliding.normal = scene.task<tasks::Frf>().options.rig.normal;
  table.expect({"modes", "M", "C", "K", "contacts", "receptance", "friction", "scan", "uncertain", "samples", "seed"});
  constexpr Range any{-1e15, 1e15};
  const auto *modes = table.find("modes"), *M = table.find("M"), *C = table.find("C");
  const auto *contacts = table.find("contacts"), *receptance = table.find("receptance");
  if ((modes != nullptr) + (M != nullptr) + (receptance != nullptr) > 1)
    scene::fail(table.source(), "frf.structure: give modes, or M, C and K, or receptance");
  for (const char* key : {"C", "K"})
    if (const auto* given = M ? nullptr : table.find(key))
      scene::fail(given->source(), "{} has no effect without frf.structure.M", table.path(key));
  if (modes && contacts)
    scene::fail(contacts->source(), "{} has no effect: modes say how the contact moves by tangential and normal",
                table.path("contacts"));
  if (modes) {
    std::vector<analysis::response::Mode> read;
    for (const auto& element : scene::list(*modes, table.path("modes"), "tables", scene::most_names)) {
      scene::Table keys(element, table.path("modes"));
      analysis::response::Mode mode;
      read_fields(keys, analysis::response::mode_fields, mode);
      read.push_back(mode);
    }
    if (read.empty()) scene::fail(modes->source(), "frf.structure.modes is empty");
    use.sliding.form = std::move(read);
  } else if (M) {
    oscillators::Structure structure;
    const auto matrix = [&](const toml::node& node, const char* key, const char* unit, const char* meaning) {
      return scene::read_matrix(node, {table.path(key), unit, any, meaning}, structure.M.rows(), folder);
    };
    structure.M = matrix(*M, "M", "kg", "mass");
    structure.K = matrix(table.required("K", "stiffness, N/m"), "K", "N/m", "stiffness");
    structure.C = C ? matrix(*C, "C", "N s/m", "damping") : Eigen::MatrixXd::Zero(structure.size(), structure.size());
    if (!contacts) scene::fail(table.source(), "frf.structure.contacts is needed: tables with a tangential direction");
    for (const auto& element : scene::list(*contacts, table.path("contacts"), "tables", scene::most_names)) {
      scene::Table keys(element, table.path("contacts"));
      keys.expect({"tangential", "normal"});
      const auto direction = [&](const toml::node& node, std::string_view key, const char* meaning) -> Eigen::VectorXd {
        const auto entries = scene::numbers(node, {keys.path(key), "1", any, meaning});
        if (int(entries.size()) != structure.size())
          scene::fail(node.source(), "{} has {} entries for {} coordinates", keys.path(key), entries.size(),
                      structure.size());
        return Eigen::Map<const Eigen::VectorXd>(entries.data(), structure.size());
      };
      auto& contact = structure.contacts.emplace_back();
      contact.tangential =
          direction(keys.required("tangential", "direction of slip"), "tangential", "direction of slip");
      if (const auto* normal = keys.find("normal"))
        contact.normal = direction(*normal, "normal", "direction that presses");
      keys.finish();
    }
    use.sliding.form = std::move(structure);
  } else if (receptance) {
    use.receptance = read_complex_table(*receptance, table.path("receptance"), "m/N", folder);
  } else if (oscillator) {
    scene::located(oscillator->source(), [&] { use.sliding.structure(); });
  } else {
    scene::fail(table.source(), "frf.structure needs modes, or M, C and K, or receptance, or an [oscillator]");
  }
  if (const auto* friction = table.find("friction"))
    use.friction = read_complex_table(*friction, table.path("friction"), "N s/m", folder);
  if (auto scan = table.table("scan")) {
    scan->expect({"parameter", "from", "to", "points"});
    const auto& parameter = scan->required("parameter", "path, such as drive.normal_load");
    use.scan = scene::text(parameter, scan->path("parameter"));
    auto quantity = scene::located(parameter.source(), [&] { return use.sliding.describe(use.scan); });
    scan->required("from", quantity.meaning);
    scan->required("to", quantity.meaning);
    scan->read("from", use.scan_from, quantity);
    scan->read("to", use.scan_to, quantity);
    scan->read("points", use.scan_points, 1, 10'000, "intervals that are searched");
    scan->finish();
    if (!(use.scan_from > 0) || !(use.scan_from < use.scan_to))
      scene::fail(scan->source(), "frf.structure.scan: 0 < from < to is needed");
  }
  use.uncertain = scene::read_uncertain(
      table, [&](const std::string& path) { use.sliding.describe(path); }, use.samples, use.seed);
  table.finish();
  return use;
}

void read_simulation(scene::Table table, scene::Scene& scene) {
  auto& frf = scene.task<tasks::Frf>();
  table.expect({"type", "amplitude", "resolution", "averages", "seed", "overlap", "window"});
  const auto& f = frf.options.frequencies;
  const Quantity amplitude{"", "1", {1e-6, 0.9}, "change of slip rate over its mean"};
  const auto type =
      scene::choice(table.required("type", "\"swept-sine\" or \"noise\""), table.path("type"), {"swept-sine", "noise"});
  if (type == "swept-sine") {
    auto& sweep = frf.sweep.emplace();
    sweep.frequencies = f;
    table.read("amplitude", sweep.amplitude, amplitude);
    for (const char* key : {"resolution", "averages", "seed", "overlap", "window"})
      if (const auto* node = table.find(key)) scene::fail(node->source(), "{} belongs to noise", table.path(key));
  } else {
    auto& noise = frf.noise.emplace();
    if (f.size() < 2) scene::fail(table.source(), "frf.frequencies must have two ends: those of the noise's band");
    noise.low = f.front(), noise.high = f.back();
    table.required("resolution", "width of a frequency bin, Hz");
    table.read("amplitude", noise.amplitude, amplitude);
    table.read("resolution", noise.resolution, {"", "Hz", {1e-9, 1e9}, "width of a frequency bin"});
    table.read("averages", noise.averages, 8, 100'000, "segments");
    int seed = 1;
    table.read("seed", seed, 0, scene::largest_seed, "of the random numbers");
    noise.seed = std::uint64_t(seed);
    table.read("overlap", noise.welch.overlap, {"", "1", {0, 0.9}, "overlap of neighbouring segments"});
    if (const auto* window = table.find("window"))
      noise.welch.window = scene::choice(*window, table.path("window"), window_names());
  }
  table.finish();
}

/// The contact whose response is asked for becomes the scene's model, at its speed and load in steady sliding; what it
/// is a part of stays the oscillator.
void read_oscillator(scene::Table& table, scene::Scene& scene, const toml::node* given) {
  auto& oscillator = scene.task<tasks::Frf>().oscillator;
  const auto* structure = scene.structure ? &scene.structure->structure : nullptr;
  const auto* string = scene.string ? &scene.string->model : nullptr;
  const auto* chosen = table.find("contact");
  if (!structure && !string) {
    if (chosen)
      scene::fail(chosen->source(), "{} has no meaning: the oscillator has one contact", table.path("contact"));
    const auto& slider = scene.model.slider;
    if (!given || !(slider.mass > 0) || !(slider.stiffness > 0) || !std::isfinite(slider.stiffness)) return;
    try {
      oscillator = analysis::response::sliding_receptance(oscillators::one_slider(scene.model), 0);
    } catch (const InputError& error) {  // friction that answers slip rate by its states alone
      scene.notes.push_back(fmt::format("the receptance is left out: {}", error.what()));
    }
    return;
  }
  if (const auto* other = table.find("structure"))
    scene::fail(other->source(),
                "[frf.structure] puts the law's contact on a structure that is given there, but the oscillator of this "
                "scene has contacts of its own: leave [oscillator] out, or ask 'rosin stability' where it squeals");
  int contact = 1;
  table.read("contact", contact, 1, structure ? int(structure->contacts.size()) : string->string.bow.contacts,
             "contact that responds, counted from 1");
  scene::located(chosen ? chosen->source() : table.source(), [&] {
    if (structure) {
      scene.model = analysis::response::contact_in_sliding(*structure, contact - 1);
      oscillator = analysis::response::sliding_receptance(*structure, contact - 1);
    } else {
      scene.model = analysis::strings::contact_in_sliding(*string);
      oscillator = analysis::strings::sliding_receptance(*string, contact - 1);
    }
  });
}

}  // namespace

void read_frf(scene::Table table, scene::SceneReader& reader, const toml::node* oscillator) {
  auto& scene = reader.scene;
  auto& frf = scene.task<tasks::Frf>();
  const auto& folder = reader.folder;
  auto& options = frf.options;
  table.expect({"frequencies", "contact", "normal", "normal_contact", "sensor_mass", "sensitivities", "family",
                "record", "simulate", "structure"});
  read_oscillator(table, scene, oscillator);
  if (auto record = table.table("record")) frf.record = read_frf_record(*record, folder);
  const auto* frequencies = frf.record ? table.find("frequencies") : &table.required("frequencies", "Hz");
  if (frequencies) options.frequencies = read_frequencies(*frequencies, table.path("frequencies"));
  if (frf.record && frequencies) {
    frf.record->extraction.from = options.frequencies.front();
    frf.record->extraction.to = options.frequencies.back();
  }
  if (auto simulation = table.table("simulate")) {
    if (frf.record) scene::fail(simulation->source(), "[frf] has a record: give record or simulate, not both");
    read_simulation(*simulation, scene);
  }
  if (const auto* normal = table.find("normal")) {
    if (!normal->is_boolean()) scene::wrong_kind(*normal, "frf.normal", "true or false");
    options.rig.matrix = *normal->value<bool>();
  }
  if (auto contact = table.table("normal_contact")) {
    read_fields(*contact, analysis::response::normal_contact_fields, options.rig.normal.emplace());
    options.rig.matrix = true;
  }
  const bool found = frf.record || frf.sweep || frf.noise;
  for (const char* key : {"sensitivities", "family"})
    if (const auto* node = found ? table.find(key) : nullptr)
      scene::fail(node->source(), "{} belongs to a prediction, without frf.record and frf.simulate", table.path(key));
  if (auto structure = table.table("structure")) {
    if (found)
      scene::fail(structure->source(),
                  "[frf.structure] goes with a prediction, or with a measured table 'friction' in it");
    frf.use = read_use(*structure, scene, oscillator, folder);
  }
  table.read("sensor_mass", options.rig.sensor_mass,
             {"", "kg", {0, 1e6}, "live mass between contact and force sensor"});
  if (frf.sweep) frf.sweep->rig = options.rig;
  if (frf.noise) frf.noise->rig = options.rig;
  if (const auto* list = table.find("sensitivities")) {
    options.sensitivities = scene::texts(*list, table.path("sensitivities"));
    const auto imposed = analysis::response::imposed_contact_setup(scene.model);
    for (std::size_t i = 0; i < options.sensitivities.size(); ++i)
      scene::located(list->as_array()->get(i)->source(),
                     [&] { analysis::response::ContactSlopes(scene.model, imposed, options.sensitivities[i]); });
  }
  if (auto family = table.table("family")) {
    family->expect({"parameter", "values"});
    const auto& parameter = family->required("parameter", "path, such as drive.normal_load");
    options.family = scene::text(parameter, family->path("parameter"));
    auto quantity = scene::located(parameter.source(), [&] { return scene.model.describe(options.family); });
    quantity.name = family->path("values");
    options.family_values = scene::numbers(family->required("values", quantity.meaning), quantity, scene::most_names);
    if (options.family_values.empty()) scene::fail(family->source(), "frf.family.values is empty");
    family->finish();
  }
  table.finish();
}

}  // namespace rosin::app::verbs
