/// The verb compare: members under one protocol side by side, and designs that tell them apart.

#include "app/tasks/compare.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/cycles/cycle.hpp"
#include "analysis/inference/discrimination.hpp"
#include "analysis/inference/equalise.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/planes/map.hpp"
#include "analysis/steady/curve.hpp"
#include "analysis/steady/stability.hpp"
#include "app/output/comparison.hpp"
#include "app/output/files.hpp"
#include "app/output/json.hpp"
#include "app/output/pictures.hpp"
#include "app/scene/law.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/bowing.hpp"
#include "app/tasks/curve.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

// ---------------------------------------------------------------- reading

std::vector<analysis::inference::Property> read_properties(const toml::node& node, const std::string& path) {
  std::vector<analysis::inference::Property> properties;
  for (const auto& element : scene::list(node, path, "tables")) {
    scene::Table keys(element, path);
    keys.expect({"name", "slip_rate", "ratio", "hold", "from", "to", "points"});
    std::vector<std::string> known{"steady-curve"};
    for (const auto& property : analysis::inference::property_names()) known.emplace_back(property.name);
    const auto property = scene::choice(keys.required("name", "of the property"), keys.path("name"), known);
    const Quantity speed{"", "m/s", {1e-15, 1e4}, "slip rate"};
    if (property == "steady-curve") {
      double from = 0, to = 0;
      int points = 41;
      keys.required("from", "lowest slip rate, m/s");
      keys.required("to", "highest slip rate, m/s");
      keys.read("from", from, speed);
      keys.read("to", to, speed);
      keys.read("points", points, 2, 1'000'000, "slip rates along the curve");
      if (!(from < to)) scene::fail(element.source(), "{}: from = {} must be below to = {}", path, from, to);
      const auto curve = analysis::inference::steady_curve(from, to, points);
      properties.insert(properties.end(), curve.begin(), curve.end());
    } else {
      analysis::inference::Property one{.name = property, .slip_rate = 0};
      keys.required("slip_rate", "m/s");
      keys.read("slip_rate", one.slip_rate, speed);
      keys.read("ratio", one.ratio, {"", "1", {1e-6, 1e6}, "slip rate after the step over that before it"});
      keys.read("hold", one.hold, {"", "s", {0, 1e15}, "time at rest"});
      properties.push_back(one);
    }
    keys.finish();
  }
  return properties;
}

/// The scene's model with what a member changes.
tasks::Compare::Member read_member(scene::SceneReader& reader, const toml::node& node) {
  scene::Table table(node, "compare.members");
  table.expect({"name", "law", "set"});
  tasks::Compare::Member member{
      scene::text(table.required("name", "of the member"), "compare.members.name"), reader.scene.model, {}, 0};
  if (const auto* law = table.find("law")) {
    member.model.lambda = 1;
    member.model.contact_stiffness = {};
    scene::read_law(reader, scene::Table(*law, "compare.members.law"), member.model);
  }
  if (const auto* set = table.find("set")) {
    if (!set->is_table())
      scene::wrong_kind(*set, "compare.members.set", "a table of paths, such as { \"law.lambda\" = 10 }");
    for (const auto& [key, value] : *set->as_table()) {
      const std::string path(key.str());
      scene::located(value.source(), [&] {
        auto quantity = member.model.describe(path);
        member.model = member.model.with(path, scene::number(value, quantity));
      });
    }
  }
  table.finish();
  return member;
}

void read_noise(const toml::node& node, tasks::Compare& compare) {
  if (!node.is_table()) scene::wrong_kind(node, "compare.noise", "a table of metrics");
  for (const auto& [key, value] : *node.as_table()) {
    analysis::inference::Noise noise{std::string(key.str())};
    const auto* metric = scene::located(value.source(), [&] { return &analysis::cycles::find_metric(noise.metric); });
    scene::Table keys(value, "compare.noise." + noise.metric);
    keys.read("absolute", noise.absolute, {"", std::string(metric->unit), {0, 1e300}, "standard deviation"});
    keys.read("relative", noise.relative, {"", "1", {0, 1e3}, "standard deviation over the value"});
    keys.finish();
    if (noise.absolute + noise.relative == 0)
      scene::fail(value.source(), "compare.noise.{}: give absolute ({}) or relative, above 0", noise.metric,
                  readable_unit(metric->unit));
    compare.noise.push_back(noise);
  }
}

void read_comparison(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  const bool design = reader.request.design;
  auto& compare = scene.task<tasks::Compare>();
  table.expect({"members", "protocol", "equalise", "noise", "confidence", "parameter"});
  if (const auto* protocol = table.find("protocol"))
    compare.protocol = scene::choice(*protocol, "compare.protocol", {"curve", "stability", "run", "cycle", "map"});
  if (const auto* parameter = table.find("parameter")) {
    compare.parameter = scene::text(*parameter, "compare.parameter");
    scene::located(parameter->source(), [&] { scene.model.describe(compare.parameter); });
  }
  const bool of_parameter = design && !compare.parameter.empty();
  if (const auto* members = table.find("members"))
    for (const auto& element : scene::list(*members, "compare.members", "tables", scene::most_names))
      compare.members.push_back(read_member(reader, element));
  if (!of_parameter && compare.members.size() < 2)
    scene::fail(table.source(),
                "compare.members needs two members or more, each a table with a name and what it changes");
  for (auto member = compare.members.begin(); member != compare.members.end(); ++member) {
    if (std::any_of(compare.members.begin(), member, [&](const auto& other) { return other.name == member->name; }))
      scene::fail(table.source(), "compare.members: two are named '{}'", member->name);
    scene::located(table.source(), [&] { member->model.check(); });
  }
  if (auto equal = table.table("equalise")) {
    equal->expect({"properties", "adjust"});
    const auto& properties = equal->required("properties", "what the members are to share");
    compare.adjust = scene::texts(equal->required("adjust", "paths of parameters"), equal->path("adjust"));
    const auto wanted = read_properties(properties, equal->path("properties"));
    equal->finish();
    for (std::size_t k = 1; k < compare.members.size(); ++k) {
      auto& member = compare.members[k];
      scene::located(equal->source(), [&] {
        try {
          const auto equalised =
              analysis::inference::equalise(member.model, compare.members.front().model, wanted, compare.adjust);
          member.model = equalised.model;
          member.adjusted = equalised.values;
          member.difference = equalised.difference;
        } catch (const InputError& error) {
          throw InputError(fmt::format("compare.equalise, member '{}': {}", member.name, error.what()));
        }
      });
    }
  }
  if (const auto* noise = table.find("noise")) read_noise(*noise, compare);
  table.read("confidence", compare.confidence, {"", "1", {0.5, 0.999999}, "probability of the right decision"});
  table.finish();
  if (design && compare.noise.empty())
    scene::fail(table.source(), "compare.noise is needed for a design: the noise of each metric that is measured");
  if (!design)
    reader.note_unread({"compare.noise", "compare.confidence", "compare.parameter"},
                       "only 'rosin compare --design' asks for it");
}

void read(scene::SceneReader& reader) {
  reader.law();
  reader.oscillator();
  const bool design = reader.request.design;
  const auto* given = reader.document.at_path("compare.protocol").as_string();
  const auto protocol = given && !design ? given->get() : std::string();
  if (reader.scene.string) {
    read_string_map(reader, scene::Table(reader.need("map", "the two axes"), "map"));
    return read_string_comparison(reader, scene::Table(reader.need("compare", "members"), "compare"));
  }
  if (protocol == "run") reader.need("run", "duration and start");
  if (protocol == "map" || design) reader.need("map", "the two axes and the metrics");
  read_tables_of_models(reader);
  if ((protocol == "map" || design) && reader.scene.task<analysis::planes::MapOptions>().y.values.empty())
    scene::Table(*reader.root.find("map"), "map")
        .required("y", "second axis of the plane in which members are compared");
  read_comparison(scene::Table(reader.need("compare", "members, and what is made equal in them"), "compare"), reader);
}

// ---------------------------------------------------------------- documents

/// Members of a comparison: names, laws, and what was adjusted in them.
ordered_json members(const tasks::Compare& compare) {
  auto list = ordered_json::array();
  for (const auto& member : compare.members) {
    ordered_json one{{"name", member.name},
                     {"law", member.model.law->card().name},
                     {"parameters", output::values(member.model.law->parameters(), member.model.law->values())}};
    if (member.model.law->has_states()) one["lambda"] = member.model.lambda;
    if (!member.adjusted.empty()) {
      for (std::size_t k = 0; k < compare.adjust.size(); ++k) one["adjusted"][compare.adjust[k]] = member.adjusted[k];
      one["difference_left"] = member.difference;
    }
    list.push_back(std::move(one));
  }
  return list;
}

std::string document_of(const scene::Scene& scene, const output::Comparison& comparison) {
  auto& compare = scene.task<tasks::Compare>();
  auto document = output::begin(scene, "compare", comparison.outcome);
  document["protocol"] = compare.protocol;
  document["members"] = members(compare);
  auto& differences = document["differences"] = ordered_json::object();
  for (const auto& row : comparison.rows) {
    std::vector<double> difference, error;
    for (std::size_t k = 0; k < row.values.size(); ++k) {
      difference.push_back(row.values[k] - row.values[0]);
      error.push_back(k == 0 ? 0 : row.errors[k] + row.errors[0]);
    }
    differences[row.metric] = {{"unit", row.unit},
                               {"values", row.values},
                               {"errors", row.errors},
                               {"differences", difference},
                               {"difference_errors", error}};
  }
  if (!comparison.maps.empty()) {
    const auto& first = comparison.maps.front();
    document["x"] = output::axis(first.x, scene);
    document["y"] = output::axis(first.y, scene);
    auto& planes = document["planes"] = ordered_json::object();
    for (std::size_t k = 0; k < comparison.maps.size(); ++k) {
      const auto& map = comparison.maps[k];
      auto& plane = planes[compare.members[k].name];
      plane["regime"] = output::rows(map, [](const auto& point) { return name(point.regime); });
      for (const auto& metric : scene.task<analysis::planes::MapOptions>().metrics) {
        const auto member = analysis::cycles::find_metric(metric).member;
        plane["metrics"][metric] = output::rows(map, [=](const auto& point) { return point.metrics.*member; });
        plane["error"][metric] = output::rows(map, [=](const auto& point) { return point.error.*member; });
      }
      plane["threshold"] = {{"x", map.threshold.x}, {"y", map.threshold.y}};
    }
  } else if (!comparison.series.empty()) {
    auto& series = document["series"] = ordered_json::object();
    for (std::size_t k = 0; k < comparison.series.size(); ++k) {
      auto& one = series[compare.members[k].name];
      one[comparison.x_name] = comparison.series[k].x;
      for (std::size_t c = 0; c < comparison.column_names.size(); ++c)
        one[comparison.column_names[c]] = comparison.series[k].columns[c];
    }
  }
  document["notes"] = scene.notes;
  return output::text(document);
}

struct DesignResult {
  analysis::inference::Design design;
  double seconds = 0;
};

std::string document_of(const scene::Scene& scene, const DesignResult& result) {
  auto& compare = scene.task<tasks::Compare>();
  const auto& design = result.design;
  auto document = output::begin(scene, "compare", design.outcome);
  document["members"] = members(compare);
  if (!compare.parameter.empty()) document["parameter"] = compare.parameter;
  auto& noise = document["noise"] = ordered_json::object();
  for (const auto& n : compare.noise) noise[n.metric] = {{"absolute", n.absolute}, {"relative", n.relative}};
  document["confidence"] = compare.confidence;
  document["x"] = output::axis(design.x, scene);
  document["y"] = output::axis(design.y, scene);
  const auto plane = [&](const std::vector<double>& numbers) {
    return output::grid(design, [&](std::size_t i) { return numbers[i]; });
  };
  document["discriminability"] = plane(design.information);
  document["discriminability_error"] = plane(design.information_error);
  if (!design.repeats.empty()) document["repeats"] = plane(design.repeats);
  const auto best = [&](const analysis::inference::Design::Best& b) {
    return ordered_json{{"x", b.x}, {"y", b.y}, {"discriminability", b.information}, {"repeats", b.repeats}};
  };
  document["best"] = best(design.best);
  auto& parts = document["by_metric"] = ordered_json::object();
  for (std::size_t m = 0; m < compare.noise.size(); ++m)
    parts[compare.noise[m].metric] = {{"discriminability", plane(design.by_metric[m])},
                                      {"best", best(design.best_by_metric[m])}};
  document["cost"] = {{"seconds", result.seconds}, {"failed", design.failed}};
  document["notes"] = scene.notes;
  return output::text(document);
}

// ---------------------------------------------------------------- protocols

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

using Members = std::vector<tasks::Compare::Member>;

/// The entries of one member, in rows that the first member to have a metric begins.
class Entries {
 public:
  Entries(output::Comparison& comparison, std::size_t member, std::size_t members)
      : comparison_(comparison), member_(member), members_(members) {}
  void add(const std::string& metric, const std::string& unit, double value, double error) {
    auto row = std::ranges::find(comparison_.rows, metric, &output::Comparison::Row::metric);
    if (row == comparison_.rows.end())
      row =
          comparison_.rows.insert(row, {metric, unit, std::vector(members_, nothing), std::vector(members_, nothing)});
    row->values[member_] = value;
    row->errors[member_] = error;
  }

 private:
  output::Comparison& comparison_;
  std::size_t member_, members_;
};

void worsen(Outcome& outcome, const Outcome& other, const std::string& member) {
  if (outcome.complete() && !other.complete())
    outcome = {other.ending, fmt::format("member '{}': {}", member, other.detail)};
}

/// Steady curves, and friction and its slope at the drive's speed.
output::Comparison compare_curves(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  const auto& options = scene.task<tasks::Curve>();
  output::Comparison comparison;
  comparison.x_name = "slip_rate", comparison.x_unit = "m/s";
  comparison.column_names = {"friction_coefficient"}, comparison.column_units = {"1"};
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto& model = members[k].model;
    output::Comparison::Series series{{}, {{}}};
    for (int i = 0; i < options.points; ++i)
      series.x.push_back(options.from * std::pow(options.to / options.from, double(i) / (options.points - 1)));
    series.columns[0] = analysis::steady::steady_curve(*model.law, series.x, options.normal_load);
    const double V = model.drive.speed.level();
    const auto steady = model.law->steady_friction({V, options.normal_load});
    Entries entries(comparison, k, members.size());
    entries.add("steady_friction", "1", steady.friction, 4e-16 * std::abs(steady.friction));
    entries.add("steady_slope", "1", V * steady.slope, 4e-16 * std::abs(V * steady.slope));
    comparison.series.push_back(std::move(series));
  }
  return comparison;
}

output::Comparison compare_stability(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  output::Comparison comparison;
  for (std::size_t k = 0; k < members.size(); ++k) {
    Entries entries(comparison, k, members.size());
    for (const char* path : {"drive.normal_load", "oscillator.stiffness", "drive.speed"}) {
      const auto points = analysis::steady::hopf_points(members[k].model, path);
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
output::Comparison motions() {
  output::Comparison comparison;
  comparison.x_name = "time", comparison.x_unit = "s";
  comparison.column_names = {"displacement", "slip_rate", "friction_coefficient"};
  comparison.column_units = {"m", "m/s", "1"};
  return comparison;
}

output::Comparison compare_runs(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  output::Comparison comparison = motions();
  constexpr std::size_t chosen[] = {0, 2, 4};
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto run = analysis::motion::run(members[k].model, scene.task<analysis::motion::RunOptions>());
    worsen(comparison.outcome, run.outcome, members[k].name);
    output::Comparison::Series series{run.time, {}};
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

output::Comparison compare_cycles(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  output::Comparison comparison = motions();
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto cycle = analysis::cycles::find_cycle(members[k].model, scene.task<analysis::cycles::CycleOptions>());
    worsen(comparison.outcome, cycle.outcome, members[k].name);
    Entries entries(comparison, k, members.size());
    if (cycle.metrics.period > 0)
      for (const auto& metric : analysis::cycles::metric_names())
        entries.add(std::string(metric.name), std::string(metric.unit), cycle.metrics.*metric.member,
                    cycle.error.*metric.member);
    output::Comparison::Series series{{}, {{}, {}, {}}};
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

output::Comparison compare_maps(const scene::Scene& scene, const Request& request) {
  const auto& members = scene.task<tasks::Compare>().members;
  auto options = scene.task<analysis::planes::MapOptions>();
  options.threads = request.threads;
  output::Comparison comparison;
  Progress progress(request.quiet);
  for (std::size_t k = 0; k < members.size(); ++k) {
    comparison.maps.push_back(analysis::planes::compute_map(
        members[k].model, options, {.known = {}, .finished = {}, .progress = progress.of_map()}));
    worsen(comparison.outcome, comparison.maps.back().outcome, members[k].name);
    if (comparison.outcome.ending == Ending::interrupted) return comparison;
  }
  // Of each metric the largest difference to the first member, where both have a cycle.
  for (const auto& name : options.metrics) {
    const auto& metric = analysis::cycles::find_metric(name);
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

void say_members(const Job& job, const tasks::Compare& compare) {
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
  if (stick == metrics.end() || named("slow_fraction") != metrics.end() ||
      !of_both_kinds(job.scene().task<tasks::Compare>().members))
    return;
  **stick = "slow_fraction";
  say_too(job, fmt::format("{}: members of both kinds are compared by slow_fraction, slip below the threshold under "
                           "every law",
                           two_kinds));
}

Status side_by_side(Job& job) {
  const auto& request = job.request();
  auto& scene = job.scene();
  auto& compare = scene.task<tasks::Compare>();
  const auto& protocol = compare.protocol;
  if (request.tolerance)
    scene.task<analysis::motion::RunOptions>().tolerance = scene.task<analysis::cycles::CycleOptions>().tolerance =
        scene.task<analysis::planes::MapOptions>().tolerance = *request.tolerance;
  if (protocol == "cycle" && of_both_kinds(compare.members))
    say_too(job, fmt::format("{}: compare slow_fraction, slip below the threshold under every law", two_kinds));
  if (protocol == "map") {
    std::vector<std::string*> metrics;
    for (auto& metric : scene.task<analysis::planes::MapOptions>().metrics) metrics.push_back(&metric);
    take_slow_fraction(job, metrics);
  }
  job.explain("{} members under protocol '{}'", compare.members.size(), protocol);
  const auto begin = std::chrono::steady_clock::now();
  const output::Comparison comparison = protocol == "curve"       ? compare_curves(scene)
                                        : protocol == "stability" ? compare_stability(scene)
                                        : protocol == "run"       ? compare_runs(scene)
                                        : protocol == "map"       ? compare_maps(scene, request)
                                                                  : compare_cycles(scene);
  if (comparison.outcome.ending == Ending::interrupted) return stopped_early(request, "nothing is written");
  say_members(job, compare);
  Reached reached;
  std::string header(34, ' ');
  for (const auto& member : compare.members) header += fmt::format("  {:>28}", member.name);
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
  if (!comparison.series.empty()) files = output::write_picture(job.folder(), scene, comparison);
  return job.finish(document_of(scene, comparison), files, comparison.outcome);
}

Status design(Job& job) {
  const auto& request = job.request();
  auto& scene = job.scene();
  auto& map = scene.task<analysis::planes::MapOptions>();
  auto& compare = scene.task<tasks::Compare>();
  std::vector<std::string*> metrics;
  for (auto& noise : compare.noise) metrics.push_back(&noise.metric);
  take_slow_fraction(job, metrics);
  analysis::inference::DesignOptions options{.x = map.x,
                                             .y = map.y,
                                             .noise = compare.noise,
                                             .tolerance = request.tolerance.value_or(map.tolerance),
                                             .stick_threshold = map.stick_threshold,
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
    const analysis::planes::MapHooks hooks{.known = {}, .finished = {}, .progress = progress.of_map()};
    std::vector<oscillators::Model> models;
    for (const auto& member : compare.members) models.push_back(member.model);
    result.design = of_parameter ? analysis::inference::inform(scene.model, compare.parameter, options, hooks)
                                 : analysis::inference::discriminate(models, options, hooks);
  }
  result.seconds = seconds_since(begin);
  const auto& plane = result.design;
  if (plane.outcome.ending == Ending::interrupted) return stopped_early(request, "nothing is written");
  if (!of_parameter) say_members(job, compare);
  const auto say_best = [&](const std::string& what, const analysis::inference::Design::Best& best) {
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
  return job.finish(document_of(scene, result), output::write_picture(job.folder(), scene, plane), plane.outcome);
}

Status perform(Job& job) {
  if (job.scene().string) return perform_string_comparison(job);
  return job.request().design ? design(job) : side_by_side(job);
}

}  // namespace

Verb compare_verb() {
  return {.name = "compare",
          .help = "several laws or parameter sets side by side; --design: which measurement tells them apart",
          .example = "rosin compare examples/compare-laws.toml",
          .operands = {scene_operand},
          .needs = model_tables({{"compare", "members, and what is made equal in them"},
                                 {"run", "where the protocol is a run", true},
                                 {"map", "where the protocol is a map, and for a design", true}}),
          .options = scene_options(
              {{"--design", &Request::design, "where, and by how many repeats, measurements tell members apart"}}),
          .read = read,
          .perform = perform};
}

}  // namespace rosin::app::verbs
