/// Reading [fit]: parameters, candidates, and tables of data.
#include "app/verbs/fit_scene.hpp"

#include <cmath>

#include "analysis/inference/recorded_motion.hpp"
#include "analysis/inference/recorded_slip_rate.hpp"
#include "analysis/inference/slip_events.hpp"
#include "app/scene/law.hpp"
#include "app/scene/scene_table.hpp"
#include "app/tasks/fit.hpp"
#include "app/verbs/fit_machine.hpp"

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
      {"record", Kind::record, {{"time", "s"}, {"friction_coefficient", "1"}}},
      {"motion", Kind::motion, {{"time", "s"}}},
      {"stick-slip", Kind::stick_slip, {{"speed", "m/s"}}},
      {"stick-slip-record", Kind::stick_slip, {{"time", "s"}, {"friction_force", "N"}}}};
  return list;
}

/// Events that are to be found in a record of force; else they stand in the file.
bool holds_record(const KindOfData& kind) { return kind.kind == Kind::stick_slip && kind.columns.size() > 1; }

/// Keys that only some kinds of measurement listen to.
void refuse_without_effect(scene::Table& table, const KindOfData& kind) {
  const struct {
    const char* key;
    std::vector<std::string_view> kinds;
  } listeners[] = {
      {"speed", {"frequency-response", "hold", "stick-slip", "stick-slip-record"}},
      {"normal_load",
       {"frequency-response", "velocity-step", "steady-curve", "hold", "record", "stick-slip", "stick-slip-record"}},
      {"measured", {"motion"}},
      {"start", {"motion"}},
      {"events", {"stick-slip"}},
      {"least_drop", {"stick-slip-record"}},
      {"least_time", {"stick-slip-record"}},
      {"from", {"velocity-step"}},
      {"to", {"velocity-step"}},
      {"steps", {"velocity-step"}},
      {"step_at", {"velocity-step"}},
      {"over", {"velocity-step"}},
      {"rest", {"record"}},
      {"sensor_mass", {"record"}},
      {"trend", {"velocity-step", "record", "motion"}},
      {"clock_offset", {"velocity-step", "record", "motion"}},
      {"base", {"velocity-step", "record", "steady-curve", "hold", "motion"}},
      {"standard_error",
       {"frequency-response", "velocity-step", "steady-curve", "hold", "record", "stick-slip", "motion"}}};
  for (const auto& [key, those] : listeners)
    if (const auto* node = table.find(key); node && std::ranges::find(those, kind.name) == those.end())
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
  if (data.kind == Kind::motion && data.terms.trend == Trend::displacement)
    scene::fail(table.find("trend")->source(), "{}: no displacement is imposed on a motion; its trend is over time",
                table.path("trend"));
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

/// The columns of a file of data, by the names that a kind of measurement has for them.
struct ColumnsOfFile {
  const scene::RecordSource& source;
  std::optional<scene::Table>& chosen;

  scene::RecordColumn of(const char* name, const char* si) const {
    const auto* given = chosen ? chosen->find(name) : nullptr;
    return given ? scene::read_column(*given, chosen->path(name), si) : scene::RecordColumn{name, "", si};
  }
  bool has(const char* name, const char* si) const {
    return (chosen && chosen->find(name)) || has_column(source, of(name, si));
  }
};

/// The columns of a record beside time and friction: those that move and load it, of which a file has one or the other.
struct MotionColumns {
  bool displacement = false, normal_load = false;
  std::vector<scene::RecordColumn> columns;
};
MotionColumns choose_motion(KindOfData& kind, const ColumnsOfFile& file, Measurement& data) {
  data.in_force = !file.has("friction_coefficient", "1") && file.has("friction_force", "N");
  if (data.in_force) kind.columns.back() = {"friction_force", "N"};
  MotionColumns motion;
  motion.displacement = !file.has("slip_rate", "m/s") && file.has("displacement", "m");
  motion.columns.push_back(motion.displacement ? file.of("displacement", "m") : file.of("slip_rate", "m/s"));
  motion.normal_load = file.has("normal_load", "N");
  if (motion.normal_load) motion.columns.push_back(file.of("normal_load", "N"));
  return motion;
}

/// What may be read off slip events, as the catalogue of a run calls it.
struct EventColumn {
  const char *name, *si;
  Measurement::Event event;
};
constexpr EventColumn event_columns[] = {{"recurrence", "s", Measurement::Event::recurrence},
                                         {"force_drop", "N", Measurement::Event::force_drop},
                                         {"peak_slip_rate", "m/s", Measurement::Event::peak_slip_rate}};
/// Those that the scene names, or else those that the file has.
std::vector<EventColumn> choose_events(scene::Table& table, const ColumnsOfFile& file) {
  std::vector<EventColumn> events;
  if (const auto* named = table.find("events")) {
    std::vector<std::string> known;
    for (const auto& column : event_columns) known.emplace_back(column.name);
    for (const auto& element : scene::list(*named, table.path("events"), "names", std::size(event_columns))) {
      const auto name = scene::choice(element, table.path("events"), known);
      events.push_back(event_columns[std::ranges::find(known, name) - known.begin()]);
    }
    if (events.empty()) scene::fail(named->source(), "{} is empty", table.path("events"));
  } else {
    std::ranges::copy_if(event_columns, std::back_inserter(events),
                         [&](const auto& column) { return file.has(column.name, column.si); });
    if (events.empty())
      scene::fail(table.source(),
                  "{} has none of the columns recurrence, force_drop and peak_slip_rate: say columns = "
                  "{{ recurrence = … }}",
                  file.source.file.string());
  }
  return events;
}

/// Rows that are not there, of samples that are evenly spaced else.
void find_missing_rows(Measurement::History& history) {
  const auto& time = history.time;
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < time.size(); ++i) steps.push_back(time[i + 1] - time[i]);
  if (steps.empty()) return;
  auto sorted = steps;
  const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  const double usual = *middle;
  const auto even = std::ranges::count_if(steps, [&](double step) { return std::abs(step - usual) < 0.1 * usual; });
  constexpr double nearly_all = 0.9;
  if (double(even) < nearly_all * double(steps.size())) return;
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i] > 1.5 * usual) history.gaps.push_back(i);
  std::ranges::sort(history.gaps);
  const auto twice = std::ranges::unique(history.gaps);
  history.gaps.erase(twice.begin(), twice.end());
}

/// Where a user says that a record is at rest: up to a slip rate, or in intervals of time.
struct SaidRest {
  std::optional<double> below = {};
  std::vector<std::pair<double, double>> times = {};

  /// \param slip_rate as it was recorded, not made smooth
  analysis::inference::Rest of(std::span<const double> time, std::span<const double> slip_rate,
                               std::span<const double> friction) const {
    if (below) return analysis::inference::rest_below(slip_rate, *below);
    if (times.empty()) return analysis::inference::find_rest(slip_rate, friction);
    analysis::inference::Rest rest{.given = true};
    for (const double t : time)
      rest.state.push_back(std::ranges::any_of(times, [&](auto span) { return span.first <= t && t <= span.second; }));
    return rest;
  }
};
SaidRest read_rest(scene::Table& table) {
  SaidRest rest;
  const auto* node = table.find("rest");
  if (!node) return rest;
  const auto path = table.path("rest");
  if (!node->is_array()) {
    rest.below = scene::number(*node, {path, "m/s", {0, 1e4}, "slip rate up to which the record is at rest"});
    return rest;
  }
  const Quantity time{path, "s", {-1e15, 1e15}, "begin or end of rest"};
  for (const auto& element : scene::list(*node, path, "pairs [begin, end]", scene::most_names)) {
    const auto span = scene::numbers(element, time, 2);
    if (span.size() != 2 || !(span[0] <= span[1]))
      scene::fail(element.source(), "{}: each rest is [begin, end] in ascending order, s", path);
    rest.times.emplace_back(span[0], span[1]);
  }
  if (rest.times.empty()) scene::fail(node->source(), "{} is empty", path);
  return rest;
}

/// Differences of displacements to the next, as slip rates.
std::vector<double> differences(const std::vector<double>& time, const std::vector<double>& displacement) {
  std::vector<double> rates;
  for (std::size_t i = 0; i + 1 < time.size(); ++i)
    rates.push_back((displacement[i + 1] - displacement[i]) / (time[i + 1] - time[i]));
  rates.push_back(rates.back());
  return rates;
}

/// The motion of a record from its columns: time, slip rate or displacement, and the load if it was recorded.
Measurement::History read_history(const std::vector<double>& time, const std::vector<double>& friction,
                                  const std::vector<double>& motion, const std::vector<double>* normal_load,
                                  bool displacement, const SaidRest& said, const Measurement& data,
                                  std::vector<std::string>& notes) {
  Measurement::History history;
  std::vector<double> moved, coefficient;  // where none was recorded, the last one
  bool lost = false;                       // a row
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double load = normal_load ? (*normal_load)[i] : data.normal_load;
    if (!std::isfinite(time[i]) || !std::isfinite(motion[i]) || !std::isfinite(load)) {
      lost = true;
      continue;
    }
    if (lost && !history.time.empty()) history.gaps.push_back(history.time.size() - 1);
    lost = false;
    if (!history.time.empty() && !(time[i] > history.time.back()))
      throw InputError(
          fmt::format("{}: time does not ascend: {} s follows {} s", data.name, time[i], history.time.back()));
    if (!(load > 0))
      throw InputError(fmt::format("{}: normal load {} N at {} s; it must be above 0 for friction to be told",
                                   data.name, load, time[i]));
    history.time.push_back(time[i]), moved.push_back(motion[i]), history.normal_load.push_back(load);
    coefficient.push_back(std::isfinite(friction[i]) ? friction[i] / (data.in_force ? load : 1)
                          : coefficient.empty()      ? 0
                                                     : coefficient.back());
  }
  find_missing_rows(history);
  if (!history.gaps.empty())
    notes.push_back(
        fmt::format("{}: rows are missing at {} places, the first behind {:.6g} s; points behind are left out for as "
                    "long as friction "
                    "hangs on the motion meanwhile",
                    data.name, history.gaps.size(), history.time[history.gaps.front()]));
  constexpr std::size_t fewest = 4;
  if (history.time.size() < fewest)
    throw InputError(fmt::format("{}: a motion needs {} times at least", data.name, fewest));
  auto rest = said.of(history.time, displacement ? differences(history.time, moved) : moved, coefficient);
  if (!displacement) {
    auto gaps = std::move(history.gaps);
    history = analysis::inference::recorded_slip_rate(std::move(history.time), std::move(moved),
                                                      std::move(history.normal_load));
    history.gaps = std::move(gaps);
    history.rest = std::move(rest);
    return history;
  }
  const auto recorded = analysis::inference::recorded_motion(history.time, moved);
  history.slip_rate = recorded.after;
  const auto n = history.time.size();
  const double spacing = (history.time.back() - history.time.front()) / double(n - 1);
  auto errors = recorded.standard_error;
  std::ranges::nth_element(errors, errors.begin() + std::ptrdiff_t(n / 2));
  const auto corners = std::ranges::count(recorded.corner, 1);
  notes.push_back(fmt::format(
      "{}: displacement is known to {:.2g} m{}, by which neighbours tell the slip rate to {:.2g} m/s; the smoothest "
      "motion through them{} tells it to {:.2g} m/s, which is counted in the errors",
      data.name, recorded.noise,
      recorded.resolution > 0 ? fmt::format(" (steps of {:.3g} m)", recorded.resolution) : "",
      std::sqrt(2.0) * recorded.noise / spacing, corners > 0 ? fmt::format(", with {} corners,", corners) : "",
      errors[n / 2]));
  history.recorded = recorded;
  history.rest = std::move(rest);
  return history;
}

/// Leaves of a force that was measured beyond a mass the friction below it. Accelerations are those of neighbours on
/// both sides, which the first and the last time do not have.
void take_off_inertia(const std::vector<double>& time, const std::vector<double>& motion, bool displacement,
                      double mass, std::vector<double>& force) {
  const auto n = time.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (i == 0 || i + 1 == n) {
      force[i] = std::nan("");
      continue;
    }
    const double before = time[i] - time[i - 1], after = time[i + 1] - time[i], span = before + after;
    const double left = (motion[i] - motion[i - 1]) / before, right = (motion[i + 1] - motion[i]) / after;
    // Of slip rates the slope of the parabola through three of them, of displacements its curvature.
    force[i] -= mass * (displacement ? 2 * (right - left) / span : (left * after + right * before) / span);
  }
}

/// The numbers of a file, without rows that lack one or lie outside `low` … `high`.
struct NumbersOfFile {
  scene::RecordSource source;  ///< columns: abscissa, ordinates, motion, standard errors, each where there are any
  bool has_abscissa = true;    ///< else all points are at `data.slip_rate`
  std::size_t ordinates = 1;
  MotionColumns motion = {};
  SaidRest rest = {};
  double low, high;
  double sensor_mass = 0;            ///< kg that move between the contact and the sensor of force
  std::optional<double> error = {};  ///< of every number
  bool errors_by_column = false;     ///< the last one

  /// \param node  a value, or a column, which becomes the last one; null: none is given
  void take_error(const toml::node* node, const std::string& path, const char* si) {
    errors_by_column =
        node && (node->is_table() ||
                 (node->is_string() && !std::isdigit(static_cast<unsigned char>(node->as_string()->get()[0]))));
    if (errors_by_column)
      source.columns.push_back(scene::read_column(*node, path, si));
    else if (node)
      error = scene::number(*node, {path, si, {1e-300, 1e300}, "standard error"});
  }

  void read(Measurement& data, std::vector<std::string>& notes) const {
    std::vector<std::vector<double>> values(source.columns.size());
    const auto end = scene::read_record(source, [&](double, std::span<const std::span<const double>> block) {
      for (std::size_t c = 0; c < block.size(); ++c)
        values[c].insert(values[c].end(), block[c].begin(), block[c].end());
    });
    if (end.gaps > 0)
      notes.push_back(
          fmt::format("{}: {} of {} rows lack a number and are left out", data.name, end.gaps, end.samples));
    const std::size_t first = has_abscissa ? 1 : 0;
    if (sensor_mass > 0)
      take_off_inertia(values[0], values[first + ordinates], motion.displacement, sensor_mass, values[first]);
    for (std::size_t i = 0; i < values[0].size(); ++i) {
      if (std::ranges::any_of(values, [&](const auto& column) { return std::isnan(column[i]); })) continue;
      const double x = has_abscissa ? values[0][i] : data.slip_rate;
      if (x < low || x > high) continue;
      data.x.push_back(x);
      for (std::size_t c = first; c < first + ordinates; ++c) {
        data.y.push_back(values[c][i]);
        if (errors_by_column || error) data.error.push_back(errors_by_column ? values.back()[i] : *error);
      }
    }
    if (data.x.empty()) throw InputError(fmt::format("{}: holds no point between low and high", data.name));
    if (data.kind == Kind::record)
      data.history = read_history(values[0], values[first], values[first + ordinates],
                                  motion.normal_load ? &values[first + ordinates + 1] : nullptr, motion.displacement,
                                  rest, data, notes);
  }
};

/// A motion or the stick–slip of a machine among the data, from which machines are made for each law.
struct MachineOfData {
  std::size_t data;  ///< number of its table, from 0
  bool moves;        ///< else it sticks and slips
  std::string name = {};
  std::vector<double> times = {};                                    ///< s, of a motion
  std::shared_ptr<const analysis::inference::Machine> machine = {};  ///< under the scene's own law

  /// \param law  in place of that of the scene; null: the scene's own
  std::shared_ptr<const analysis::inference::Machine> under(const scene::SceneReader& reader,
                                                            const toml::node* law) const {
    return moves ? machine_of(reader, law, data, name, times) : stick_slip_machine_of(reader, law, data, name);
  }
};

/// What the events of a record of force say, and notes of it.
std::vector<Measurement> read_off(const Measurement& record, const analysis::inference::EventLimits& limits,
                                  std::vector<std::string>& notes) {
  const auto slips = analysis::inference::find_slip_events(record.x, record.y, limits);
  const auto& drops = slips.events;
  constexpr std::size_t fewest = 3;
  if (drops.size() < fewest)
    throw InputError(fmt::format(
        "{}: {} whole events in which force falls by more than {:.4g} N; a fit needs {} (least_drop says from "
        "which fall on an event counts, least_time how long force must stay below)",
        record.name, drops.size(), slips.least_drop, fewest));
  notes.push_back(fmt::format(
      "{}: {} events: falls of more than {:.3g} N (least_drop; any from {:.2g} to {:.2g} N finds as many) that last "
      "longer than {:.3g} s (least_time); noise of {:.2g} N{}",
      record.name, drops.size(), slips.least_drop, slips.same_from, slips.same_to, slips.least_time, slips.noise,
      slips.spikes > 0 ? fmt::format(", {} samples left out as spikes", slips.spikes) : ""));
  constexpr double clear = 2;
  if (slips.same_to < clear * slips.same_from)
    notes.push_back(
        fmt::format("{}: the number of events hangs on least_drop: no gap parts them from noise", record.name));
  std::vector<Measurement> found;
  constexpr EventColumn read[] = {{"recurrence", "s", Measurement::Event::recurrence},
                                  {"force_range", "N", Measurement::Event::force_range}};
  for (const auto& [name, unit, event] : read) {
    auto events = record;
    events.x.clear(), events.y.clear();
    events.event = event;
    events.name += fmt::format(", {}", name);
    const bool recurs = event == Measurement::Event::recurrence;
    for (std::size_t i = recurs ? 1 : 0; i < drops.size(); ++i)
      events.y.push_back(recurs ? drops[i].onset - drops[i - 1].onset : drops[i].size);
    events.x.assign(events.y.size(), record.slip_rate);
    double mean = 0, square = 0;
    for (const double y : events.y) mean += y / double(events.y.size());
    for (const double y : events.y) square += (y - mean) * (y - mean) / double(events.y.size() - 1);
    notes.push_back(fmt::format("{}: {} of {:.6g} {}, with a scatter of {:.2g} {}", events.name, events.y.size(), mean,
                                unit, std::sqrt(square), unit));
    found.push_back(std::move(events));
  }
  return found;
}

/// \throws InputError where neither the data nor [drive] say at which load or speed they were measured.
void require_drive(const scene::SceneReader& reader, scene::Table& table, const Measurement& data,
                   const NumbersOfFile& numbers) {
  const auto said = [&](const char* key) {
    return table.find(key) || reader.document.at_path(fmt::format("drive.{}", key));
  };
  const bool by_speed = data.kind == Kind::frequency_response || data.kind == Kind::hold ||
                        (data.kind == Kind::stick_slip && !numbers.has_abscissa);
  if (by_speed && !said("speed"))
    scene::fail(table.source(), "{} was measured at a speed: give fit.data.speed or drive.speed, m/s", data.name);
  const bool by_load = data.in_force || data.kind == Kind::frequency_response || data.kind == Kind::stick_slip;
  if (by_load && !numbers.motion.normal_load && !said("normal_load"))
    scene::fail(table.source(), "{} was measured at a normal load: give fit.data.normal_load or drive.normal_load, N",
                data.name);
}

/// The standard error of each of these columns: a value or the name of a column, in a table by the columns where there
/// are several. Null: it is to be found.
std::vector<const toml::node*> errors_of(scene::Table& table, const std::vector<std::string>& measured) {
  std::vector<const toml::node*> errors(measured.size(), nullptr);
  const auto* given = table.find("standard_error");
  if (!given) return errors;
  const auto* by_name = given->as_table();
  if (measured.size() == 1 && (!by_name || !by_name->contains(measured.front()))) return {given};
  if (!by_name)
    scene::wrong_kind(*given, table.path("standard_error"),
                      fmt::format("a table such as {{ {} = … }}, for the columns differ", measured.front()));
  scene::Table keys(*given, table.path("standard_error"));
  for (std::size_t i = 0; i < measured.size(); ++i) errors[i] = keys.find(measured[i]);
  keys.finish();
  return errors;
}

/// The recorded columns of a machine's motion, each a measurement, and the machine.
/// \param data  what they have in common \param numbers  without columns
std::vector<Measurement> read_motion(scene::Table& table, scene::SceneReader& reader, const Measurement& data,
                                     NumbersOfFile numbers, MachineOfData& motion) {
  const auto& named = table.required("measured", "columns that were recorded, as 'rosin run' names them");
  const auto measured = scene::texts(named, table.path("measured"));
  if (measured.empty()) scene::fail(named.source(), "{} is empty", table.path("measured"));
  table.required("start", "of the motion at time 0: \"steady\", \"rest\", or a table as [run] takes it");
  auto columns = table.table("columns");
  const ColumnsOfFile file{numbers.source, columns};
  const auto errors = errors_of(table, measured);
  const auto& file_node = *table.find("file");
  const auto time = file.of("time", "s");
  auto all = data;
  numbers.ordinates = 0, numbers.source.columns = {time};
  std::vector<std::string> unsaid;
  scene::located(file_node.source(), [&] {
    numbers.read(all, unsaid);
    if (!(all.x.front() >= 0))
      throw InputError(
          fmt::format("{}: {:.6g} s lies before time 0, at which the motion starts; leave it out by "
                      "low = 0, or give the time an offset",
                      data.name, all.x.front()));
    if (std::ranges::adjacent_find(all.x, std::greater_equal{}) != all.x.end())
      throw InputError(fmt::format("{}: its times must ascend", data.name));
  });
  motion.name = data.name, motion.times = all.x;
  motion.machine = motion.under(reader, nullptr);
  long steps = 0;
  const auto seen = scene::located(table.source(), [&] { return motion.machine->motion({}, 0, 0, steps); });
  std::vector<Measurement> found;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const auto& name = measured[i];
    const auto known = std::ranges::find(seen->names, name);
    const auto& place = named.as_array()->get(i)->source();
    if (known == seen->names.end())
      scene::fail(place, "{}: the motion has no column '{}'{}", table.path("measured"), name,
                  scene::suggestion(name, seen->names));
    if (std::find(measured.begin(), measured.begin() + std::ptrdiff_t(i), name) != measured.begin() + std::ptrdiff_t(i))
      scene::fail(place, "{} names '{}' twice", table.path("measured"), name);
    auto one = data;
    one.column = name, one.unit = seen->units[std::size_t(known - seen->names.begin())];
    one.name += fmt::format(", {}", name);
    auto own = numbers;
    own.ordinates = 1;
    own.source.columns = {time, file.of(name.c_str(), one.unit.c_str())};
    own.take_error(errors[i], table.path("standard_error"), one.unit.c_str());
    scene::located(file_node.source(), [&] { own.read(one, reader.scene.notes); });
    if (name.starts_with("friction_") && reader.scene.model.law->set_valued())
      reader.scene.notes.push_back(fmt::format(
          "{}: friction of a law that sticks jumps where slip begins, and the least squares with it as a "
          "switch passes a sample: they may end off their minimum; displacements and velocities do not jump",
          one.name));
    found.push_back(std::move(one));
  }
  if (columns) columns->finish();
  table.finish();
  return found;
}

/// The measurements of one table of data: one, but for stick–slip and motions, of which each column is one.
/// \param machines  gains that of this table, if it has one
std::vector<Measurement> read_data(const toml::node& node, scene::SceneReader& reader, std::size_t number,
                                   std::vector<MachineOfData>& machines) {
  auto& scene = reader.scene;
  scene::Table table(node, "fit.data");
  table.expect({"type", "file", "columns", "standard_error", "speed", "from", "to", "normal_load", "low", "high",
                "names_line", "decimal"});
  std::vector<std::string> names;
  for (const auto& kind : kinds()) names.emplace_back(kind.name);
  const auto type = scene::choice(table.required("type", "what was measured"), table.path("type"), names);
  auto kind = *std::ranges::find_if(kinds(), [&](const auto& k) { return k.name == type; });
  refuse_without_effect(table, kind);
  const bool finds_events = holds_record(kind), stick_slip = kind.kind == Kind::stick_slip && !finds_events;
  if (kind.kind == Kind::stick_slip && !reader.root.find("oscillator"))
    scene::fail(node.source(),
                "events of stick-slip are those of a machine: give [oscillator], its masses and springs");
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
  NumbersOfFile numbers{.source = scene::read_file(table, reader.folder), .low = -infinity, .high = infinity};
  table.read("low", numbers.low, {"", kind.columns.front().si, {-1e300, 1e300}, "points below are left out"});
  table.read("high", numbers.high, {"", kind.columns.front().si, {-1e300, 1e300}, "points above are left out"});

  analysis::inference::EventLimits limits;
  table.read("least_drop", limits.least_drop, {"", "N", {1e-300, 1e300}, "fall of force from which on it is an event"});
  table.read("least_time", limits.least_time, {"", "s", {0, 1e15}, "for which force stays below after an event"});
  const auto& file_node = *table.find("file");
  data.name = numbers.source.file.filename().string();
  numbers.source.gaps = true;
  if (kind.kind == Kind::motion) {
    data.machine = machines.size();
    return read_motion(table, reader, data, numbers, machines.emplace_back(number, true));
  }
  if (kind.kind == Kind::stick_slip && scene.structure) {
    data.machine = machines.size();
    auto& machine = machines.emplace_back(number, false, data.name);
    machine.machine = machine.under(reader, nullptr);
  }
  auto columns = table.table("columns");
  const ColumnsOfFile file{numbers.source, columns};
  std::vector<scene::RecordColumn> chosen;
  std::vector<EventColumn> events;
  if (kind.kind == Kind::record) {
    numbers.motion = choose_motion(kind, file, data);
    numbers.rest = read_rest(table);
    table.read("sensor_mass", numbers.sensor_mass,
               {"", "kg", {0, 1e9}, "moving mass between the contact and the sensor of force"});
    if (numbers.sensor_mass > 0 && !data.in_force)
      scene::fail(table.find("sensor_mass")->source(),
                  "fit.data.sensor_mass takes inertia off a force: {} has a column of friction coefficients",
                  data.name);
  }
  if (stick_slip) {
    events = choose_events(table, file);
    numbers.has_abscissa = file.has("speed", "m/s");
    if (const auto* key = table.find("speed"); key && numbers.has_abscissa)
      scene::fail(key->source(), "fit.data.speed has no effect: {} has a column of speeds", data.name);
    if (!numbers.has_abscissa) kind.columns.clear();
  } else {
    numbers.ordinates = kind.columns.size() - 1;
  }
  for (const auto& column : kind.columns) chosen.push_back(file.of(column.name, column.si));
  chosen.insert(chosen.end(), numbers.motion.columns.begin(), numbers.motion.columns.end());
  std::vector<scene::RecordColumn> columns_of_events;
  for (const auto& event : events) columns_of_events.push_back(file.of(event.name, event.si));
  if (columns) columns->finish();
  const auto* error = data.pairs()
                          ? &table.required("standard_error", "of each number: a value, or the name of a column")
                          : table.find("standard_error");
  if (error && events.size() > 1)
    scene::fail(error->source(),
                "fit.data.standard_error cannot hold for {} kinds of events at once: name one by "
                "events = [\"{}\"], and give each a table of data of its own",
                events.size(), events.front().name);
  const char* si = stick_slip ? events.front().si : kind.columns.back().si;
  table.finish();
  std::vector<Measurement> found;
  const auto add = [&](Measurement measurement, std::vector<scene::RecordColumn> own) {
    numbers.source.columns = std::move(own);
    numbers.take_error(error, table.path("standard_error"), si);
    scene::located(file_node.source(), [&] { numbers.read(measurement, scene.notes); });
    found.push_back(std::move(measurement));
  };
  require_drive(reader, table, data, numbers);
  if (!stick_slip) add(data, chosen);
  if (finds_events) {
    const auto record = std::move(found.front());
    return scene::located(file_node.source(), [&] { return read_off(record, limits, scene.notes); });
  }
  for (std::size_t i = 0; i < events.size(); ++i) {
    auto own = chosen;
    own.push_back(columns_of_events[i]);
    auto measurement = data;
    measurement.event = events[i].event;
    measurement.name += fmt::format(", {}", events[i].name);
    add(std::move(measurement), std::move(own));
  }
  return found;
}

/// True for a table of data whose type begins so.
bool has_data(const toml::node& fit, std::string_view type) {
  const auto* table = fit.as_table();
  const auto* data = table ? table->get_as<toml::array>("data") : nullptr;
  return data && std::ranges::any_of(*data, [&](const toml::node& element) {
           const auto* one = element.as_table();
           return one && (*one)["type"].value_or(std::string_view()).starts_with(type);
         });
}

/// Formulas over numbers of the scene, which must stand in it or be fitted.
std::vector<analysis::inference::DerivedNumber> read_derived(scene::Table& table, const scene::SceneReader& reader,
                                                             const analysis::inference::Subject& subject,
                                                             const std::vector<std::string>& parameters) {
  std::vector<analysis::inference::DerivedNumber> found;
  const auto* node = table.find("derived");
  if (!node) return found;
  const auto fitted = [&](const std::string& path) { return std::ranges::find(parameters, path) != parameters.end(); };
  if (!node->is_table())
    scene::wrong_kind(*node, table.path("derived"), "a table of formulas: name = \"law.a - law.b\"");
  for (const auto& [key, formula] : *node->as_table()) {
    const std::string name(key.str()), path = table.path("derived") + "." + name;
    if (name.empty() || fitted(name))
      scene::fail(formula.source(), "{}: this name is {}; take another", path,
                  name.empty() ? "empty" : "the path of a fitted number");
    const auto text = scene::text(formula, path);
    scene::located(formula.source(), [&] {
      auto& number = found.emplace_back(name, text, subject);
      if (std::ranges::none_of(number.paths(), fitted))
        throw InputError(fmt::format("{}: '{}' holds no number that is fitted; those are {}", path, text,
                                     fmt::join(parameters, ", ")));
      for (const auto& used : number.paths())
        if (subject.machines.empty() && !used.starts_with("law.") && !fitted(used) && !reader.document.at_path(used))
          throw InputError(fmt::format("{}: the scene has no {}; give it", path, used));
    });
  }
  return found;
}

}  // namespace

bool fits_stick_slip(const toml::node& fit) { return has_data(fit, "stick-slip"); }
bool fits_a_machine(const toml::node& fit) { return has_data(fit, "motion"); }

void read_fit(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  auto& task = scene.task<tasks::Fit>();
  auto& options = task.options;
  table.expect({"parameters", "data", "candidates", "starts", "seed", "profiles", "folds", "confidence", "derived"});
  const auto& data = table.required("data", "tables with type and file");
  std::vector<MachineOfData> machines;
  std::size_t number = 0;
  for (const auto& element : scene::list(data, "fit.data", "tables", scene::most_names)) {
    auto measurements = read_data(element, reader, number++, machines);
    std::ranges::move(measurements, std::back_inserter(task.data));
  }
  if (task.data.empty()) scene::fail(data.source(), "fit.data is empty");
  const bool with_slider = std::ranges::any_of(task.data, [](const auto& m) { return m.kind == Kind::stick_slip; });
  const auto subject = [&](const oscillators::Model& model, const toml::node* law) {
    analysis::inference::Subject all(model);
    for (const auto& one : machines) all.machines.push_back(law ? one.under(reader, law) : one.machine);
    return all;
  };
  const auto read_parameters = [&](const toml::node& node, const std::string& path,
                                   const analysis::inference::Subject& model) {
    const auto paths = scene::texts(node, path);
    for (std::size_t i = 0; i < paths.size(); ++i)
      scene::located(node.as_array()->get(i)->source(),
                     [&] { analysis::inference::require_fittable(model, paths[i], with_slider); });
    if (paths.empty()) scene::fail(node.source(), "{} is empty", path);
    return paths;
  };
  auto own = subject(scene.model, nullptr);
  auto parameters = read_parameters(table.required("parameters", "paths, such as law.a"), "fit.parameters", own);
  auto derived = read_derived(table, reader, own, parameters);
  task.candidates.push_back(
      {std::string(scene.model.law->card().name), std::move(own), std::move(parameters), std::move(derived)});
  if (const auto* candidates = table.find("candidates"))
    for (const auto& element : scene::list(*candidates, "fit.candidates", "tables", scene::most_names)) {
      scene::Table keys(element, "fit.candidates");
      keys.expect({"name", "law", "parameters", "derived"});
      auto model = scene.model;
      model.lambda = 1;
      model.contact_stiffness = {};
      model.load_memory = 0;
      const auto& law = keys.required("law", "the friction law");
      scene::read_law(reader, scene::Table(law, "fit.candidates.law"), model);
      tasks::Fit::Candidate candidate{std::string(model.law->card().name), subject(model, &law), {}, {}};
      if (const auto* name = keys.find("name")) candidate.name = scene::text(*name, keys.path("name"));
      candidate.parameters =
          read_parameters(keys.required("parameters", "paths"), "fit.candidates.parameters", candidate.subject);
      candidate.derived = read_derived(keys, reader, candidate.subject, candidate.parameters);
      keys.finish();
      for (const auto& other : task.candidates)
        if (other.name == candidate.name)
          scene::fail(element.source(), "fit.candidates: two are named '{}'; give one of them a name", candidate.name);
      task.candidates.push_back(std::move(candidate));
    }
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
