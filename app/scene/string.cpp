/// A bowed string: waves, friction under the bow, and how the bow moves.
#include "app/scene/string.hpp"

#include "app/scene/oscillator.hpp"
#include "app/scene/signal.hpp"
#include "app/tasks/bowing.hpp"
#include "oscillators/bowed_string.hpp"

namespace rosin::app::scene {

namespace {

using oscillators::BowedString;
using oscillators::Gesture;

void read_torsion(Table& table, BowedString& string) {
  const auto* node = table.find("torsion");
  if (!node) return;
  const auto path = table.path("torsion");
  if (node->is_boolean()) {
    if (*node->value<bool>()) wrong_kind(*node, path, "false, or a table: impedance, speed_ratio, quality, rounding");
    return string.torsion.reset();
  }
  Table keys(*node, path);
  auto& torsion = *string.torsion;
  keys.read("impedance", torsion.impedance, {"", "kg/s", {1e-9, 1e9}, "impedance of torsional waves"});
  keys.read("speed_ratio", torsion.speed_ratio, {"", "1", {1, 100}, "speed of torsional over transverse waves"});
  keys.read("quality", torsion.quality, {"", "1", {0.5, BowedString::none}, "quality factor of torsional waves"});
  keys.read("rounding", torsion.rounding, {"", "s", {0, 1}, "time in which an end smooths torsional waves"});
  keys.finish();
}

void read_body(Table& table, BowedString& string) {
  const auto* node = table.find("body");
  if (!node) return;
  const auto path = table.path("body");
  for (const auto& element : list(*node, path, "tables: frequency, mass, quality", most_names)) {
    Table keys(element, path);
    BowedString::BodyMode mode{};
    keys.required("frequency", "Hz");
    keys.required("mass", "kg");
    keys.required("quality", "1");
    keys.read("frequency", mode.frequency, {"", "Hz", {1e-3, 1e6}, "frequency of a mode of the body"});
    keys.read("mass", mode.mass, {"", "kg", {1e-9, 1e9}, "mass of a mode, as the bridge feels it"});
    keys.read("quality", mode.quality, {"", "1", {0.5, BowedString::none}, "quality factor of a mode of the body"});
    keys.finish();
    string.body.push_back(mode);
  }
}

void read_bow(Table& table, BowedString& string) {
  auto keys = table.table("bow");
  if (!keys) return;
  auto& bow = string.bow;
  keys->expect({"contacts", "width", "hair_stiffness", "hair_damping"});
  keys->read("contacts", bow.contacts, 1, 64, "contacts between bow and string");
  if (const auto* width = keys->find("width"); width && bow.contacts == 1)
    fail(width->source(), "{} has no effect on a bow of one contact; give contacts", keys->path("width"));
  keys->read("width", bow.width, {"", "m", {1e-6, 1}, "width of the bow along the string"});
  keys->read("hair_stiffness", bow.hair_stiffness,
             {"", "N/m", {1e-3, BowedString::none}, "stiffness of the hair of each contact along its motion"});
  keys->read("hair_damping", bow.hair_damping, {"", "N s/m", {0, 1e9}, "damping of the hair of each contact"});
  keys->finish();
}

/// [oscillator] reflection: measured functions of the ends, in place of the numbers that describe them otherwise.
void read_reflection(const SceneReader& reader, Table& table, BowedString& string) {
  auto keys = table.table("reflection");
  if (!keys) return;
  keys->expect({"bridge", "nut", "bow_position"});
  double measured_at = 0;
  keys->required("bow_position", "beta at which the bow stood");
  keys->read("bow_position", measured_at,
             {"", "1", {1e-4, 0.9999}, "place of the bow at which reflections were measured, beta"});
  for (const auto& [name, into] : {std::pair{"bridge", &string.bridge}, {"nut", &string.nut}})
    if (const auto* file = keys->find(name)) {
      const auto record = read_table_file(*file, keys->path(name), "1/s", reader.folder, true);
      located(file->source(), [&] { Signal{record}; });  // refuses records without order
      into->emplace(BowedString::Reflection{record.time, record.value, measured_at});
    }
  if (!string.bridge && !string.nut)
    fail(table.find("reflection")->source(), "{} needs bridge, nut or both: tables of time and 1/s",
         table.path("reflection"));
  keys->finish();
  const auto replaced = [&](const char* key, const char* by) {
    if (const auto* node = table.find(key))
      fail(node->source(), "{} has no effect beside oscillator.reflection.{}, which says how waves come back",
           table.path(key), by);
  };
  if (string.bridge) replaced("bridge_resistance", "bridge"), replaced("body", "bridge");
  if (string.nut) replaced("quality", "nut"), replaced("stiffness", "nut");
  if (string.bridge && string.nut) replaced("corner_rounding", "bridge and nut");
}

void read_string_keys(SceneReader& reader, Table table, bool) {
  auto& model = (reader.scene.string = std::make_shared<tasks::Bowing>())->model;
  auto& string = model.string;
  table.expect({"type", "frequency", "impedance", "bow_position", "quality", "corner_rounding", "bridge_resistance",
                "torsion", "delays", "sample_rate", "stiffness", "length", "body", "bow", "reflection"});
  table.find("type");
  table.read("frequency", string.frequency, {"", "Hz", {0.1, 1e5}, "frequency of the open string"});
  table.read("impedance", string.impedance, {"", "kg/s", {1e-9, 1e9}, "impedance of transverse waves"});
  table.read("bow_position", string.bow_position,
             {"", "1", {1e-4, 0.9999}, "distance of the bow from the bridge over the length, beta"});
  table.read("quality", string.quality,
             {"", "1", {0.5, BowedString::none}, "quality factor by the ends, inf: lossless"});
  table.read("corner_rounding", string.corner_rounding, {"", "s", {0, 1}, "time in which an end smooths waves"});
  table.read("bridge_resistance", string.bridge_resistance,
             {"", "kg/s", {1e-9, BowedString::none}, "resistance of the bridge, inf: rigid"});
  read_torsion(table, string);
  if (const auto* delays = table.find("delays")) {
    const auto& names = oscillators::delay_line_names();
    const auto name = choice(*delays, table.path("delays"), names);
    string.delays = oscillators::DelayLine(std::ranges::find(names, name) - names.begin());
  }
  table.read("sample_rate", string.sample_rate, {"", "Hz", {100, 1e9}, "samples of the waves per second"});
  table.read("stiffness", string.inharmonicity,
             {"", "1", {0, 0.1}, "inharmonicity B: partial n is at n f0 sqrt(1 + B n^2)"});
  table.read("length", string.length, {"", "m", {1e-3, 1e3}, "length of the string"});
  read_body(table, string);
  read_bow(table, string);
  read_reflection(reader, table, string);
  table.finish();
  const auto& law = reader.scene.model;
  const auto& of_law = reader.document.get("law")->source();
  if (law.contact_stiffness.present())
    fail(of_law,
         "law.contact_stiffness does not go with a string: the hair of the bow is its spring, "
         "oscillator.bow.hair_stiffness");
  if (law.load_memory > 0) fail(of_law, "law.load_memory does not go with a string");
  model.law = law.law;
  model.lambda = law.lambda;
  located(table.source(), [&] { oscillators::StringLanes(model.string, model.law, model.lambda); });
}

Gesture read_gesture(const toml::node& node, const Quantity& quantity, const std::filesystem::path& folder) {
  const auto* keys = node.as_table();
  const auto* approach = keys ? keys->get("approach") : nullptr;
  if (!approach) return {read_signal(node, quantity, folder)};
  if (keys->size() > 1) fail(node.source(), "{} needs one form; approach stands alone", quantity.name);
  Table table(*approach, quantity.name + ".approach");
  Gesture gesture{{}, Gesture::Approach{0, 0, 0}};
  table.required("to", quantity.unit);
  table.required("time", "s");
  table.read("from", gesture.approach->from, {"", quantity.unit, quantity.range, "value at the beginning"});
  table.read("to", gesture.approach->to, {"", quantity.unit, quantity.range, "value that is approached"});
  table.read("time", gesture.approach->time, {"", "s", {1e-9, 1e9}, "time in which all but 1/e of the way is gone"});
  table.finish();
  return gesture;
}

void read_drive_of_string(SceneReader& reader, Table drive, bool) {
  auto& model = reader.scene.string->model;
  drive.expect({"speed", "normal_load"});
  auto speed = mechanical("drive.speed"), load = mechanical("drive.normal_load");
  speed.meaning = "speed of the bow", load.meaning = "force that presses the bow on the string";
  load.range.low = std::max(load.range.low, 0.0);
  model.speed = read_gesture(drive.required("speed", "m/s"), speed, reader.folder);
  model.load = read_gesture(drive.required("normal_load", "N"), load, reader.folder);
  drive.finish();
}

void read_start(Table& table, oscillators::StringStart& into) {
  if (const auto* start = table.find("start"))
    into = choice(*start, table.path("start"), {"rest", "helmholtz"}) == "rest" ? oscillators::StringStart::rest
                                                                                : oscillators::StringStart::helmholtz;
}

/// [run] sound: the response of body and room, whose unit is that of the sound per N s.
void read_sound(const SceneReader& reader, Table& table, tasks::Bowing& task) {
  auto keys = table.table("sound");
  if (!keys) return;
  keys->expect({"response", "unit"});
  auto& sound = task.sound.emplace();
  const auto& response = keys->required("response", "table of the answer to an impulse on the bridge");
  const auto& unit = keys->required("unit", "of the sound, such as \"Pa\" or \"m/s\"");
  sound.unit = text(unit, keys->path("unit"));
  located(unit.source(), [&] { Reference::to_si("1 " + sound.unit, sound.unit); });
  sound.response =
      read_table_file(response, keys->path("response"), fmt::format("({})/(N s)", sound.unit), reader.folder, true);
  located(response.source(), [&] { Signal{sound.response}; });
  keys->finish();
}

/// [run]: duration (s) or periods after the first slip, samples that are kept, start, what is heard.
void read_run(SceneReader& reader, Table table) {
  auto& task = *reader.scene.string;
  table.expect({"duration", "periods", "samples", "start", "sound"});
  if (const auto* duration = table.find("duration"); duration && table.find("periods"))
    fail(duration->source(), "give {} or {}, not both", table.path("duration"), table.path("periods"));
  table.read("duration", task.options.duration, {"", "s", {1e-6, 1e4}, "time that is computed"});
  table.read("periods", task.options.periods_after,
             {"", "1", {1, 1e5}, "periods of the open string that are computed after the first slip"});
  table.read("samples", task.samples, 1, most_points, "most samples that the record keeps");
  read_start(table, task.model.start);
  read_sound(reader, table, task);
  table.finish();
}

/// [transient]: what counts as a slip and as a Helmholtz period.
void read_transient(SceneReader& reader, Table table) {
  auto& how = reader.scene.string->options.transient;
  table.expect({"gap", "least_slip", "tolerance", "shortest_slip", "longest_slip", "periods", "most"});
  table.read("gap", how.gap, {"", "1", {0, 1}, "slips closer than this are one, in periods"});
  table.read("least_slip", how.least,
             {"", "1", {0, 10}, "slip over less is none, in distances that the bow moves in a period"});
  table.read("tolerance", how.tolerance, {"", "1", {1e-6, 0.5}, "relative difference between a period and 1/f0"});
  table.read("shortest_slip", how.shortest, {"", "1", {0, 10}, "shortest slip of a Helmholtz period, in beta periods"});
  table.read("longest_slip", how.longest, {"", "1", {0, 100}, "longest slip of a Helmholtz period, in beta periods"});
  table.read("periods", how.periods, 1, 1000, "Helmholtz periods in a row that end a transient");
  table.read("most", how.most,
             {"", "1", {1, 1e5}, "transients of this length or longer are not told apart, in periods"});
  table.finish();
}

}  // namespace

void read_string(SceneReader& reader) {
  if (auto run = reader.root.table("run")) read_run(reader, *run);
  if (auto transient = reader.root.table("transient")) read_transient(reader, *transient);
  const auto& options = reader.scene.string->options;
  const auto& transient = options.transient;
  if (options.duration == 0 && transient.most + transient.periods > options.periods_after)
    throw InputError(
        fmt::format("transient.most + transient.periods = {} periods do not fit into run.periods = {} after the first "
                    "slip; raise run.periods",
                    transient.most + transient.periods, options.periods_after));
}

void read_string_cycle(SceneReader& reader) {
  auto& task = *reader.scene.string;
  task.model.start = oscillators::StringStart::helmholtz;
  if (auto cycle = reader.root.table("cycle")) {
    cycle->expect({"start", "periods"});
    read_start(*cycle, task.model.start);
    cycle->read("periods", task.periods, {"", "1", {20, 1e5}, "periods of the open string until a motion is periodic"});
    cycle->finish();
  }
  if (auto transient = reader.root.table("transient")) read_transient(reader, *transient);
  if (task.periods < 2 * task.options.transient.periods)
    throw InputError(
        fmt::format("cycle.periods = {} is less than twice transient.periods = {}, by which a regime is known",
                    task.periods, task.options.transient.periods));
}

OscillatorType string_type() {
  constexpr const char* memory =
      "the state of a string is all its waves, on their way between bridge and nut, and no list of numbers that a "
      "solver could ";
  return {"string",
          {"run", "stability", "cycle", "sweep", "map", "compare", "frf", "lyapunov", "lab"},
          read_string_keys,
          read_drive_of_string,
          {{"branch", fmt::format("{}follow; 'sweep' computes its motions along a parameter", memory)},
           {"basin", fmt::format("{}start from anywhere; [cycle] start chooses rest or Helmholtz motion", memory)},
           {"fit",
            "a motion of a string is that of its waves at a sample rate, whose slopes by numbers are not known to be "
            "smooth; 'compare' lays strings beside each other"}}};
}

}  // namespace rosin::app::scene
