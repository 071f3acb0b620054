/// The verb branch: steady sliding and cycles along a parameter, stable or not, and the points where they change.
#include "app/tasks/branch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>

#include "analysis/branches/branches.hpp"
#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/steady/steady.hpp"
#include "app/output/pictures.hpp"
#include "app/results/writers.hpp"
#include "app/scene/family.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/start.hpp"
#include "app/scene/structure.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using analysis::branches::Branches;
using analysis::branches::Loci;
using nlohmann::ordered_json;

namespace {

/// The unit of a cycle's metric.
std::string unit_of(const scene::Scene& scene, const std::string& name) {
  const auto structure = scene.structure ? scene.structure->structure : oscillators::one_slider(scene.model);
  const auto metrics = analysis::cycles::cycle_metrics_of(structure);
  return metrics.contains(name) ? metrics.at(name).unit : "1";
}

bool has_periodic_drive(const scene::Scene& scene) {
  return scene.structure ? !scene.structure->structure.constant() : !scene.model.drive.constant();
}

/// On a surface at rest a structure sticks, or moves to and fro.
bool can_slide_steadily(const scene::Scene& scene, const scene::Family& family, const std::string& path, double from) {
  if (has_periodic_drive(scene)) return false;
  if (!scene.structure) return true;
  const auto rests = [](const auto& contact) { return !contact.frictionless() && contact.speed.level() == 0; };
  return std::ranges::none_of(family.with({{path, from}}).structure.contacts, rests);
}

/// parameter, from, to and scale.
void read_parameter(scene::Table& table, const scene::Family& family, Quantity& parameter,
                    analysis::branches::ParameterScale& range) {
  const auto& path = table.required("parameter", "path of a number, such as drive.speed");
  parameter =
      scene::located(path.source(), [&] { return family.describe(scene::text(path, table.path("parameter"))); });
  const auto meaning = parameter.name + ", " + parameter.meaning;
  table.required("from", meaning), table.required("to", meaning);
  auto& [from, to, logarithmic] = range;
  table.read("from", from, parameter), table.read("to", to, parameter);
  if (from == to) scene::fail(table.source(), "{} and {} are both {}", table.path("from"), table.path("to"), from);
  constexpr double a_decade = 10;
  logarithmic = from * to > 0 && std::max(from / to, to / from) >= a_decade;
  if (const auto* scale = table.find("scale")) {
    logarithmic = scene::choice(*scale, table.path("scale"), {"log", "linear"}) == "log";
    if (logarithmic && !(from * to > 0))
      scene::fail(scale->source(), "{} = \"log\" needs from and to on one side of 0, but they are {} and {}",
                  table.path("scale"), from, to);
  }
}

void read_locus(scene::Table table, const scene::Family& family, tasks::Branch& task) {
  auto& locus = task.locus.emplace();
  table.expect({"parameter", "from", "to", "scale", "points"});
  auto& options = locus.options;
  read_parameter(table, family, locus.parameter, options.q);
  const auto& [from, to, logarithmic] = options.q;
  const auto& name = locus.parameter.name;
  if (name == task.parameter.name)
    scene::fail(table.source(), "branch.locus.parameter and branch.parameter are the same, {}", name);
  locus.value = scene::located(table.source(), [&] { return family.value(name); });
  if ((locus.value - from) * (locus.value - to) > 0)
    scene::fail(table.source(), "branch.locus: the scene has {} = {}, which is not between from ({}) and to ({})", name,
                locus.value, from, to);
  table.read("points", options.points, 2, 10'000, "steps over the range of the second parameter");
  table.finish();
  options.p = task.options.parameter;
}

/// Where a motion that is followed starts.
tasks::Branch::Start read_start(scene::Scene& scene, const toml::node& start, const std::string& path) {
  if (scene.structure) return {.structure = scene::read_start_of_structure(start, path, scene)};
  if (analysis::branches::settles_as_structure(scene.model))
    return {.structure = scene::read_structure_start(start, path, oscillators::one_slider(scene.model))};
  return {.slider = scene::read_start(start, path, *scene.model.law)};
}

/// [cycle], as `rosin cycle` takes it.
void read_cycle(scene::Table table, scene::Scene& scene) {
  table.expect({"start", "stick_threshold"});
  table.read("stick_threshold", scene.task<analysis::cycles::CycleOptions>().stick_threshold,
             {"", "1", {1e-6, 0.999}, "stick is |v| <= threshold times V"});
  if (const auto* start = table.find("start")) {
    if (auto& starts = scene.task<tasks::Branch>().starts; !starts.empty())
      scene.notes.push_back("cycle.start has no effect: branch.start says where the motion starts");
    else
      starts.push_back(read_start(scene, *start, table.path("start")));
  }
  table.finish();
}

void read_branch_table(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  auto& task = scene.task<tasks::Branch>();
  const bool is_slider = !scene.structure;
  const auto& family = *(scene.family = std::make_shared<scene::Family>(reader, "branch", is_slider));
  table.expect({"parameter", "from", "to", "scale", "start", "values", "points", "step", "doublings", "locus"});
  auto& options = task.options;
  read_parameter(table, family, task.parameter, options.parameter);
  const auto& [from, to, logarithmic] = options.parameter;
  const bool slides =
      scene::located(table.source(), [&] { return can_slide_steadily(scene, family, task.parameter.name, from); });
  task.from_cycle = !slides;
  options.cycles = !scene.plane && !scene.block;
  if (const auto* start = table.find("start");
      !options.cycles && (task.from_cycle || (start && start->value_or(std::string()) != "steady")))
    scene::fail(start ? start->source() : table.source(),
                "cycles of an oscillator that is followed by steps are found where they attract: 'sweep' follows them "
                "along a parameter; a branch is that of steady sliding under a constant drive, start = \"steady\"");
  if (const auto* start = table.find("start"); start && start->is_table()) {
    task.from_cycle = true;
    task.starts.push_back(read_start(scene, *start, table.path("start")));
  } else if (start && start->is_array()) {
    task.from_cycle = true;
    constexpr std::size_t most_motions = 100;
    for (const auto& one : scene::list(*start, table.path("start"), "starts, one for each motion", most_motions))
      task.starts.push_back(read_start(scene, one, table.path("start")));
    if (task.starts.empty()) scene::fail(start->source(), "{} is empty", table.path("start"));
  } else if (start) {
    task.from_cycle = scene::choice(*start, table.path("start"), {"steady", "cycle"}) == "cycle";
    if (!task.from_cycle && !slides)
      scene::fail(start->source(),
                  "branch.start = \"steady\": under a drive that varies, or on a surface at rest, there is no steady "
                  "sliding; give \"cycle\"");
  }
  if (const auto* values = table.find("values")) {
    auto quantity = task.parameter;
    quantity.name = table.path("values");
    options.at = scene::numbers(*values, quantity);
    for (const double value : options.at)
      if ((value - from) * (value - to) > 0)
        scene::fail(values->source(), "branch.values: {} is not between from ({}) and to ({})", value, from, to);
  }
  table.read("points", options.most_points, 10, 100'000, "largest number of points of a branch");
  table.read("step", options.longest_step,
             {"", "1", {1e-4, 1}, "longest step along a branch, where 1 is the range or the size of a cycle"});
  table.read("doublings", options.doublings, 0, 12, "period doublings that are followed, one after another");
  if (auto locus = table.table("locus")) read_locus(*locus, family, task);
  table.finish();
}

void read_branch(scene::SceneReader& reader) {
  reader.law();
  reader.oscillator();
  auto& branch = reader.need("branch", "the parameter, from and to");
  if (reader.scene.structure) scene::read_structure_model(reader);
  read_branch_table(scene::Table(branch, "branch"), reader);
  if (auto cycle = reader.root.table("cycle")) read_cycle(*cycle, reader.scene);
}

std::string in_brackets(const std::string& label) { return label.empty() ? "" : fmt::format(" ({})", label); }

std::string drawn_metric(const Branches& found) {
  for (const auto& cycle : found.cycles)
    for (const auto& point : cycle.branch.points)
      for (const char* name : {"slip_rate_max", "slip_rate_1_max"})
        if (point.view.metrics.contains(name)) return name;
  return "slip_rate_max";
}

ordered_json loci_of(const tasks::Branch& task, const Loci& loci) {
  auto curves = ordered_json::array();
  const auto at = [](const analysis::branches::LocusPoint& point) {
    return ordered_json{{"value", point.p},
                        {"locus_value", point.q},
                        {"error", {{"value", point.p_error}, {"locus_value", point.q_error}}},
                        {"metrics", point.metrics}};
  };
  for (const auto& [kind, points, begins, ends, events] : loci.curves) {
    auto list = ordered_json::array(), special = list;
    for (const auto& point : points) list.push_back(at(point));
    for (const auto& event : events) {
      ordered_json entry{{"kind", event.kind}, {"label", tasks::label_of(event.kind)}};
      entry.update(at(event.at));
      special.push_back(std::move(entry));
    }
    const auto end = [](const std::string& why) { return why.empty() ? "at the end of the range" : why; };
    curves.push_back({{"kind", kind},
                      {"parameter", task.locus->parameter.name},
                      {"begins", end(begins)},
                      {"ends", end(ends)},
                      {"points", std::move(list)},
                      {"events", std::move(special)}});
  }
  return curves;
}

results::Result result_of(const Job& job, const Branches& found, const Loci& loci) {
  const auto& task = job.scene().task<tasks::Branch>();
  auto result = job.result(found.outcome);
  result["parameter"] = task.parameter.name;
  result["unit"] = task.parameter.unit;
  auto points = ordered_json::array(), events = points, branches = points;
  for (const auto& at : found.steady) {
    ordered_json point{{"value", at.value}, {"kind", "equilibrium"}, {"asked", false}};
    if (!at.why.empty()) {
      point["why"] = at.why;
    } else {
      point["stable"] = at.stable;
      point["metrics"] = {{"growth_rate", at.eigenvalues.front().real()},
                          {"angular_frequency", std::abs(at.eigenvalues.front().imag())}};
      point["slip_rates"] = at.slip_rates;
      point["eigenvalues"] = results::pairs(at.eigenvalues);
    }
    points.push_back(std::move(point));
  }
  for (std::size_t k = 0; k < found.crossings.size(); ++k) {
    const auto& crossing = found.crossings[k];
    events.push_back({{"kind", crossing.angular_frequency > 0 ? "hopf" : "divergence"},
                      {"value", crossing.value},
                      {"error", crossing.error},
                      {"angular_frequency", crossing.angular_frequency}});
    if (k < found.small_cycles.size() && found.small_cycles[k])
      events.back().update({{"first_lyapunov_coefficient", found.small_cycles[k]->first_lyapunov_coefficient},
                            {"squared_amplitude_slope", found.small_cycles[k]->slope}});
  }
  for (std::size_t b = 0; b < found.cycles.size(); ++b) {
    const auto& [from, value, parent, to_value, branch] = found.cycles[b];
    branches.push_back({{"from", from},
                        {"value", value},
                        {"points", branch.points.size()},
                        {"ends", branch.outcome.detail.empty() ? "at the end of the range" : branch.outcome.detail}});
    if (parent >= 0) branches.back()["parent"] = parent;
    if (to_value) branches.back()["to_value"] = *to_value;
    for (const auto& at : branch.points)
      points.push_back(
          {{"value", at.p},
           {"kind", "cycle"},
           {"branch", b},
           {"stable", at.view.stable},
           {"metrics", at.view.metrics},
           {"multipliers", results::pairs(at.view.multipliers)},
           {"error", {{"value", at.error}, {"relative", at.x_error}, {"multipliers", at.view.multiplier_errors}}},
           {"asked", at.asked}});
    for (const auto& special : branch.special) {
      events.push_back({{"kind", special.kind}, {"value", special.p}, {"error", special.error}, {"branch", b}});
      if (special.view.metrics.contains("period")) events.back()["period"] = special.view.metrics.at("period");
    }
  }
  for (auto& event : events)
    if (const auto label = tasks::label_of(event["kind"]); !label.empty()) event["label"] = label;
  result["points"] = std::move(points);
  result["events"] = std::move(events);
  result["branches"] = std::move(branches);
  if (task.locus) result["loci"] = loci_of(task, loci);
  result["tolerance"] = task.options.tolerance;
  result.notes = found.notes;
  return result;
}

/// Of steady sliding at a value (m/s), at the first contact.
using SteadySlipRate = std::function<double(double p)>;

results::Table table_of(const scene::Scene& scene, const Branches& found, const SteadySlipRate& steady_slip_rate) {
  const auto weakly_nonlinear = [&](double p, const analysis::branches::SmallCycles* small) {
    const double amplitude = small ? small->amplitude(p) : NAN;
    return std::isnan(amplitude) ? NAN : std::abs(steady_slip_rate(p)) * (1 + amplitude);
  };
  const auto& parameter = scene.task<tasks::Branch>().parameter;
  const auto drawn = drawn_metric(found);
  std::vector<std::string> names;
  for (const auto& cycle : found.cycles)
    if (!cycle.branch.points.empty() && names.empty())
      for (const auto& [name, value] : cycle.branch.points.front().view.metrics)
        if (name != drawn) names.push_back(name);  // that one stands in front, of steady sliding too
  std::vector<results::Channel> channels = {{"branch", "1", "number of the branch; -1: steady sliding"},
                                            {parameter.name, parameter.unit, parameter.meaning},
                                            {"stable", "1", "1: neighbouring motions come nearer"},
                                            {drawn, "m/s"},
                                            {"largest_multiplier"}};
  for (const auto& name : names) channels.push_back({name, unit_of(scene, name)});
  channels.push_back({drawn + "_normal_form", "m/s", "as the normal form at the Hopf point has it"});
  std::vector<std::vector<double>> columns(channels.size());
  const auto add = [&](double branch, double value, bool stable, double rate, double multiplier) {
    columns[0].push_back(branch), columns[1].push_back(value), columns[2].push_back(stable);
    columns[3].push_back(rate), columns[4].push_back(multiplier);
  };
  for (const auto& at : found.steady) {
    if (!at.why.empty()) continue;
    add(-1, at.value, at.stable, at.slip_rates.front(), NAN);
    for (std::size_t k = 0; k <= names.size(); ++k) columns[5 + k].push_back(NAN);
  }
  for (std::size_t b = 0; b < found.cycles.size(); ++b)
    for (const auto& at : found.cycles[b].branch.points) {
      const auto metric = at.view.metrics.find(drawn);
      add(double(b), at.p, at.view.stable, metric == at.view.metrics.end() ? NAN : metric->second,
          at.view.multipliers.empty() ? NAN : std::abs(at.view.multipliers.front()));
      for (std::size_t k = 0; k < names.size(); ++k) columns[5 + k].push_back(at.view.metrics.at(names[k]));
      columns.back().push_back(weakly_nonlinear(at.p, analysis::branches::small_cycles_of(found, found.cycles[b])));
    }
  std::vector<results::Column> table;
  for (std::size_t c = 0; c < columns.size() - (found.small_cycles.empty() ? 1 : 0); ++c)
    table.push_back({std::move(channels[c]), std::move(columns[c])});
  return results::rows("branch", std::move(table));
}

results::Table table_of(const tasks::Branch& task, const Loci& loci) {
  std::vector<double> columns[6];
  for (std::size_t k = 0; k < loci.curves.size(); ++k)
    for (const auto& [p, q, p_error, q_error, metrics] : loci.curves[k].points) {
      const auto period = metrics.find("period"), frequency = metrics.find("angular_frequency");
      const double turn = period != metrics.end()      ? period->second
                          : frequency != metrics.end() ? 2 * std::numbers::pi / frequency->second
                                                       : NAN;
      const double row[] = {double(k), p, p_error, q, q_error, turn};
      for (std::size_t c = 0; c < 6; ++c) columns[c].push_back(row[c]);
    }
  const auto &p = task.parameter, &q = task.locus->parameter;
  return results::rows("locus", {{{"curve"}, columns[0]},
                                 {{p.name, p.unit, p.meaning}, columns[1]},
                                 {{p.name + "_error", p.unit}, columns[2]},
                                 {{q.name, q.unit, q.meaning}, columns[3]},
                                 {{q.name + "_error", q.unit}, columns[4]},
                                 {{"period", "s"}, columns[5]}});
}

/// Where the kind of change along a curve itself changes.
results::Table events_of(const tasks::Branch& task, const Loci& loci) {
  std::vector<std::string> kinds;
  std::vector<double> columns[5];
  for (std::size_t k = 0; k < loci.curves.size(); ++k)
    for (const auto& [kind, at] : loci.curves[k].events) {
      kinds.push_back(kind);
      const double row[] = {double(k), at.p, at.p_error, at.q, at.q_error};
      for (std::size_t c = 0; c < 5; ++c) columns[c].push_back(row[c]);
    }
  const auto &p = task.parameter, &q = task.locus->parameter;
  return {"locus-events",
          {{"locus_event", kinds.size()}},
          {{{"kind", ""}, std::move(kinds)},
           {{"curve"}, columns[0]},
           {{p.name, p.unit, p.meaning}, columns[1]},
           {{p.name + "_error", p.unit, results::error_of({p.name})}, columns[2]},
           {{q.name, q.unit, q.meaning}, columns[3]},
           {{q.name + "_error", q.unit, results::error_of({q.name})}, columns[4]}}};
}

/// Where branches change.
results::Table events_of(const tasks::Branch& task, const Branches& found) {
  std::vector<std::string> kinds;
  std::vector<double> values, errors;
  for (const auto& crossing : found.crossings) {
    kinds.emplace_back(crossing.angular_frequency > 0 ? "hopf" : "divergence");
    values.push_back(crossing.value), errors.push_back(crossing.error);
  }
  for (const auto& cycle : found.cycles)
    for (const auto& special : cycle.branch.special)
      kinds.push_back(special.kind), values.push_back(special.p), errors.push_back(special.error);
  const auto& p = task.parameter;
  return {"branch-events",
          {{"event", kinds.size()}},
          {{{"kind", ""}, std::move(kinds)},
           {{p.name, p.unit, p.meaning}, std::move(values)},
           {{p.name + "_error", p.unit, results::error_of({p.name})}, std::move(errors)}}};
}

/// Nothing for what is no number of the slider itself, such as an amplitude of its drive.
std::optional<analysis::branches::SmallCycles> small_cycles_at(const oscillators::Model& model, const std::string& path,
                                                               const analysis::steady::Crossing& crossing) {
  if (std::ranges::none_of(model.parameters(), [&](const auto& quantity) { return quantity.name == path; }))
    return std::nullopt;
  return analysis::branches::small_cycles(model, path, crossing);
}

/// The branch of `found` that the first cycle of `more` at a value lies on, by its period and its largest values.
std::optional<std::size_t> same_motion(const Branches& found, const Branches& more, double value) {
  if (more.cycles.empty() || more.cycles.front().branch.points.empty()) return std::nullopt;
  const auto& wanted = more.cycles.front().branch.points.front();
  const auto alike = [&](const auto& point) {
    constexpr double same = 1e-6;
    return std::abs(point.p - value) <= same * std::abs(value) &&
           std::ranges::all_of(point.view.metrics, [&](const auto& metric) {
             const auto& [name, number] = metric;
             if (name != "period" && !name.ends_with("_max")) return true;
             const auto other = wanted.view.metrics.find(name);
             return other != wanted.view.metrics.end() && std::abs(number - other->second) <= same * std::abs(number);
           });
  };
  for (std::size_t b = 0; b < found.cycles.size(); ++b)
    if (std::ranges::any_of(found.cycles[b].branch.points, alike)) return b;
  return std::nullopt;
}

/// The branches of another motion beside those that were found.
void add(Branches& found, Branches more) {
  const int first = int(found.cycles.size());
  for (auto& cycle : more.cycles) {
    if (cycle.parent >= 0) cycle.parent += first;
    found.cycles.push_back(std::move(cycle));
  }
  found.crossings.insert(found.crossings.end(), more.crossings.begin(), more.crossings.end());
  found.notes.insert(found.notes.end(), more.notes.begin(), more.notes.end());
  found.steps += more.steps, found.residuals += more.residuals;
  found.outcome = more.outcome;
}

Status perform_branch(Job& job) {
  auto& scene = job.scene();
  auto& task = scene.task<tasks::Branch>();
  task.options.tolerance = job.request().tolerance.value_or(task.options.tolerance);
  const auto path = task.parameter.name;
  const bool is_slider = !scene.structure;
  job.explain("cycles by multiple shooting, at tolerance {} and a hundredth of it", task.options.tolerance);
  job.explain("along {} by pseudo-arclength; from {}", path,
              task.from_cycle ? "a motion that has settled" : "steady sliding");
  const double threshold = scene.task<analysis::cycles::CycleOptions>().stick_threshold;
  const analysis::branches::Family family = [&](double p) {
    return is_slider ? analysis::branches::oscillator_of(scene.family->slider_with({{path, p}}), threshold)
                     : analysis::branches::oscillator_of(scene.family->with({{path, p}}).structure, threshold);
  };
  const auto second = task.locus ? task.locus->parameter.name : "";
  const analysis::branches::Family2 family_of_two = [&](double p, double q) {
    return is_slider
               ? analysis::branches::oscillator_of(scene.family->slider_with({{path, p}, {second, q}}), threshold)
               : analysis::branches::oscillator_of(scene.family->with({{path, p}, {second, q}}).structure, threshold);
  };
  if (has_periodic_drive(scene)) {
    const double from = task.options.parameter.from;
    analysis::branches::require_continuous_period(family, task.options.parameter, from);
    if (task.locus)
      analysis::branches::require_continuous_period([&](double q) { return family_of_two(from, q); },
                                                    task.locus->options.q, task.locus->value);
  }
  const auto begin = std::chrono::steady_clock::now();
  Branches found;
  const auto& range = task.options.parameter;
  bool has_started = false;
  const auto settled = [&](const tasks::Branch::Start& start) {
    has_started = true;
    if (is_slider && !analysis::branches::settles_as_structure(scene.model))
      return analysis::branches::settle(scene.family->slider_with({{path, range.from}}), task.options.tolerance,
                                        start.slider);
    auto model =
        is_slider
            ? analysis::motion::StructureModel{oscillators::one_slider(scene.family->slider_with({{path, range.from}})),
                                               {}}
            : scene.family->with({{path, range.from}});
    if (is_slider) model.start.kind = analysis::motion::Start::Kind::rest;
    if (start.structure) model.start = *start.structure;
    return analysis::branches::settle(model, task.options.tolerance);
  };
  const auto why_none = [&](const analysis::branches::Settled& cycle) {
    return fmt::format("at branch.from = {} the motion settles on no cycle: {}", range.from, cycle.outcome.detail);
  };
  const auto starts = task.starts.empty() ? std::vector<tasks::Branch::Start>(1) : task.starts;
  if (task.from_cycle) {
    for (std::size_t k = 0; k < starts.size() && found.outcome.complete(); ++k) {
      const auto number = starts.size() > 1 ? fmt::format("start {}: ", k + 1) : "";
      const auto cycle = settled(starts[k]);
      if (!cycle.outcome.complete())
        throw InputError(fmt::format("branch.start = \"cycle\": {}{}; give another value, or start = \"steady\"",
                                     number, why_none(cycle)));
      auto more = analysis::branches::from_cycle(family, cycle, range.from, task.options);
      if (const auto same = same_motion(found, more, range.from))
        found.notes.push_back(
            fmt::format("{}its motion is that of branch {}, which is followed already", number, *same));
      else
        add(found, std::move(more));
    }
  } else {
    std::optional<std::vector<analysis::steady::Crossing>> crossings;
    if (is_slider)
      for (const auto& quantity : scene.model.parameters())
        if (quantity.name == path) crossings = analysis::branches::crossings_of(scene.model, path, range);
    found = analysis::branches::from_steady_sliding(family, task.options, crossings);
    // Steady sliding is the question: that no cycle is found beside it is told.
    if (task.options.cycles && found.crossings.empty() &&
        std::ranges::none_of(found.steady, &analysis::branches::SteadyPoint::stable)) {
      const bool exists = found.steady.empty() ||
                          std::ranges::any_of(found.steady, [](const auto& point) { return point.why.empty(); });
      const auto unstable = exists ? std::string("steady sliding is nowhere stable, without a Hopf point")
                                   : fmt::format("there is no steady sliding: {}", found.steady.front().why);
      if (const auto cycle = settled(starts.front()); cycle.outcome.complete()) {
        job.note(unstable + ": cycles from the motion that has settled");
        auto steady = std::move(found.steady);
        found = analysis::branches::from_cycle(family, cycle, range.from, task.options);
        found.steady = std::move(steady);
      } else {
        found.notes.push_back(fmt::format("{}, and no cycles are followed: {}", unstable, why_none(cycle)));
        if (cycle.outcome.ending == Ending::interrupted) found.outcome = cycle.outcome;
      }
    }
  }
  if (!has_started && !task.starts.empty())
    found.notes.push_back("cycle.start has no effect: the branch begins with steady sliding");
  for (const auto& crossing : found.crossings) {
    auto& small = found.small_cycles.emplace_back();
    try {
      small = is_slider ? small_cycles_at(scene.model, path, crossing)
                        : analysis::branches::small_cycles(
                              [&](double p) {
                                return scene.family->with({{path, p}}).structure;
                              },
                              crossing);
    } catch (const InputError& error) {
      found.notes.push_back(fmt::format("the normal form at {:.9g} is not known: {}", crossing.value, error.what()));
    }
  }
  Loci loci;
  if (task.locus && found.outcome.complete()) {
    auto& locus = *task.locus;
    locus.options.tolerance = task.options.tolerance;
    locus.options.normal_form = [&](double p, double q, double angular_frequency) {
      return is_slider
                 ? analysis::steady::normal_form(scene.family->slider_with({{path, p}, {second, q}}), angular_frequency)
                 : analysis::steady::normal_form(scene.family->with({{path, p}, {second, q}}).structure,
                                                 {0, angular_frequency});
    };
    loci = analysis::branches::find_loci(family_of_two, found, locus.value, locus.options);
    found.outcome = loci.outcome;
  }
  for (const auto& cycle : found.cycles)
    if (found.outcome.complete() && cycle.branch.outcome.ending == Ending::budget_spent)
      found.outcome = {Ending::budget_spent,
                       fmt::format("{} before the branch from {} = {:.9g} came to its end; give more branch.points",
                                   cycle.branch.outcome.detail, path, cycle.from_value)};
  const double seconds = seconds_since(begin);
  const auto& unit = task.parameter.unit;
  const auto with_unit = [](double value, const std::string& si) {  // of what is chosen
    const auto unit = written_unit(si);
    return fmt::format("{:.9g}{}", value / unit.factor, unit.behind());
  };
  for (const auto& crossing : found.crossings)
    job.say("{:<17} {} = {}{}", crossing.angular_frequency > 0 ? "hopf" : "divergence", path,
            justified(crossing.value, crossing.error, unit),
            crossing.angular_frequency > 0 ? fmt::format(", {:.9g} rad/s (H)", crossing.angular_frequency) : "");
  for (const auto& [from, value, parent, to_value, branch] : found.cycles) {
    job.say("cycles from {} at {}: {} points, {}", from, with_unit(value, unit), branch.points.size(),
            branch.outcome.detail.empty() ? "to the end of the range" : branch.outcome.detail);
    for (const auto& special : branch.special)
      job.say("  {:<15} {} = {}{}", special.kind, path, justified(special.p, special.error, unit),
              in_brackets(tasks::label_of(special.kind)));
    for (const auto& at : branch.points)
      if (at.asked)
        job.say("  at {}: period {}, {}", with_unit(at.p, unit),
                justified(at.view.metrics.at("period"), at.x_error * at.view.metrics.at("period"), "s"),
                at.view.stable ? "stable" : "unstable");
  }
  if (found.cycles.empty() && found.crossings.empty())
    job.say("steady sliding does not change its stability between {} and {}", with_unit(range.from, unit),
            with_unit(range.to, unit));
  for (const auto& [kind, points, begins, ends, events] : loci.curves) {
    if (points.empty()) {
      found.notes.push_back(ends);
      continue;
    }
    const auto& second = task.locus->parameter;
    job.say("{} in two parameters, {} points:", kind, points.size());
    for (const auto& [point, why] : {std::pair{&points.front(), &begins}, {&points.back(), &ends}})
      job.say("  {} = {}, {} = {}{}{}", second.name, with_unit(point->q, second.unit), path,
              justified(point->p, point->p_error, unit), why->empty() ? "" : ": ", *why);
    for (const auto& [event, at] : events)
      job.say("  {:<15} {} = {}, {} = {}{}", event, second.name, justified(at.q, at.q_error, second.unit), path,
              justified(at.p, at.p_error, unit), in_brackets(tasks::label_of(event)));
  }
  for (const auto& note : found.notes) job.note(note);
  found.outcome = why_stopped(found.outcome);
  if (!found.outcome.complete()) job.note(fmt::format("{}: {}", name(found.outcome.ending), found.outcome.detail));
  auto& manifest = job.manifest();
  manifest.tolerance_asked = task.options.tolerance;
  for (const auto& cycle : found.cycles)
    for (const auto& at : cycle.branch.points)
      manifest.tolerance_reached = std::max(manifest.tolerance_reached, at.x_error);
  manifest.cost = {{"seconds", seconds}, {"steps", double(found.steps)}, {"closures", double(found.residuals)}};
  auto result = result_of(job, found, loci);
  result.cost = {{"seconds", seconds}, {"steps", found.steps}, {"closures", found.residuals}};
  result.tables = {table_of(scene, found,
                            [&](double p) {
                              const auto oscillator = family(p);
                              return oscillator->slip_rates(oscillator->steady()).front();
                            }),
                   events_of(task, found)};
  auto files = output::write_picture(job.folder(), scene, found);
  if (!loci.curves.empty()) {
    result.tables.push_back(table_of(task, loci));
    if (std::ranges::any_of(loci.curves, [](const auto& curve) { return !curve.events.empty(); }))
      result.tables.push_back(events_of(task, loci));
    const auto drawn = output::write_picture(job.folder(), scene, loci);
    files.insert(files.end(), drawn.begin(), drawn.end());
  }
  return job.finish(result, std::move(files));
}

}  // namespace

Verb branch_verb() {
  return {.name = "branch",
          .help = "steady sliding and cycles followed along a parameter, stable or not, and where they change",
          .example = "rosin branch examples/two-motions.toml",
          .operands = {scene_operand},
          .needs = model_tables({{"branch", "the parameter, from and to"}}),
          .options = scene_options(),
          .read = read_branch,
          .perform = perform_branch};
}

}  // namespace rosin::app::verbs
