/// The verb basin: which motion each of many starts comes to, and how hard steady sliding must be hit.
#include "app/tasks/basin.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>

#include "analysis/basins/basins.hpp"
#include "analysis/motion/structure_record.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/results/axis.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/structure.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using analysis::basins::Attractor;
using analysis::basins::Basins;
using analysis::motion::SteppedOscillator;
using nlohmann::ordered_json;
using tasks::StartAxis;

namespace {

constexpr Range any{-1e15, 1e15};

/// Every coordinate of the start, and every velocity; of one coordinate that slides the slip rate too.
std::vector<tasks::StartAxis> axes_of(const oscillators::Structure& structure) {
  std::vector<tasks::StartAxis> axes;
  for (const bool is_velocity : {false, true})
    for (int i = 0; i < structure.size(); ++i) {
      const auto& name = structure.names[std::size_t(i)];
      axes.push_back({is_velocity ? analysis::motion::velocity_name(name) : name, i, is_velocity});
    }
  if (structure.size() == 1 && structure.contacts.size() == 1 && structure.contacts[0].tangential[0] == 1)
    axes.push_back({"slip_rate", 0, true, {}, "m/s", structure.contacts[0].speed.value(0)});
  return axes;
}

/// Values in which starts of an oscillator that is followed by steps may differ.
std::vector<tasks::StartAxis> axes_of(const SteppedOscillator& oscillator) {
  std::vector<tasks::StartAxis> axes;
  for (const auto& start : oscillator.starts) {
    const bool is_velocity = start.unit.ends_with("/s");
    axes.push_back({start.name, int(axes.size()) % oscillator.coordinates, is_velocity, {}, start.unit});
  }
  return axes;
}

/// Coordinates along x and y may be numbered: displacement_1 is displacement_x.
std::string by_axis(std::string name) {
  if (name.ends_with("_1")) name.replace(name.size() - 1, 1, "x");
  if (name.ends_with("_2")) name.replace(name.size() - 1, 1, "y");
  return name;
}

tasks::StartAxis read_axis(scene::Table table, const scene::Scene& scene, bool random) {
  table.expect({"start", "from", "to", "points"});
  std::vector<std::string> names;
  const auto* stepped = scene::stepped_of(scene);
  const auto axes = stepped ? axes_of(*stepped) : axes_of(scene.structure->structure);
  for (const auto& axis : axes) names.push_back(axis.name);
  const auto& start = table.required("start", fmt::format("one of {}", fmt::join(names, ", ")));
  auto known = names;
  if (scene.plane)
    for (const char* number : {"_1", "_2"})
      for (const char* of : {"displacement", "velocity"}) known.push_back(std::string(of) + number);
  auto name = scene::choice(start, table.path("start"), known);
  if (scene.plane) name = by_axis(std::move(name));
  auto axis = axes[std::size_t(std::ranges::find(names, name) - names.begin())];
  const Quantity quantity{"", axis.unit, any, name + " at the start"};
  double from = 0, to = 0;
  table.required("from", quantity.meaning), table.required("to", quantity.meaning);
  table.read("from", from, quantity);
  table.read("to", to, quantity);
  if (from == to) scene::fail(table.source(), "{} and {} are both {}", table.path("from"), table.path("to"), from);
  int points = random ? 2 : 51;
  if (const auto* node = random ? table.find("points") : nullptr)
    scene::fail(node->source(), "{} does not go with basin.samples, which are random starts", table.path("points"));
  table.read("points", points, 2, scene::most_points, "number of values");
  for (int i = 0; i < points; ++i) axis.values.push_back(from + (to - from) * i / (points - 1));
  table.finish();
  return axis;
}

/// The first displacement and the first velocity, or two displacements, from −2 to 2 natural sizes.
std::pair<tasks::StartAxis, tasks::StartAxis> natural_axes(const scene::Scene& scene, bool random) {
  const auto* stepped = scene::stepped_of(scene);
  const auto axes = stepped ? axes_of(*stepped) : axes_of(scene.structure->structure);
  std::vector<double> sizes;
  if (stepped) {
    sizes = stepped->start_sizes;
  } else {
    const oscillators::StructureSystem system(scene.structure->structure);
    const auto start = analysis::motion::starting_point(system, scene.structure->start);
    sizes.resize(start.size());
    system.scale(start.data(), sizes.data());
  }
  const auto velocity = std::ranges::find(axes, true, &tasks::StartAxis::is_velocity);
  const auto second = velocity != axes.end() ? std::size_t(velocity - axes.begin()) : 1;
  auto x = axes.front(), y = axes[second];
  constexpr double reach = 2;
  constexpr int points = 9;
  for (const auto& [axis, size] : {std::pair{&x, sizes.front()}, {&y, sizes[second]}})
    for (int i = 0; i < points; i += random ? points - 1 : 1)
      axis->values.push_back(reach * size * (2.0 * i / (points - 1) - 1));
  return {x, y};
}

/// Starts on a grid, or at random, beside what the start is otherwise.
void read_starts(scene::Table& table, scene::Scene& scene) {
  auto& [x, y, random, places, direction, task] = scene.task<tasks::Basin>();
  const auto* stepped = scene::stepped_of(scene);
  const auto *of_x = table.find("x"), *of_y = table.find("y"), *samples = table.find("samples"),
             *seed = table.find("seed"), *start = table.find("start"), *refine = table.find("refine");
  if (!of_x && !of_y && table.find("direction")) {
    for (const auto& [key, node] :
         {std::pair{"samples", samples}, {"seed", seed}, {"start", start}, {"refine", refine}})
      if (node) scene::fail(node->source(), "basin.{} has no effect without basin.x and basin.y", key);
    return;
  }
  random = samples != nullptr;
  if (seed && !random) scene::fail(seed->source(), "basin.seed has no effect without basin.samples: a grid of starts");
  if (refine && random)
    scene::fail(refine->source(), "basin.refine has no effect on basin.samples: give a grid of starts");
  if (of_x || of_y) {
    const auto what =
        fmt::format("{{ start = \"{}\", from, to, points }}", stepped ? stepped->starts.front().name : "displacement");
    x = read_axis(scene::Table(table.required("x", what), table.path("x")), scene, random);
    y = read_axis(scene::Table(table.required("y", what), table.path("y")), scene, random);
  } else {
    std::tie(x, y) = natural_axes(scene, random);
    for (const auto& [key, axis] : {std::pair{'x', &x}, {'y', &y}})
      scene.notes.push_back(fmt::format("basin.{} is not given: {} from {:.4g} to {:.4g} {}, twice its natural size",
                                        key, axis->name, axis->values.front(), axis->values.back(), axis->unit));
  }
  if (x.is_same(y))
    scene::fail(of_y->source(), "basin.x and basin.y are the same, {}{}", x.name,
                x.name == y.name ? "" : fmt::format(" and {}", y.name));
  if (random) {
    int count = 0, chosen = 1;
    table.read("samples", count, 1, scene::most_points, "number of random starts");
    table.read("seed", chosen, 0, scene::largest_seed, "seed of the random starts");
    for (const auto& [a, b] : analysis::basins::random_places(count, std::uint64_t(chosen)))
      places.emplace_back(std::lerp(x.values[0], x.values[1], a), std::lerp(y.values[0], y.values[1], b));
  } else {
    if (x.values.size() > scene::most_points / y.values.size())
      scene::fail(table.source(), "basin has {} x {} starts, more than {}", x.values.size(), y.values.size(),
                  scene::most_points);
    for (const double at_y : y.values)
      for (const double at_x : x.values) places.emplace_back(at_x, at_y);
  }
  if (refine) {
    if (!refine->is_boolean()) scene::wrong_kind(*refine, table.path("refine"), "true or false");
    if (*refine->value<bool>()) task.refined_columns = int(x.values.size());
  }
  if (stepped) {
    if (refine)
      scene::fail(refine->source(), "basin.refine serves structures: here every start is followed to its end");
    if (start)
      scene::fail(start->source(),
                  "basin.start has no effect: what basin.x and basin.y leave is as cycle.start has it");
    std::vector<std::optional<double>> values(stepped->starts.size());
    for (const auto& [at_x, at_y] : places) {
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = stepped->starts[i].name == x.name   ? std::optional(at_x)
                    : stepped->starts[i].name == y.name ? std::optional(at_y)
                                                        : std::nullopt;
      task.starts.push_back(stepped->start_at(values));
    }
    return;
  }
  const auto& structure = scene.structure->structure;
  for (const auto* axis : {&x, &y})  // what an axis sets is no part of the start
    if (const auto* both = start && start->is_table() ? start->as_table()->get(axis->name) : nullptr)
      scene::fail(both->source(), "basin.start.{0} has no effect: basin.{1} sets {0}", axis->name,
                  axis == &x ? "x" : "y");
  if (start && structure.size() == 1)
    scene::fail(start->source(), "basin.start has no effect: basin.x and basin.y set {} and {}", x.name, y.name);
  analysis::motion::StructureStart beside;
  beside.kind = analysis::motion::Start::Kind::given;
  if (start) beside = scene::read_structure_start(*start, table.path("start"), structure);
  const oscillators::StructureSystem system(structure);
  scene::located(start ? start->source() : table.source(), [&] {
    const auto unknowns = analysis::motion::starting_point(system, beside);
    const auto velocity = system.velocity(0, unknowns.data());
    analysis::motion::StructureStart given;
    given.kind = analysis::motion::Start::Kind::given;
    given.coordinates.assign(unknowns.begin(), unknowns.begin() + structure.size());
    given.velocities.assign(velocity.begin(), velocity.end());
    for (const auto& [at_x, at_y] : places) {
      for (const auto& [axis, value] : {std::pair{&x, at_x}, {&y, at_y}})
        (axis->is_velocity ? given.velocities : given.coordinates)[std::size_t(axis->coordinate)] =
            axis->velocity_of(value);
      task.starts.push_back(analysis::motion::starting_point(system, given));
    }
  });
}

/// A disturbance of steady sliding: { velocity = 1 } and the range of its size.
void read_direction(scene::Table& table, scene::Scene& scene) {
  auto& basin = scene.task<tasks::Basin>();
  auto direction = table.table("direction");
  if (!direction) {
    for (const char* key : {"from", "to", "points"})
      if (const auto* node = table.find(key))
        scene::fail(node->source(), "basin.{} has no effect without basin.direction: those of starts are in x and y",
                    key);
    return;
  }
  if (scene::stepped_of(scene))
    scene::fail(direction->source(),
                "basin.direction serves structures, whose steady sliding is known: give starts, basin.x and basin.y");
  const auto& structure = scene.structure->structure;
  auto& disturbance = basin.task.disturbance.emplace();
  disturbance.coordinates = disturbance.velocities = Eigen::VectorXd::Zero(structure.size());
  for (const auto& axis : axes_of(structure)) {
    double part = 0;
    direction->read(axis.name, part, {"", axis.unit, any, "disturbance of size 1"});
    (axis.is_velocity ? disturbance.velocities : disturbance.coordinates)[axis.coordinate] +=
        axis.surface_speed ? -part : part;
    if (part != 0) basin.direction.emplace_back(axis, part);
  }
  direction->finish();
  if (basin.direction.empty()) scene::fail(direction->source(), "basin.direction does not disturb anything");
  const Quantity size{"", "1", any, "size of the disturbance, times basin.direction"};
  table.required("to", size.meaning);
  table.read("from", disturbance.from, size);
  table.read("to", disturbance.to, size);
  if (!(std::abs(disturbance.from) < std::abs(disturbance.to)) || disturbance.from * disturbance.to < 0)
    scene::fail(table.source(), "basin.from = {} must be nearer to 0 than basin.to = {}, on the same side",
                disturbance.from, disturbance.to);
  table.read("points", disturbance.points, 2, scene::most_points, "sizes among which the first is looked for");
}

void read_basin(scene::SceneReader& reader) {
  auto& scene = reader.scene;
  auto& basin = scene.task<tasks::Basin>();
  scene::Table table(reader.need("basin", "starts along x and y, or a direction from steady sliding"), "basin");
  reader.law();
  reader.oscillator();
  if (!scene::read_stepped(reader)) {
    scene::read_structure_model(reader);
    scene::located(reader.root.find("drive")->source(), [&] { common_period(scene.structure->structure); });
  }
  table.expect({"x", "y", "samples", "seed", "start", "direction", "from", "to", "points", "returns", "refine"});
  read_starts(table, scene);
  read_direction(table, scene);
  table.read("returns", basin.task.most_returns, 10, 10'000'000, "returns within which motions are recognised");
  table.finish();
}

ordered_json axis_of(const tasks::StartAxis& axis) {
  return {{"start", axis.name}, {"unit", axis.unit}, {"values", axis.values}};
}

/// The number of the attractor that each start comes to, over the grid, or with the places of random starts.
results::Table table_of(const scene::Scene& scene, const Basins& found) {
  const auto& [x, y, random, places, direction, task] = scene.task<tasks::Basin>();
  results::Table table{
      .name = "basin", .dimensions = {}, .columns = {}, .more = {{"tolerance", task.tolerance}}, .is_field = true};
  const auto add = [&](const tasks::StartAxis& axis, std::size_t dimension, std::vector<double> values) {
    table.columns.push_back({{axis.name, axis.unit, axis.name + " at the start"}, std::move(values), {}, {dimension}});
  };
  if (random) {
    table.dimensions = {{"start", places.size()}};
    std::vector<double> x_values, y_values;
    for (const auto& [at_x, at_y] : places) x_values.push_back(at_x), y_values.push_back(at_y);
    add(x, 0, std::move(x_values)), add(y, 0, std::move(y_values));
  } else {
    table.dimensions = {{y.name, y.values.size()}, {x.name, x.values.size()}};
    add(y, 0, y.values), add(x, 1, x.values);
  }
  const std::vector<std::size_t> all = random ? std::vector<std::size_t>{0} : std::vector<std::size_t>{0, 1};
  results::Flags labels;
  for (const int label : found.labels) labels.values.push_back(static_cast<signed char>(label));
  for (std::size_t k = 0; k < found.basins.size(); ++k) {
    labels.numbers.push_back(static_cast<signed char>(k));
    labels.words += fmt::format("{}{}_{}", k > 0 ? " " : "", name(found.basins[k].attractor.kind), k);
  }
  table.columns.push_back({{"attractor", "", "what the motion comes to; -1: not done"}, std::move(labels), {}, all});
  if (!found.followed.empty())
    table.columns.push_back({{"followed", "", "1: the start was followed; 0: it has the label of its neighbours"},
                             results::Flags{{found.followed.begin(), found.followed.end()}, {}, {}},
                             {},
                             all});
  return table;
}

results::Result result_of(const Job& job, const Basins& found) {
  const auto& scene = job.scene();
  const auto& [x, y, random, places, direction, task] = scene.task<tasks::Basin>();
  auto result = job.result(found.outcome);
  auto attractors = ordered_json::array();
  for (const auto& basin : found.basins) {
    results::Object one;
    one["kind"] = name(basin.attractor.kind);
    if (!places.empty()) {
      one["share"] = found.shares_of > 0 ? ordered_json(basin.share) : ordered_json();
      one["standard_error"] = found.shares_of > 0 ? ordered_json(basin.error) : ordered_json();
      one["count"] = basin.count;
    }
    one["metrics"] = ordered_json::object(), one["error"] = ordered_json::object();
    for (const auto& [name, measure] : basin.attractor.metrics)
      one["metrics"][name] = measure.value, one["error"][name] = measure.error;
    if (!basin.attractor.detail.empty()) one["detail"] = basin.attractor.detail;
    attractors.push_back(one.entry());
  }
  result["attractors"] = std::move(attractors);
  if (!places.empty()) {
    result["shares_of"] = found.shares_of;
    result["x"] = axis_of(x), result["y"] = axis_of(y);
    struct {
      const tasks::StartAxis &x, &y;
    } const plane{x, y};
    if (!random)
      result["labels"] = results::grid(
          plane, [&](std::size_t i) { return found.labels[i] < 0 ? ordered_json() : ordered_json(found.labels[i]); });
    result.tables = {table_of(scene, found)};
  }
  if (!found.followed.empty())
    result["refined"] = {{"followed", std::ranges::count(found.followed, true)},
                         {"sample", found.sample},
                         {"sample_wrong", found.sample_wrong}};
  if (found.threshold)
    result["threshold"] = {
        {"value", found.threshold->value}, {"error", found.threshold->error}, {"beyond", found.threshold->beyond}};
  else if (task.disturbance)
    result["threshold"] = nullptr;
  result["tolerance"] = task.tolerance;
  if (!found.no_threshold.empty()) result.notes.push_back(found.no_threshold);
  return result;
}

/// "velocity 1.2398476 ± 5e-07 m/s": what is added to steady sliding.
std::string disturbance_of(const tasks::Basin& basin, double value, double error) {
  std::vector<std::string> parts;
  for (const auto& [axis, part] : basin.direction)
    parts.push_back(fmt::format("{} {}", axis.name, justified(value * part, std::abs(error * part), axis.unit)));
  return fmt::format("{}", fmt::join(parts, ", "));
}

Status perform_basin(Job& job) {
  auto& scene = job.scene();
  auto& task = scene.task<tasks::Basin>().task;
  task.tolerance = job.request().tolerance.value_or(task.tolerance);
  task.threads = job.request().threads;
  const auto* stepped = scene::stepped_of(scene);
  job.explain("{} starts, each followed until it {}", task.starts.size(),
              stepped ? "recurs" : "comes near a known attractor, and nearer from return to return");
  job.explain("attractors: steady sliding by its eigenvalues, cycles as 'rosin cycle' has them");
  if (task.disturbance)
    job.explain("{} disturbances of steady sliding, then halving to a width of {}", task.disturbance->points,
                task.tolerance);
  const auto begin = std::chrono::steady_clock::now();
  auto found = [&] {
    Progress progress(job.request().quiet);
    const auto show = [&](std::size_t done, std::size_t total) { progress.show(done, total); };
    return stepped ? analysis::basins::find_basins(*stepped, task, show)
                   : analysis::basins::find_basins(scene.structure->structure, task, show);
  }();
  const double seconds = seconds_since(begin);
  auto& manifest = job.manifest();
  manifest.tolerance_asked = task.tolerance;
  manifest.cost = {{"seconds", seconds}, {"starts", double(task.starts.size())}, {"threads", double(task.threads)}};
  Reached reached;
  for (std::size_t k = 0; k < found.basins.size(); ++k) {
    const auto& [attractor, count, share, error] = found.basins[k];
    std::string what;
    const auto add = [&](const char* metric) {
      const auto& known = attractor.metrics.at(metric);
      reached.add(known.value, known.error);
      what += fmt::format(", {} {}", output::readable(metric), justified(known.value, known.error, known.unit));
    };
    if (attractor.kind == Attractor::Kind::steady && !stepped) add("growth_rate");
    if (attractor.kind == Attractor::Kind::cycle) add("period");
    if (!attractor.detail.empty()) what += "; the first: " + attractor.detail;
    const auto part =
        found.shares_of == 0 ? std::string() : fmt::format(" {:.2f} ± {:.2f} %", 100 * share, 100 * error);
    job.say("{}  {:<9}{}{}", k, name(attractor.kind), part, what);
  }
  manifest.tolerance_reached = reached.value();
  if (!found.followed.empty())
    job.say(
        "{} of {} starts followed, the others lie amid their like; {} of a sample of {} of those came to something "
        "else",
        std::ranges::count(found.followed, true), task.starts.size(), found.sample_wrong, found.sample);
  if (found.threshold) {
    const auto& [value, error, beyond] = *found.threshold;
    job.say("steady sliding is left from {} on, to {}", disturbance_of(scene.task<tasks::Basin>(), value, error),
            beyond);
  }
  if (!found.no_threshold.empty()) job.note(found.no_threshold);
  found.outcome = why_stopped(found.outcome);
  if (!found.outcome.complete()) job.note(fmt::format("{}: {}", name(found.outcome.ending), found.outcome.detail));
  auto result = result_of(job, found);
  result.cost = {{"seconds", seconds}};
  return job.finish(
      result, result.tables.empty() ? std::vector<std::string>() : output::write_picture(job.folder(), scene, found));
}

}  // namespace

Verb basin_verb() {
  return {.name = "basin",
          .help = "which motion starts come to, with what share, and how hard steady sliding must be hit to leave it",
          .example = "rosin basin examples/which-motion.toml",
          .operands = {scene_operand},
          .needs = model_tables({{"basin", "starts along x and y, or a direction from steady sliding"}}),
          .options = scene_options(),
          .read = read_basin,
          .perform = perform_basin};
}

}  // namespace rosin::app::verbs
