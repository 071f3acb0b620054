/// Protocols of a comparison, and the report of a design.
#include "app/compare.hpp"

#include <fmt/ranges.h>

#include "analysis/curve.hpp"
#include "analysis/stability.hpp"
#include "app/files.hpp"
#include "app/job.hpp"
#include "app/pictures.hpp"
#include "app/progress.hpp"
#include "app/stopping.hpp"

namespace rosin::app {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

using Members = std::vector<CompareOptions::Member>;

/// The entries of one member, in rows that the first member to have a metric begins.
class Entries {
 public:
  Entries(Comparison& comparison, std::size_t member, std::size_t members)
      : comparison_(comparison), member_(member), members_(members) {}
  void add(const std::string& metric, const std::string& unit, double value, double error) {
    auto row = std::ranges::find(comparison_.rows, metric, &Comparison::Row::metric);
    if (row == comparison_.rows.end())
      row =
          comparison_.rows.insert(row, {metric, unit, std::vector(members_, nothing), std::vector(members_, nothing)});
    row->values[member_] = value;
    row->errors[member_] = error;
  }

 private:
  Comparison& comparison_;
  std::size_t member_, members_;
};

void worsen(Outcome& outcome, const Outcome& other, const std::string& member) {
  if (outcome.complete() && !other.complete())
    outcome = {other.ending, fmt::format("member '{}': {}", member, other.detail)};
}

/// Steady curves, and friction and its slope at the drive's speed.
Comparison compare_curves(const Scene& scene) {
  const auto& members = scene.compare.members;
  const auto& options = scene.curve;
  Comparison comparison;
  comparison.x_name = "slip_rate", comparison.x_unit = "m/s";
  comparison.column_names = {"friction_coefficient"}, comparison.column_units = {"1"};
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto& model = members[k].model;
    Comparison::Series series{{}, {{}}};
    for (int i = 0; i < options.points; ++i)
      series.x.push_back(options.from * std::pow(options.to / options.from, double(i) / (options.points - 1)));
    series.columns[0].resize(series.x.size());
    model.law->steady_friction(series.x, options.normal_load, series.columns[0]);
    const double V = model.drive.speed.level();
    const auto steady = model.law->steady_friction({V, options.normal_load});
    Entries entries(comparison, k, members.size());
    entries.add("steady_friction", "1", steady.friction, 4e-16 * std::abs(steady.friction));
    entries.add("steady_slope", "1", V * steady.slope, 4e-16 * std::abs(V * steady.slope));
    comparison.series.push_back(std::move(series));
  }
  return comparison;
}

Comparison compare_stability(const Scene& scene) {
  const auto& members = scene.compare.members;
  Comparison comparison;
  for (std::size_t k = 0; k < members.size(); ++k) {
    Entries entries(comparison, k, members.size());
    for (const char* path : {"drive.normal_load", "oscillator.stiffness", "drive.speed"}) {
      const auto points = analysis::hopf_points(members[k].model, path);
      if (points.empty()) continue;
      const auto& nearest = points.front();
      entries.add(fmt::format("hopf {}", path), scene.model.describe(path).unit, nearest.value, nearest.value_error);
      entries.add(fmt::format("hopf {} angular_frequency", path), "rad/s", nearest.angular_frequency,
                  1e-12 * nearest.angular_frequency);
    }
  }
  return comparison;
}

/// Motions over time, by the columns that all members have: not their states.
Comparison motions() {
  Comparison comparison;
  comparison.x_name = "time", comparison.x_unit = "s";
  comparison.column_names = {"displacement", "slip_rate", "friction_coefficient"};
  comparison.column_units = {"m", "m/s", "1"};
  return comparison;
}

Comparison compare_runs(const Scene& scene) {
  const auto& members = scene.compare.members;
  Comparison comparison = motions();
  constexpr std::size_t chosen[] = {0, 2, 4};
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto run = analysis::run(members[k].model, scene.run);
    worsen(comparison.outcome, run.outcome, members[k].name);
    Comparison::Series series{run.time, {}};
    Entries entries(comparison, k, members.size());
    for (std::size_t c = 0; c < std::size(chosen); ++c) {
      const auto& column = run.columns[chosen[c]];
      series.columns.push_back(column);
      if (column.empty()) continue;
      const double error = chosen[c] < run.column_error.size() ? run.column_error[chosen[c]] : nothing;
      const auto &name = comparison.column_names[c], &unit = comparison.column_units[c];
      entries.add(name + " at the end", unit, column.back(), error);
      entries.add("largest " + name, unit, *std::ranges::max_element(column), error);
    }
    comparison.series.push_back(std::move(series));
  }
  return comparison;
}

Comparison compare_cycles(const Scene& scene) {
  const auto& members = scene.compare.members;
  Comparison comparison = motions();
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto cycle = analysis::find_cycle(members[k].model, scene.cycle);
    worsen(comparison.outcome, cycle.outcome, members[k].name);
    Entries entries(comparison, k, members.size());
    if (cycle.metrics.period > 0)
      for (const auto& metric : analysis::metric_names())
        entries.add(std::string(metric.name), std::string(metric.unit), cycle.metrics.*metric.member,
                    cycle.error.*metric.member);
    Comparison::Series series{{}, {{}, {}, {}}};
    for (const auto& point : cycle.orbit) {
      series.x.push_back(point.time);
      series.columns[0].push_back(point.displacement);
      series.columns[1].push_back(point.slip_rate);
      series.columns[2].push_back(point.friction_coefficient);
    }
    comparison.series.push_back(std::move(series));
  }
  return comparison;
}

Comparison compare_maps(const Scene& scene, const Request& request) {
  const auto& members = scene.compare.members;
  auto options = scene.map;
  options.threads = request.threads;
  Comparison comparison;
  Progress progress(request.quiet);
  for (std::size_t k = 0; k < members.size(); ++k) {
    comparison.maps.push_back(
        analysis::compute_map(members[k].model, options, {.known = {}, .finished = {}, .progress = progress.of_map()}));
    worsen(comparison.outcome, comparison.maps.back().outcome, members[k].name);
    if (comparison.outcome.ending == Ending::interrupted) return comparison;
  }
  // Of each metric the largest difference to the first member, where both have a cycle.
  for (const auto& name : options.metrics) {
    const auto& metric = analysis::find_metric(name);
    for (std::size_t k = 0; k < members.size(); ++k) {
      double largest = 0, its_error = 0;
      for (std::size_t i = 0; i < comparison.maps[0].points.size(); ++i) {
        const auto &one = comparison.maps[0].points[i], &other = comparison.maps[k].points[i];
        const double difference = std::abs(other.metrics.*metric.member - one.metrics.*metric.member);
        if (!(difference > largest)) continue;
        largest = difference;
        its_error = one.error.*metric.member + other.error.*metric.member;
      }
      Entries(comparison, k, members.size())
          .add("largest difference of " + name, std::string(metric.unit), largest, its_error);
    }
  }
  return comparison;
}

void say_members(const Job& job, const CompareOptions& compare) {
  for (const auto& member : compare.members) {
    std::string adjusted;
    for (std::size_t k = 0; k < member.adjusted.size(); ++k)
      adjusted +=
          fmt::format("{}{} = {:.10g}", k == 0 ? "; made equal by " : ", ", compare.adjust[k], member.adjusted[k]);
    if (!member.adjusted.empty()) adjusted += fmt::format(", leaving {:.1g} (relative)", member.difference);
    job.say("{}: law '{}'{}", member.name, member.model.law->card().name, adjusted);
  }
}

/// Stick is creep below the threshold under smooth laws and exact rest under set-valued ones. Where members are of both
/// kinds stick_fraction would compare the two, slow_fraction is the same for all.
bool of_both_kinds(const Members& members) {
  const auto set_valued = [](const auto& member) { return member.model.law->set_valued(); };
  return std::ranges::any_of(members, set_valued) && !std::ranges::all_of(members, set_valued);
}
constexpr std::string_view two_kinds =
    "stick_fraction is exact rest under set-valued laws, and slip below the threshold under smooth ones";
void say_too(Job& job, std::string text) {
  job.note(text);
  job.scene().notes.push_back(std::move(text));
}
/// Takes the slow fraction for the stick fraction among the metrics named, and says so.
void take_slow_fraction(Job& job, const std::vector<std::string*>& metrics) {
  const auto named = [&](std::string_view name) {
    return std::ranges::find_if(metrics, [&](const auto* metric) { return *metric == name; });
  };
  const auto stick = named("stick_fraction");
  if (stick == metrics.end() || named("slow_fraction") != metrics.end() || !of_both_kinds(job.scene().compare.members))
    return;
  **stick = "slow_fraction";
  say_too(job, fmt::format("{}: members of both kinds are compared by slow_fraction, slip below the threshold under "
                           "every law",
                           two_kinds));
}

Status side_by_side(Job& job) {
  const auto& request = job.request();
  auto& scene = job.scene();
  const auto& protocol = scene.compare.protocol;
  if (request.tolerance) scene.run.tolerance = scene.cycle.tolerance = scene.map.tolerance = *request.tolerance;
  if (protocol == "cycle" && of_both_kinds(scene.compare.members))
    say_too(job, fmt::format("{}: compare slow_fraction, slip below the threshold under every law", two_kinds));
  if (protocol == "map") {
    std::vector<std::string*> metrics;
    for (auto& metric : scene.map.metrics) metrics.push_back(&metric);
    take_slow_fraction(job, metrics);
  }
  job.explain("{} members under protocol '{}'", scene.compare.members.size(), protocol);
  const auto begin = std::chrono::steady_clock::now();
  const Comparison comparison = protocol == "curve"       ? compare_curves(scene)
                                : protocol == "stability" ? compare_stability(scene)
                                : protocol == "run"       ? compare_runs(scene)
                                : protocol == "map"       ? compare_maps(scene, request)
                                                          : compare_cycles(scene);
  if (comparison.outcome.ending == Ending::interrupted) return stopped_early(request, "nothing is written");
  say_members(job, scene.compare);
  Reached reached;
  std::string header(34, ' ');
  for (const auto& member : scene.compare.members) header += fmt::format("  {:>28}", member.name);
  job.say("{}", header);
  for (const auto& row : comparison.rows) {
    std::string line = fmt::format("{:<34}", row.metric);
    for (std::size_t k = 0; k < row.values.size(); ++k) {
      line += fmt::format("  {:>28}", justified(row.values[k], row.errors[k], row.unit));
      reached.add(row.values[k], row.errors[k]);
    }
    job.say("{}", line);
  }
  auto& manifest = job.manifest();
  manifest.tolerance_reached = reached.value();
  manifest.cost = {{"seconds", seconds_since(begin)}};
  std::vector<std::string> files;
  if (!comparison.series.empty()) files = write_picture(job.folder(), scene, comparison);
  return job.finish(to_json(scene, comparison), files, comparison.outcome);
}

Status design(Job& job) {
  const auto& request = job.request();
  auto& scene = job.scene();
  auto& compare = scene.compare;
  std::vector<std::string*> metrics;
  for (auto& noise : compare.noise) metrics.push_back(&noise.metric);
  take_slow_fraction(job, metrics);
  analysis::DesignOptions options{.x = scene.map.x,
                                  .y = scene.map.y,
                                  .noise = compare.noise,
                                  .tolerance = request.tolerance.value_or(scene.map.tolerance),
                                  .stick_threshold = scene.map.stick_threshold,
                                  .threads = request.threads,
                                  .confidence = compare.confidence};
  std::vector<std::string> measured;
  for (const auto& noise : compare.noise) measured.push_back(noise.metric);
  const bool of_parameter = !compare.parameter.empty();
  job.explain("{} over {} and {}, measuring {}; every point is computed",
              of_parameter ? "information on " + compare.parameter : std::string("likelihood ratio between members"),
              options.x.parameter, options.y.parameter, fmt::join(measured, ", "));
  const auto begin = std::chrono::steady_clock::now();
  DesignResult result;
  {
    Progress progress(request.quiet);
    const analysis::MapHooks hooks{.known = {}, .finished = {}, .progress = progress.of_map()};
    std::vector<oscillators::Model> models;
    for (const auto& member : compare.members) models.push_back(member.model);
    result.design = of_parameter ? analysis::inform(scene.model, compare.parameter, options, hooks)
                                 : analysis::discriminate(models, options, hooks);
  }
  result.seconds = seconds_since(begin);
  const auto& plane = result.design;
  if (plane.outcome.ending == Ending::interrupted) return stopped_early(request, "nothing is written");
  if (!of_parameter) say_members(job, compare);
  const auto say_best = [&](const std::string& what, const analysis::Design::Best& best) {
    if (!(best.information > 0)) return job.say("{:<22} tells nothing anywhere", what);
    const auto place = fmt::format("at {} = {:.4g}, {} = {:.4g}", plane.x.parameter, best.x, plane.y.parameter, best.y);
    if (of_parameter)
      job.say("{:<22} best {}: standard error of ln({}) from one measurement {:.3g}", what, place, compare.parameter,
              1 / std::sqrt(best.information));
    else
      job.say("{:<22} best {}: log-likelihood ratio {:.4g} a measurement, {} for {:.4g} %", what, place,
              best.information, best.repeats == 1 ? std::string("one") : fmt::format("{}", best.repeats),
              100 * compare.confidence);
  };
  say_best("all metrics together", plane.best);
  if (compare.noise.size() > 1)
    for (std::size_t m = 0; m < measured.size(); ++m) say_best(measured[m], plane.best_by_metric[m]);
  job.manifest().tolerance_asked = options.tolerance;
  job.manifest().cost = {{"seconds", result.seconds}, {"points", double(plane.information.size())}};
  return job.finish(to_json(scene, result), write_picture(job.folder(), scene, plane), plane.outcome);
}

}  // namespace

Status compare(Job& job) { return job.request().design ? design(job) : side_by_side(job); }

}  // namespace rosin::app
