/// Bowed strings: one motion with its sound, and planes of transients.
#include "app/verbs/string_verbs.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/planes/map.hpp"
#include "analysis/strings/strings.hpp"
#include "app/output/pictures.hpp"
#include "app/output/wav.hpp"
#include "app/results/axis.hpp"
#include "app/scene/family.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/string.hpp"
#include "app/tasks/bowing.hpp"
#include "app/tasks/sweep.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/plane_job.hpp"
#include "app/verbs/progress.hpp"
#include "oscillators/bowed_string.hpp"

namespace rosin::app::verbs {

using analysis::strings::Bowing;
using analysis::strings::Pixel;
using analysis::strings::StringRecord;
using nlohmann::ordered_json;

namespace {

std::string name_of(analysis::strings::StringRegime regime) {
  return analysis::strings::string_regime_names()[std::size_t(regime)];
}

}  // namespace

std::vector<StringColumn> columns_of(const StringRecord& record, const tasks::Bowing& task) {
  std::vector<StringColumn> columns = {{"bow_speed", "m/s", &record.bow_speed},
                                       {"string_velocity", "m/s", &record.velocity},
                                       {"slip_rate", "m/s", &record.slip_rate},
                                       {"friction_force", "N", &record.friction},
                                       {"normal_load", "N", &record.normal_load},
                                       {"bridge_force", "N", &record.bridge_force},
                                       {"stick", "1", &record.stick}};
  const auto states = oscillators::BowContacts::state_names(*task.model.law);
  for (std::size_t k = 0; k < record.states.size(); ++k)
    columns.push_back({states[k].name, states[k].unit, &record.states[k]});
  for (std::size_t m = 0; m < record.contact_velocity.size(); ++m) {
    columns.push_back({fmt::format("string_velocity_{}", m + 1), "m/s", &record.contact_velocity[m]});
    columns.push_back({fmt::format("friction_force_{}", m + 1), "N", &record.contact_friction[m]});
  }
  if (task.sound) columns.push_back({"sound", task.sound->unit, &record.heard});
  columns.push_back({"nut_force", "N", &record.nut_force});
  return columns;
}

namespace {

/// Every so many samples.
StringRecord thinned(StringRecord record, int most) {
  const auto every = (record.time.size() + std::size_t(most) - 1) / std::size_t(most);
  if (every <= 1) return record;
  const auto thin = [&](std::vector<double>& list) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < list.size(); i += every) list[kept++] = list[i];
    list.resize(kept);
  };
  for (auto* list : {&record.time, &record.bow_speed, &record.velocity, &record.friction, &record.slip_rate,
                     &record.normal_load, &record.bridge_force, &record.nut_force, &record.stick, &record.heard})
    thin(*list);
  for (auto* lists : {&record.states, &record.contact_velocity, &record.contact_friction})
    for (auto& list : *lists) thin(list);
  return record;
}

/// With the differences to a finer string, but of times no less than a sample.
/// \param most  periods: a transient of this length is none
std::vector<StringMetric> metrics_of_string(const oscillators::BowedString& string, const Bowing& bowing,
                                            const Bowing& finer, double most) {
  const auto one = [&](const char* name, const char* unit, const char* meaning, double resolution, auto of) {
    const double value = of(bowing), other = of(finer);
    return StringMetric{name, unit, meaning, value, std::max(std::abs(value - other), resolution)};
  };
  const double sample = string.step(), periods = sample / string.period();
  return {one("first_slip", "s", "time of the first slip", sample, [](const Bowing& b) { return b.first_slip; }),
          one("transient_length", "1", "from there to Helmholtz motion, periods of the open string", periods,
              [most](const Bowing& b) { return b.transient.length < most ? b.transient.length : NAN; }),
          one("slips_per_period", "1", "slips per period at the end", 0,
              [](const Bowing& b) { return b.transient.slips_per_period; }),
          one("period", "1", "period at the end over that of the open string", periods,
              [](const Bowing& b) { return b.transient.period; }),
          one("bridge_force", "N", "force on the bridge at the end, peak to peak", 0,
              [](const Bowing& b) { return b.bridge_force; })};
}

results::Table table_of(std::string name, const StringRecord& record, const tasks::Bowing& task) {
  std::vector<results::Column> columns = {{{"time", "s"}, record.time}};
  for (const auto& column : columns_of(record, task)) columns.push_back({{column.name, column.unit}, *column.values});
  return results::rows(std::move(name), std::move(columns));
}

std::string sound_file(const tasks::Bowing& task) { return task.sound ? "sound.wav" : "bridge.wav"; }

results::Result result_of(const Job& job, const StringRecord& record, const std::vector<StringMetric>& metrics,
                          const oscillators::StringLanes& realised, double full_scale) {
  const auto& task = *job.scene().string;
  const auto& transient = record.bowing.transient;
  auto result = job.result(record.bowing.outcome);
  auto table = table_of("run", record, task);
  result.add_record(table);
  auto& events = result["events"] = ordered_json::array();
  const double step = task.model.string.step();
  for (const auto& slip : transient.slips)
    events.push_back({{"time", double(slip.on) * step},
                      {"kind", "slip"},
                      {"duration", double(slip.off - slip.on) * step},
                      {"distance", slip.distance},
                      {"bow_speed", slip.bow_speed}});
  result["regime"] = name_of(transient.regime);
  auto values = ordered_json::object();
  for (const auto& metric : metrics) {
    values[metric.name] = metric.value;
    const bool is_column = result["columns"].contains(metric.name);  // whose unit and meaning stand there
    result.describe({metric.name, is_column ? "" : metric.unit, is_column ? "" : metric.meaning}, metric.error);
  }
  result["metrics"] = std::move(values);
  result["string"] = {{"surface_impedance", task.model.string.surface_impedance()},
                      {"realised_frequency", realised.realised_frequency()},
                      {"realised_bow_position", realised.realised_bow_position()}};
  result["sound"] = {{"file", sound_file(task)},
                     {"full_scale", full_scale},
                     {"unit", task.sound ? task.sound->unit : "N"},
                     {"above", output::lowest_heard}};
  result["solver"] = "travelling waves";
  result.cost = {{"steps", record.bowing.samples}};
  result.tables = {std::move(table)};
  return result;
}

}  // namespace

StringRun run_of(const tasks::Bowing& task) {
  const auto finer = analysis::strings::finer(task.model);
  StringRun run{analysis::strings::record(task.model, task.options), {}};
  const auto add_metrics = [&](const Bowing& fine) {
    run.metrics = metrics_of_string(task.model.string, run.record.bowing, fine, task.options.transient.most);
  };
  if (!task.sound) {
    add_metrics(analysis::strings::bow(finer, task.options));
    return run;
  }
  auto fine = analysis::strings::record(finer, task.options);
  add_metrics(fine.bowing);
  const int periods = task.options.transient.periods;
  const double level = analysis::strings::hear(run.record, task.sound->response, task.model, periods),
               finely = analysis::strings::hear(fine, task.sound->response, finer, periods);
  run.metrics.push_back({"sound", task.sound->unit.c_str(), "root mean square about the mean at the end", level,
                         std::abs(level - finely)});
  return run;
}

Status perform_string_run(Job& job) {
  auto& scene = job.scene();
  const auto& task = *scene.string;
  const auto& string = task.model.string;
  const oscillators::StringLanes realised(string, task.model.law, task.model.lambda);
  job.explain(
      "waves between bridge, bow and nut at {} samples per second; beta {:.6g}, {:.6g} Hz as the delays have it",
      string.sample_rate, realised.realised_bow_position(), realised.realised_frequency());
  job.explain("{}", string.torsion ? "torsional waves beside the transverse ones" : "no torsional waves, as asked");
  if (task.sound)
    job.explain("sound: the bridge's force through the response, which is linear between its rows, integrated exactly");
  const auto begin = std::chrono::steady_clock::now();
  const auto [record, metrics] = run_of(task);
  job.explain("{} steps, and as many again at twice the sample rate, whose difference is the error",
              record.bowing.samples);
  auto& manifest = job.manifest();
  manifest.cost = {{"seconds", seconds_since(begin)}, {"steps", double(record.bowing.samples)}};
  Reached reached;
  for (const auto& metric : metrics) reached.add(metric.value, metric.error);
  manifest.tolerance_reached = reached.value();

  const auto& transient = record.bowing.transient;
  job.say("{} samples over {:.6g} s, {} slips; at the end: {}", record.bowing.samples,
          double(record.bowing.samples) * string.step(), transient.slips.size(), name_of(transient.regime));
  for (const auto& metric : metrics)
    if (std::isfinite(metric.value))
      job.say("  {:<18} {}  ({})", metric.name, justified_above_zero(metric.value, metric.error, metric.unit),
              metric.meaning);
  if (transient.length >= task.options.transient.most && !transient.slips.empty())
    job.say("  no Helmholtz motion within {} periods of the first slip", task.options.transient.most);
  const double full_scale = output::write_wav(job.folder() / sound_file(task), record.sound, string.sample_rate);
  const auto kept = thinned(record, task.samples);
  if (std::ssize(kept.time) < record.bowing.samples) {
    scene.notes.push_back(
        fmt::format("run.csv has {} of {} samples, evenly, so that a spectrum of it aliases; run.samples = {} keeps {}",
                    kept.time.size(), record.bowing.samples, std::min(record.bowing.samples, long(scene::most_points)),
                    record.bowing.samples > long(scene::most_points) ? "more" : "all"));
    job.note(scene.notes.back());
  }
  std::vector<std::string> files = {sound_file(task)};
  if (kept.time.size() > 1)
    for (auto& file : output::write_string_picture(job.folder(), scene, kept)) files.push_back(std::move(file));
  return job.finish(result_of(job, kept, metrics, realised, full_scale), std::move(files));
}

Status perform_string_stability(Job& job) {
  auto& scene = job.scene();
  const auto& model = scene.string->model;
  job.explain(
      "modes of the open string followed to those under the sliding bow; waves as they are sampled, friction "
      "linearised; no motion is computed");
  if (!model.speed.constant() || !model.load.constant())
    job.note("the bow changes its speed or load: stability is that of its start");
  const auto begin = std::chrono::steady_clock::now();
  const auto sliding = analysis::strings::sliding_stability(model);
  job.manifest().cost = {{"seconds", seconds_since(begin)}};
  job.say("steady sliding at {:.6g} m/s under {:.6g} N: friction coefficient {:.10g}, force {:.10g} N",
          sliding.slip_rate, model.load.value(0), sliding.friction_coefficient, sliding.friction_force);
  job.say("friction changes by {:.6g} N s/m with the slip rate, at once; the string resists by {:.6g} N s/m",
          sliding.slope, sliding.impedance);
  const int growing = sliding.unstable_modes();
  if (sliding.jumps)
    job.say(
        "unstable: friction falls by more than the string resists, so that the slip rate jumps before a wave returns");
  else
    job.say("{}", sliding.stable ? "stable: the bow slides, and no partial grows"
                  : growing > 0  ? fmt::format("unstable: {} partials grow, the fastest by {:.6g} 1/s at {:.6g} Hz",
                                               growing, sliding.modes.front().eigenvalue.real(),
                                               sliding.modes.front().eigenvalue.imag() / (2 * std::numbers::pi))
                                 : "marginal: no partial grows by more than its error");
  auto result = job.result(sliding.outcome);
  result["steady"] = {{"slip_rate", sliding.slip_rate},
                      {"friction_coefficient", sliding.friction_coefficient},
                      {"friction_force", sliding.friction_force}};
  result.add({"slope", "N s/m"}, sliding.slope);
  result.add({"impedance", "N s/m"}, sliding.impedance);
  result["jumps"] = sliding.jumps;
  result["stable"] = sliding.stable;
  result["marginal"] = !sliding.stable && !sliding.jumps && growing == 0 && sliding.outcome.complete();
  result["unstable_modes"] = sliding.jumps ? ordered_json() : ordered_json(growing);
  std::vector<std::complex<double>> eigenvalues;
  for (const auto& mode : sliding.modes) eigenvalues.push_back(mode.eigenvalue);
  result.add({"eigenvalues", "1/s"}, results::pairs(eigenvalues));
  auto& modes = result["modes"] = ordered_json::array();
  Reached reached;
  constexpr std::size_t shown = 10;
  if (!sliding.modes.empty()) job.say("  {:>9} {:>24} {:>24}", "partial", "frequency (Hz)", "growth (1/s)");
  for (const auto& mode : sliding.modes) {
    const double turn = 2 * std::numbers::pi, frequency = mode.eigenvalue.imag() / turn,
                 growth = mode.eigenvalue.real();
    if (modes.size() < shown) {
      job.say("  {:>9} {:>24} {:>24}", fmt::format("{}{}", mode.partial, mode.torsional ? " twist" : ""),
              justified(frequency, mode.error / turn, "1"), justified(growth, mode.error, "1"));
      reached.add(std::abs(mode.eigenvalue), mode.error);
    }
    modes.push_back({{"partial", mode.partial},
                     {"waves", mode.torsional ? "torsional" : "transverse"},
                     {"frequency", frequency},
                     {"growth_rate", growth},
                     {"damping_ratio", -growth / std::abs(mode.eigenvalue)},
                     {"error", {{"eigenvalue", mode.error}}}});
  }
  job.manifest().tolerance_reached = reached.value();
  return job.finish(result);
}

Status perform_string_cycle(Job& job) {
  auto& scene = job.scene();
  const auto& task = *scene.string;
  const auto& transient = task.options.transient;
  job.explain("{:g} periods of the open string from {}, at {} samples per second and at twice that", task.periods,
              task.model.start == oscillators::StringStart::rest ? "rest" : "Helmholtz motion",
              task.model.string.sample_rate);
  const auto begin = std::chrono::steady_clock::now();
  const auto options = analysis::strings::until_periodic(task.model, task.periods, transient);
  auto record = analysis::strings::record(task.model, options);
  const auto again = analysis::strings::bow(analysis::strings::finer(task.model), options);
  const auto cycle = analysis::strings::cycle_of(task.model, record.bowing, again, transient);
  job.manifest().cost = {{"seconds", seconds_since(begin)}, {"steps", double(cycle.samples)}};
  auto result = job.result(cycle.outcome);
  Reached reached;
  job.say("after {:g} periods: {}", task.periods, name_of(cycle.regime));
  for (const auto& [name, unit, meaning, member] : analysis::strings::string_period_names()) {
    const auto& measure = cycle.period.*member;
    result.add({name, unit}, measure.value, measure.error);
    if (std::isnan(measure.value)) continue;
    reached.add(measure.value, measure.error);
    job.say("{:<22} {}", name, justified(measure.value, measure.error, unit));
  }
  job.manifest().tolerance_reached = reached.value();
  result["regime"] = name_of(cycle.regime);
  result.cost = {{"steps", cycle.samples}};
  if (std::isfinite(cycle.period.period.value)) {
    const auto kept = std::size_t(std::lround(cycle.period.period.value * task.model.string.sample_rate)) + 1;
    auto table = table_of("cycle", record, task);
    for (auto& column : table.columns) {  // of the last period
      auto& values = std::get<std::vector<double>>(column.values);
      values.erase(values.begin(), values.end() - std::ptrdiff_t(std::min(kept, values.size())));
      table.dimensions.front().length = values.size();
    }
    auto& time = std::get<std::vector<double>>(table.columns.front().values);
    const double first = time.front();
    for (double& t : time) t -= first;
    result.tables = {std::move(table)};
  }
  return job.finish(result);
}

analysis::planes::Sweep sweep_of_strings(Job& job) {
  auto& scene = job.scene();
  const auto& task = *scene.string;
  const auto& options = scene.task<tasks::Sweep>().options;
  const auto& axis = options.axis;
  analysis::planes::Sweep sweep;
  std::size_t place = 0;
  for (const auto& [name, unit, meaning, member] : analysis::strings::string_period_names())
    sweep.metrics.push_back({name, unit, meaning, nullptr, place++});
  const auto add = [](std::vector<analysis::planes::SweepPoint>& points,
                      const std::vector<analysis::strings::StringCycle>& cycles) {
    for (const auto& cycle : cycles) {
      auto& point = points.emplace_back();
      point.done = true;
      point.metrics = analysis::planes::undecided_point();
      point.metrics.done = true, point.metrics.origin = analysis::planes::Origin::computed;
      for (const auto& metric : analysis::strings::string_period_names()) {
        point.metrics.measures.push_back((cycle.period.*metric.member).value);
        point.metrics.measure_errors.push_back((cycle.period.*metric.member).error);
      }
      point.metrics.regime = cycle.outcome.complete() ? analysis::planes::Regime::cycle
                             : cycle.regime == analysis::strings::StringRegime::sliding
                                 ? analysis::planes::Regime::stable
                                 : analysis::planes::Regime::failed;
      if (!cycle.outcome.complete())
        point.why = fmt::format("{}: {}", name(cycle.outcome.ending), cycle.outcome.detail);
    }
  };
  if (options.anew) {
    std::vector<oscillators::BowedStringModel> models;
    for (const double value : axis.values) {
      models.push_back(scene.family->string_with({{axis.parameter, value}}));
      models.back().start = task.model.start;  // of [cycle], which a family does not vary
    }
    add(sweep.up,
        analysis::strings::string_cycles(models, task.periods, task.options.transient, job.request().threads));
  } else {
    const bool by_load = axis.parameter == "drive.normal_load";
    std::vector<std::vector<double>> ways;
    if (options.up) ways.push_back(axis.values);
    if (options.down) ways.emplace_back(axis.values.rbegin(), axis.values.rend());
    auto cycles = analysis::strings::string_cycles_along(
        task.model, by_load ? &oscillators::BowedStringModel::load : &oscillators::BowedStringModel::speed, ways,
        task.periods, task.options.transient);
    if (options.down) std::ranges::reverse(cycles.back());
    if (options.up) add(sweep.up, cycles.front());
    if (options.down) add(sweep.down, cycles.back());
  }
  sweep.thresholds_left_out = "thresholds of steady sliding are those of 'stability', value by value";
  return sweep;
}

void read_string_map(scene::SceneReader& reader, scene::Table table) {
  scene::read_string(reader);
  auto& scene = reader.scene;
  auto& task = *scene.string;
  scene.family = std::make_shared<scene::Family>(reader, "map", true);
  table.expect({"x", "y", "finer", "within", "good"});
  const auto &x = table.required("x", "first axis"), &y = table.required("y", "second axis");
  task.x = read_axis(scene::Table(x, table.path("x")), scene);
  task.y = read_axis(scene::Table(y, table.path("y")), scene);
  if (task.x.parameter == task.y.parameter)
    scene::fail(y.source(), "map.x and map.y are the same parameter, {}", task.y.parameter);
  if (task.x.values.size() > 1'000'000 / task.y.values.size())
    scene::fail(table.source(), "map has {} x {} strings, more than 1000000", task.x.values.size(),
                task.y.values.size());
  if (const auto* finer = table.find("finer")) {
    task.plane.finer.clear();
    for (const auto& factor : scene::list(*finer, table.path("finer"), "factors of the sample rate", 10))
      task.plane.finer.push_back(scene::count(factor, table.path("finer"), 2, 64, "factor of the sample rate"));
  }
  if (const auto* within = table.find("within"); within && task.plane.finer.empty())
    scene::fail(within->source(), "{} has no effect without {}", table.path("within"), table.path("finer"));
  table.read(
      "within", task.plane.within,
      {"", "1", {1e-9, 1e3}, "difference of a transient that is reproducible at finer sample rates, in periods"});
  table.read("good", task.good, {"", "1", {0, 1e5}, "transients that are shorter are good, in periods"});
  table.finish();
  task.plane.bowing = task.options;
}

namespace {

/// The plane as others are, for files: metrics of points with their errors.
analysis::planes::Map as_map(const tasks::Bowing& task, const std::vector<Pixel>& pixels) {
  analysis::planes::Map map;
  map.x = task.x, map.y = task.y;
  const std::pair<std::array<const char*, 3>, double (*)(const Pixel&)> metrics[] = {
      {{"transient_length", "1", "from the first slip to Helmholtz motion, periods of the open string"},
       [](const Pixel& p) { return p.bowing.transient.length; }},
      {{"string_regime", "1",
        "motion at the end: 0 none, 1 helmholtz, 2 double-slip, 3 irregular, 4 raucous, 5 sliding"},
       [](const Pixel& p) { return double(p.bowing.transient.regime); }},
      {{"first_slip", "s", "time of the first slip"}, [](const Pixel& p) { return p.bowing.first_slip; }},
      {{"slips_per_period", "1", "slips per period at the end"},
       [](const Pixel& p) { return p.bowing.transient.slips_per_period; }},
      {{"bridge_force", "N", "force on the bridge at the end, peak to peak"},
       [](const Pixel& p) { return p.bowing.bridge_force; }},
      {{"reproducible", "1", "1 where finer sample rates have the same transient"},
       [](const Pixel& p) { return p.reproducible ? 1.0 : 0.0; }}};
  std::size_t place = 0;
  for (const auto& [text, of] : metrics) map.metrics.push_back({text[0], text[1], text[2], nullptr, place++});
  for (const auto& pixel : pixels) {
    auto point = analysis::planes::undecided_point();
    point.regime = pixel.bowing.outcome.complete() ? analysis::planes::Regime::cycle : analysis::planes::Regime::failed;
    point.origin = analysis::planes::Origin::computed;
    point.done = true;
    point.why = pixel.bowing.outcome.detail;
    for (const auto& [text, of] : metrics) {
      point.measures.push_back(of(pixel));
      point.measure_errors.push_back(text[0] == std::string("transient_length") ? pixel.length_error : NAN);
    }
    map.points.push_back(std::move(point));
  }
  map.integrated = long(pixels.size());
  return map;
}

}  // namespace

std::vector<oscillators::BowedStringModel> strings_of_plane(
    const tasks::Bowing& task, const scene::Family& family,
    const std::vector<std::pair<std::string, double>>& changed) {
  std::vector<oscillators::BowedStringModel> models;
  for (const double y : task.y.values)
    for (const double x : task.x.values) {
      auto values = changed;
      values.emplace_back(task.x.parameter, x), values.emplace_back(task.y.parameter, y);
      models.push_back(family.string_with(values));
      models.back().start = task.model.start;  // of [run], which a family does not vary
    }
  return models;
}

/// Over each value of x the least and the largest y at which the string speaks well; each lies within a step of the
/// grid from the border.
void add_playable(Job& job, results::Result& result, const std::vector<Pixel>& pixels) {
  const auto& task = *job.scene().string;
  const auto &xs = task.x.values, &ys = task.y.values;
  const auto axis = [&](const analysis::planes::Axis& of) {
    return of.parameter == "drive.speed.ramp.rate" ? Quantity{"acceleration of the bow", "m/s²", {}, ""}
                                                   : job.scene().describe(of.parameter);
  };
  const auto x = axis(task.x), y = axis(task.y);
  auto& list = result["playable"] = ordered_json::array();
  constexpr std::size_t most_lines = 12;
  const std::size_t every = (xs.size() + most_lines - 1) / most_lines;
  for (std::size_t ix = 0; ix < xs.size(); ++ix) {
    double least = NAN, largest = NAN;
    std::size_t count = 0;
    for (std::size_t iy = 0; iy < ys.size(); ++iy) {
      const auto& transient = pixels[iy * xs.size() + ix].bowing.transient;
      if (!(transient.length < task.good)) continue;
      ++count, least = std::fmin(least, ys[iy]), largest = std::fmax(largest, ys[iy]);
    }
    list.push_back({{"x", xs[ix]}, {"least", least}, {"largest", largest}, {"count", count}});
    if (ix % every != 0) continue;
    const auto unit = [](const Quantity& of) { return of.unit == "1" ? std::string() : " " + of.unit; };
    if (count == 0)
      job.say("  at {} {:.4g}{}: nowhere", x.name, xs[ix], unit(x));
    else
      job.say("  at {} {:.4g}{}: from {:.4g} to {:.4g}{} of {}, {} of {} values", x.name, xs[ix], unit(x), least,
              largest, unit(y), y.name, count, ys.size());
  }
}

Status perform_string_map(Job& job) {
  auto& scene = job.scene();
  auto& task = *scene.string;
  task.plane.threads = job.request().threads;
  const auto nx = task.x.values.size(), ny = task.y.values.size();
  job.explain("{} x {} strings over {} and {}, each until {} periods after its first slip", nx, ny, task.x.parameter,
              task.y.parameter, task.options.periods_after);
  if (task.plane.finer.empty())
    job.explain("no finer sample rate, as asked: which pixels are reproducible is not known");
  else
    job.explain("the same at {} times the sample rate tells which pixels are reproducible",
                fmt::join(task.plane.finer, " and "));
  const auto models = strings_of_plane(task, *scene.family, {});
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Pixel> pixels;
  {
    Progress progress(job.request().quiet);
    double all = 1;  // work of all passes, in that of the first
    for (const int factor : task.plane.finer) all += factor;
    std::size_t done = 0, pass = 0;
    double work = 0;
    pixels = bow_plane(models, task.plane, [&](std::size_t, std::size_t k) {
      if (k != pass) pass = k, done = 0;
      ++done;
      work += (k == 0 ? 1 : task.plane.finer[k - 1]) / (all * double(models.size()));
      progress.show(done, models.size(), std::min(work, 1.0));
    });
  }
  const double seconds = seconds_since(begin);
  long steps = 0;
  for (const auto& pixel : pixels) steps += pixel.bowing.samples;
  const auto found = statistics_of(pixels, nx, task.good, task.options.transient.most);
  job.say("{} x {} strings in {:.3g} s", nx, ny, seconds);
  job.say("  {:<34} {} of {}", fmt::format("transients below {:g} periods", task.good), found.good, pixels.size());
  if (!task.plane.finer.empty()) {
    job.say("  {:<34} {} of {}", "reproducible at finer rates", found.reproducible, pixels.size());
    job.say("  {:<34} {}", "good and reproducible", found.good_and_reproducible);
  }
  job.say("  {:<34} {:.3g}, {} speckles", "edges between good and others", found.edge_density, found.speckles);
  if (found.failed > 0) job.say("  {:<34} {}", "failed", found.failed);

  const auto map = as_map(task, pixels);
  auto result = job.result();
  result["x"] = results::axis(task.x, scene);
  result["y"] = results::axis(task.y, scene);
  result["regime"] = results::grid(map, [&](std::size_t i) { return name_of(pixels[i].bowing.transient.regime); });
  auto values = ordered_json::object();
  for (const auto& metric : map.metrics)
    if (metric.name != "string_regime")
      values[metric.name] = results::grid_of_points(map, [&](const auto& point) { return metric.value(point); });
  result["metrics"] = std::move(values);
  result["error"] = {{"transient_length", results::grid(map, [&](std::size_t i) { return pixels[i].length_error; })}};
  result["statistics"] = {{"good", found.good},
                          {"good_below", task.good},
                          {"shorter_than_most", found.shorter_than_most},
                          {"reproducible", found.reproducible},
                          {"good_and_reproducible", found.good_and_reproducible},
                          {"speckles", found.speckles},
                          {"edge_density", found.edge_density},
                          {"failed", found.failed}};
  job.say("transients below {:g} periods:", task.good);
  add_playable(job, result, pixels);
  auto& failures = result["failures"] = ordered_json::array();
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (!pixels[i].bowing.outcome.complete())
      failures.push_back({{"ix", i % nx}, {"iy", i / nx}, {"why", pixels[i].bowing.outcome.detail}});
  result.cost = {{"seconds", seconds}, {"points", pixels.size()}, {"steps", steps}};
  result.tables = {table_of(scene, map)};
  job.manifest().cost = {{"seconds", seconds}, {"points", double(pixels.size())}, {"steps", double(steps)}};
  return job.finish(result, output::write_string_picture(job.folder(), scene, pixels));
}

}  // namespace rosin::app::verbs
