/// The verbs of the command.
#include "app/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "app/compare.hpp"
#include "app/files.hpp"
#include "app/fit.hpp"
#include "app/frf.hpp"
#include "app/gnuplot.hpp"
#include "app/job.hpp"
#include "app/partial.hpp"
#include "app/pictures.hpp"
#include "app/planes.hpp"
#include "app/progress.hpp"
#include "app/results.hpp"
#include "app/scene.hpp"
#include "app/stopping.hpp"
#include "app/stress.hpp"
#include "app/study.hpp"
#include "app/verify/verify.hpp"
#include "bench/bench.hpp"
#include "core/console.hpp"
#include "laws/catalogue.hpp"

namespace rosin::app {

namespace {

namespace fs = std::filesystem;
using analysis::Regime;

// ---------------------------------------------------------------- laws

void print_law(const FrictionLaw& law) {
  const auto& card = law.card();
  print("{}: {}\n  {}\n  source: {}\n  limits: {}\n", card.name, card.title, card.formula, card.source, card.limits);
  if (!card.approximation.empty()) print("  approximation: {}\n", card.approximation);
  if (!card.option.of.empty())
    print("  also: type = \"{}\", {} = \"{}\"\n", card.option.of, card.option.key, card.option.word);
  for (std::size_t i = 0; i < law.parameters().size(); ++i) {
    const auto& p = law.parameters()[i];
    const auto value = std::visit([](const auto& v) { return fmt::format("{}", v); }, law.values()[i]);
    print("  {:<12} {:<22} {} … {}  {}\n", p.name, column_header(value, p.unit), p.range.low, p.range.high, p.meaning);
  }
  for (const auto& s : law.states()) print("  state {:<6} {}  {}\n", s.name, readable_unit(s.unit), s.meaning);
  for (const auto& p : law.presets()) print("  preset \"{}\": {}\n", p.name, p.source);
  print("\n");
}

Status list_laws(const Request& request) {
  std::vector<std::shared_ptr<const FrictionLaw>> laws = laws::catalogue();
  if (!request.target.empty()) laws = {laws::find_law(request.target)};
  if (request.json)
    write_output(to_json(laws));
  else
    for (const auto& law : laws) print_law(*law);
  return done;
}

// ---------------------------------------------------------------- curve, stability

Status curve(Job& job) {
  const auto& scene = job.scene();
  const auto& options = scene.curve;
  const auto& law = *scene.model.law;
  job.explain("steady curve of '{}' at {} slip rates from {} to {} m/s under {} N; no states, no integration",
              law.card().name, options.points, options.from, options.to, options.normal_load);
  Curve curve;
  curve.slip_rate.resize(static_cast<std::size_t>(options.points));
  curve.friction_coefficient.resize(curve.slip_rate.size());
  for (int i = 0; i < options.points; ++i)
    curve.slip_rate[static_cast<std::size_t>(i)] =
        options.from * std::pow(options.to / options.from, double(i) / (options.points - 1));
  curve.slip_rate.back() = options.to;
  law.steady_friction(curve.slip_rate, options.normal_load, curve.friction_coefficient);
  curve.extrema = analysis::steady_extrema(law, options.from, options.to, options.normal_load);

  Reached reached;
  for (const auto& e : curve.extrema) {
    reached.add(e.slip_rate, e.slip_rate_error);
    job.say("{} at {}, friction coefficient {:.10g}", e.maximum ? "maximum" : "minimum",
            justified(e.slip_rate, e.slip_rate_error, "m/s"), e.friction_coefficient);
  }
  if (curve.extrema.empty()) job.say("no extrema between {} and {} m/s", options.from, options.to);
  job.manifest().tolerance_reached = reached.value();
  write_csv(job.folder() / "curve.csv",
            {{"slip_rate (m/s)", curve.slip_rate}, {"friction_coefficient", curve.friction_coefficient}});
  auto files = write_picture(job.folder(), scene, curve);
  files.push_back("curve.csv");
  return job.finish(to_json(scene, curve), std::move(files), {});
}

Status stability(Job& job) {
  const auto& scene = job.scene();
  const auto& model = scene.model;
  std::vector<std::string> paths = {"drive.normal_load", "oscillator.stiffness", "drive.speed"};
  if (model.law->has_states()) paths.push_back("law.lambda");
  for (const auto& path : scene.hopf_parameters)
    if (std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
  job.explain_model();
  job.explain("eigenvalues of the linearised slider; Hopf points in {}; no integration", fmt::join(paths, ", "));
  if (!model.drive.constant()) job.note("the drive varies: stability is that of its mean, or of its start");

  StabilityResult result;
  result.stability = analysis::stability(model);
  const auto& steady = result.stability.steady;
  job.say("steady sliding at {} m/s: friction coefficient {:.10g}, force {:.10g} N", steady.slip_rate,
          steady.friction_coefficient, steady.friction_force);
  job.say("{}", result.stability.marginal ? "marginal: small disturbances neither grow nor decay"
                : result.stability.stable ? "stable"
                                          : "unstable");
  for (const auto& z : result.stability.eigenvalues) job.say("  eigenvalue {:.8g} {:+.8g} i 1/s", z.real(), z.imag());
  Reached reached;
  for (const auto& path : paths) {
    const auto points = analysis::hopf_points(model, path);
    for (const auto& point : points) {
      reached.add(point.value, point.value_error);
      job.say("Hopf point at {} = {}, {:.8g} rad/s, {}", path,
              justified(point.value, point.value_error, model.describe(path).unit), point.angular_frequency,
              name(point.criticality));
    }
    if (points.empty()) job.say("no Hopf point in {}", path);
    result.hopf.insert(result.hopf.end(), points.begin(), points.end());
  }
  job.manifest().tolerance_reached = reached.value();
  return job.finish(to_json(scene, result), {}, {});
}

// ---------------------------------------------------------------- run, cycle

Status run(Job& job) {
  auto& scene = job.scene();
  scene.run.tolerance = job.request().tolerance.value_or(scene.run.tolerance);
  job.explain_model();
  job.explain("solver: {}; tolerance {}; every column comes with its error", scene.run.solver, scene.run.tolerance);
  const auto begin = std::chrono::steady_clock::now();
  auto run = [&] {
    Progress progress(job.request().quiet);
    auto how = scene.run;
    if (progress.visible()) how.progress = [&](double part) { progress.show_pass(part); };
    return scene.plane ? analysis::run_plane(*scene.plane, how) : analysis::run(scene.model, how);
  }();
  run.outcome = why_stopped(run.outcome);
  job.explain("solver used: {}, {} steps; {}", run.solver, run.cost.steps, run.why);
  if (!run.remark.empty()) job.note(run.remark);

  std::vector<Column> table{{"time (s)", run.time}};
  Reached reached;
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    table.push_back({column_header(run.column_names[c], run.column_units[c]), run.columns[c]});
    double largest = 0;
    for (const double value : run.columns[c]) largest = std::max(largest, std::abs(value));
    if (c < run.column_error.size()) reached.add(largest, run.column_error[c]);
  }
  auto& manifest = job.manifest();
  manifest.tolerance_asked = scene.run.tolerance;
  manifest.tolerance_reached = reached.value();
  manifest.cost = {{"seconds", seconds_since(begin)},
                   {"steps", double(run.cost.steps)},
                   {"evaluations", double(run.cost.evaluations)}};
  job.say("{} samples over {:.6g} s, {} events, solver {}", run.time.size(), run.time.empty() ? 0 : run.time.back(),
          run.events.size(), run.solver);
  for (std::size_t c = 0; c < run.columns.size(); ++c)
    if (!run.columns[c].empty())
      job.say(
          "  {:<22} ends at {}", run.column_names[c],
          justified(run.columns[c].back(), c < run.column_error.size() ? run.column_error[c] : 0, run.column_units[c]));
  write_csv(job.folder() / "run.csv", table);
  std::vector<std::string> files = {"run.csv"};
  if (run.time.size() < 2) return job.finish(to_json(scene, run), std::move(files), run.outcome);
  for (auto& file : write_picture(job.folder(), scene, run)) files.push_back(std::move(file));
  return job.finish(to_json(scene, run), std::move(files), run.outcome);
}

Status cycle(Job& job) {
  auto& scene = job.scene();
  scene.cycle.tolerance = job.request().tolerance.value_or(scene.cycle.tolerance);
  job.explain_model();
  job.explain("the cycle that is reached from stick, tolerance {} of every metric, at most {} cycles of transient",
              scene.cycle.tolerance, scene.cycle.max_cycles);
  const auto begin = std::chrono::steady_clock::now();
  const auto cycle = analysis::find_cycle(scene.model, scene.cycle);
  auto& manifest = job.manifest();
  manifest.tolerance_asked = scene.cycle.tolerance;
  manifest.cost = {{"seconds", seconds_since(begin)},
                   {"steps", double(cycle.cost.steps)},
                   {"evaluations", double(cycle.cost.evaluations)},
                   {"cycles", double(cycle.cost.cycles)}};
  if (!(cycle.metrics.period > 0)) return job.finish(to_json(scene, cycle), {}, cycle.outcome);

  Reached reached;
  for (const auto& metric : analysis::metric_names()) {
    const double value = cycle.metrics.*metric.member, error = cycle.error.*metric.member;
    reached.add(value, error);
    job.say("{:<22} {}", metric.name, justified(value, error, metric.unit));
  }
  manifest.tolerance_reached = reached.value();
  if (cycle.ill_conditioned_stick)
    job.note("the lowest speed touches the stick threshold: the stick fraction jumps nearby");
  if (cycle.growth)
    job.say("free swing, as the start made it: friction changes its amplitude by {:.1e} of itself in a period",
            *cycle.growth);
  if (!cycle.multipliers.empty())
    job.say("{}: largest multiplier {}", cycle.stable ? "stable" : "unstable",
            justified(std::abs(cycle.multipliers.front()), cycle.multiplier_errors.front(), "1"));
  if (!cycle.multipliers_left_out.empty()) job.note(cycle.multipliers_left_out);

  const auto states = scene.model.law->states().size();
  std::vector<std::vector<double>> columns(4 + states);
  for (const auto& point : cycle.orbit) {
    const double numbers[] = {point.time, point.displacement, point.slip_rate, point.friction_coefficient};
    for (std::size_t c = 0; c < 4; ++c) columns[c].push_back(numbers[c]);
    for (std::size_t s = 0; s < states; ++s)
      columns[4 + s].push_back(s < point.state.size() ? point.state[s] : std::nan(""));
  }
  std::vector<Column> table = {{"time (s)", columns[0]},
                               {"displacement (m)", columns[1]},
                               {"slip_rate (m/s)", columns[2]},
                               {"friction_coefficient", columns[3]}};
  for (std::size_t s = 0; s < states; ++s) {
    const auto& state = scene.model.law->states()[s];
    table.push_back({column_header(state.name, state.unit), columns[4 + s]});
  }
  write_csv(job.folder() / "cycle.csv", table);
  auto files = write_picture(job.folder(), scene, cycle);
  files.push_back("cycle.csv");
  return job.finish(to_json(scene, cycle), std::move(files), cycle.outcome);
}

// ---------------------------------------------------------------- map

/// Everything that determines a map: two runs with the same key have the same points.
std::string map_key(const Scene& scene) {
  std::string key = fmt::format("rosin {}\ntolerance {}\n{}\n", ROSIN_VERSION, scene.map.tolerance,
                                scene.map.exact ? "exact" : "adaptive");
  for (const auto& quantity : scene.model.parameters())
    key += fmt::format("{} = {}\n", quantity.name, scene.model.get(quantity.name));
  return key + scene.resolved;
}

Status map(Job& job) {
  const auto& request = job.request();
  auto& scene = job.scene();
  auto& options = scene.map;
  options.tolerance = request.tolerance.value_or(options.tolerance);
  options.threads = request.threads;
  options.exact = request.exact;
  const auto nx = options.x.values.size(), ny = options.y.values.size(), total = nx * ny;
  job.explain_model();
  job.explain("{} x {} points of {} and {}, tolerance {} of {}", nx, ny, options.x.parameter, options.y.parameter,
              options.tolerance, fmt::join(options.metrics, ", "));
  job.explain("where steady sliding is stable and no cycle can exist beside it, nothing is integrated");
  job.explain("{}", analysis::interpolates(options)
                        ? "points are computed where they are needed, and the others interpolated to the tolerance"
                    : options.exact ? "every point is computed, as asked"
                                    : "every point is computed: interpolation would gain nothing here");

  Partial partial(job.folder() / "map.partial", map_key(scene), total, options.metrics);
  if (!partial.lost().empty()) job.note(partial.lost());
  if (const auto known = partial.known_count()) job.note(fmt::format("going on from {} finished points", known));
  const auto begin = std::chrono::steady_clock::now();
  MapResult result;
  {
    Progress progress(request.quiet);
    result.map = analysis::compute_map(
        scene.model, options,
        {.known = [&](std::size_t i) { return partial.known(i); },
         .finished = [&](std::span<const std::size_t> indices,
                         const std::vector<analysis::MapPoint>& points) { partial.append(indices, points); },
         .progress = progress.of_map()});
  }
  auto& map = result.map;
  result.seconds = seconds_since(begin);
  if (map.outcome.ending == Ending::interrupted)
    return stopped_early(request, fmt::format("{} of {} points are kept; the same command goes on from there",
                                              std::ranges::count_if(map.points, &analysis::MapPoint::done), total));
  for (const auto& text : map.notes) job.explain("{}", text);
  job.explain("{} points integrated, {} interpolated, {} decided without integration", map.integrated, map.interpolated,
              map.skipped);

  std::array<std::size_t, 4> regimes{};
  for (const auto& point : map.points) ++regimes[static_cast<std::size_t>(point.regime)];
  auto& manifest = job.manifest();
  manifest.tolerance_asked = options.tolerance;
  manifest.cost = {{"seconds", result.seconds},
                   {"points", double(total)},
                   {"integrated", double(map.integrated)},
                   {"interpolated", double(map.interpolated)},
                   {"skipped", double(map.skipped)},
                   {"threads", double(options.threads)}};
  const auto between = map.interpolated > 0 ? fmt::format("{} interpolated, ", map.interpolated) : std::string();
  job.say("{} x {} points in {:.3g} s: {} integrated, {}{} decided without", nx, ny, result.seconds, map.integrated,
          between, map.skipped);
  for (const Regime regime : {Regime::stable, Regime::cycle, Regime::bistable, Regime::failed})
    if (const auto count = regimes[static_cast<std::size_t>(regime)]) job.say("  {:<9} {}", name(regime), count);
  for (const auto& wanted : options.metrics) {
    const auto& metric = analysis::find_metric(wanted);
    const bool fraction = analysis::is_stick(metric);
    std::vector<double> errors;
    for (const auto& point : map.points) {
      const double value = fraction ? 1 : std::abs(point.metrics.*metric.member), error = point.error.*metric.member;
      if (std::isfinite(error) && value > 0) errors.push_back(error / value);
    }
    if (errors.empty()) continue;
    std::ranges::sort(errors);
    manifest.tolerance_reached = std::max(manifest.tolerance_reached, errors.back());
    job.say("  {:<22} {} at most {:.1e}, at nine points in ten at most {:.1e}", wanted,
            fraction ? "error" : "relative error", errors.back(), errors[errors.size() * 9 / 10]);
  }

  write_plane(job.folder() / "map.nc", scene, map);
  auto files = write_picture(job.folder(), scene, map);
  files.push_back("map.nc");
  const auto status = job.finish(to_json(scene, result), std::move(files), map.outcome);
  partial.remove();
  return status;
}

// ---------------------------------------------------------------- lab

Status lab(Job& job) {
  auto& scene = job.scene();
  auto& task = *scene.lab;
  task.tolerance = job.request().tolerance.value_or(task.tolerance);
  job.explain_model();
  const auto begin = std::chrono::steady_clock::now();
  auto result = scene.experiment->perform(task);
  result.outcome = why_stopped(result.outcome);
  for (const auto& line : result.plan) job.explain("{}", line);
  for (const auto& warning : result.warnings) job.note(warning);

  Reached reached;
  for (const auto& reading : result.readings) {
    reached.add(reading.value, reading.error);
    job.say("{:<24} {}", reading.name, justified(reading.value, reading.error, reading.unit));
  }
  auto& manifest = job.manifest();
  manifest.tolerance_asked = task.tolerance;
  manifest.tolerance_reached = reached.value();
  manifest.cost = {{"seconds", seconds_since(begin)}, {"samples", double(result.record.time.size())}};
  std::vector<Column> table{{"time (s)", result.record.time}};
  for (std::size_t c = 0; c < result.record.columns.size(); ++c)
    table.push_back({column_header(result.record.names[c], result.record.units[c]), result.record.columns[c]});
  write_csv(job.folder() / "lab.csv", table);
  std::vector<std::string> files = {"lab.csv"};
  for (const auto& rows : result.tables) {
    std::vector<Column> columns;
    for (std::size_t c = 0; c < rows.columns.size(); ++c)
      columns.push_back({column_header(rows.columns[c], rows.units[c]), rows.values[c]});
    files.push_back(fmt::format("lab-{}.csv", rows.name));
    write_csv(job.folder() / files.back(), columns);
  }
  if (!result.panels.empty()) {
    const auto written = write_picture(job.folder(), scene, result.panels);
    files.insert(files.end(), written.begin(), written.end());
  }
  return job.finish(to_json(scene, result), std::move(files), result.outcome);
}

// ---------------------------------------------------------------- bench, plot

Status bench(const Request& request) {
  const bool sound = ::bench::run({.what = request.target,
                                   .quick = request.quick,
                                   .json = request.json,
                                   .quiet = request.quiet,
                                   .folder = request.out.empty() ? "out/bench-" + request.target : request.out,
                                   .limit = request.limit,
                                   .python = request.python});
  return sound ? done : ended_short;
}

Status plot(const Request& request) {
  const fs::path path = request.target;
  if (!fs::exists(path)) throw InputError(fmt::format("{}: no such file or folder", path.string()));
  const fs::path folder = fs::is_directory(path) ? path : results_folder(request);
  if (!fs::exists(folder / "result.json"))
    throw InputError(fmt::format("{}: holds no results; compute them first, such as with 'rosin map {}'",
                                 (folder / "").string(), path.string()));
  const auto scripts = scripts_of(folder);
  auto drawn = draw(folder, scripts.ours);
  for (const auto& script : scripts.foreign)  // a script may run any program
    drawn.problems.push_back(
        fmt::format("{} is not as rosin wrote it, and is left alone; if you trust it, draw it by 'gnuplot {}' in {}",
                    (folder / script).string(), script, (folder / "").string()));
  if (drawn.files.empty() && drawn.problems.empty())
    drawn.problems.push_back(fmt::format("{} holds no pictures", (folder / "").string()));
  if (!request.quiet) {
    for (const auto& problem : drawn.problems) tell("note: {}\n", problem);
    for (const auto& file : drawn.files) print("{}\n", (folder / file).string());
  }
  return drawn.problems.empty() ? done : ended_short;
}

/// Verbs that read a scene, and what they ask of it.
struct SceneVerb {
  const char* name;
  Verb reads;
  Status (*perform)(Job&);
};
constexpr SceneVerb scene_verbs[] = {
    {"curve", Verb::curve, curve}, {"stability", Verb::stability, stability},
    {"run", Verb::run, run},       {"cycle", Verb::cycle, cycle},
    {"map", Verb::map, map},       {"compare", Verb::compare, compare},
    {"frf", Verb::frf, frf},       {"fit", Verb::fit, fit},
    {"lab", Verb::lab, lab},       {"study", Verb::study, study},
};

}  // namespace

Verb scene_verb(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& verb : scene_verbs) {
    if (name == verb.name) return verb.reads;
    known.emplace_back(verb.name);
  }
  const auto near = nearest_name(name, known);
  throw InputError(fmt::format(
      "'{}' is no verb that reads a scene; {}", name,
      near.empty() ? fmt::format("those are {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", near)));
}

Status execute(const Request& request) {
  for (const auto& verb : scene_verbs) {
    if (request.verb != verb.name) continue;
    Job job(request, request.design ? Verb::design : verb.reads);
    try {
      return verb.perform(job);
    } catch (const InputError& error) {  // what the scene asks turned out to be none
      throw InputError(job.scene().placed(error.what()));
    }
  }
  if (request.verb == "laws") return list_laws(request);
  if (request.verb == "stress") return stress(request);
  if (request.verb == "verify") return verify::verify(request);
  if (request.verb == "bench") return bench(request);
  return plot(request);
}

}  // namespace rosin::app
