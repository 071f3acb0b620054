/// The picture of basins: what each start comes to, in colours, with the cycles and steady sliding where they are.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/basins/basins.hpp"
#include "app/output/digits.hpp"
#include "app/output/figure.hpp"
#include "app/output/pictures.hpp"
#include "app/output/scene_figure.hpp"
#include "app/output/symbols.hpp"
#include "app/tasks/basin.hpp"

namespace rosin::app::output {

using namespace results;

namespace {

using analysis::basins::Attractor;
using analysis::basins::Basins;
using tasks::StartAxis;

/// Colours that differ in lightness, for the colour-blind and in grey (after Okabe & Ito); cycles take several.
std::string colour_of(Attractor::Kind kind, std::size_t cycle) {
  constexpr std::array cycles = {"#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00"};
  switch (kind) {
    case Attractor::Kind::steady:
      return "#F3E6B3";
    case Attractor::Kind::rest:
      return "#B9B9B9";
    case Attractor::Kind::escape:
      return "#FFFFFF";
    case Attractor::Kind::irregular:
      return "#000000";
    case Attractor::Kind::cycle:
      break;
  }
  return cycles[cycle % cycles.size()];
}

std::string title_of(const Basins::Basin& basin, bool has_share) {
  const auto share = has_share ? fmt::format(", {} %", with_error(100 * basin.share, 100 * basin.error)) : "";
  switch (basin.attractor.kind) {
    case Attractor::Kind::steady:
      return "steady sliding" + share;
    case Attractor::Kind::rest:
      return "rest" + share;
    case Attractor::Kind::escape:
      return "grows without bound" + share;
    case Attractor::Kind::irregular:
      return "irregular" + share;
    case Attractor::Kind::cycle:
      break;
  }
  return fmt::format("cycle of {:.4g} s{}", basin.attractor.metrics.at("period").value, share);
}

/// The speed of the surface that alone touches a coordinate, if the axis is its velocity; as a slip rate it is 0.
std::vector<double> surface_speeds(const oscillators::Structure& structure, const tasks::StartAxis& axis) {
  std::vector<double> speeds;
  for (const auto& contact : structure.contacts) {
    const auto& t = contact.tangential;
    if (!axis.is_velocity || t[axis.coordinate] == 0 || t.squaredNorm() != t[axis.coordinate] * t[axis.coordinate])
      continue;
    const double speed = axis.velocity_of(contact.speed.level() / t[axis.coordinate]);
    if (std::ranges::find(speeds, speed) == speeds.end()) speeds.push_back(speed);
  }
  return speeds;
}

/// The orbits of all cycles along both axes, an empty row between them.
FigureTable orbits_of(const tasks::Basin& task, const Basins& found) {
  FigureTable table{"basin-cycles.csv", {{task.x.name, {}}, {task.y.name, {}}}};
  for (const auto& basin : found.basins) {
    const auto& orbit = basin.attractor.orbit;
    if (!orbit.contains(task.x.name) || !orbit.contains(task.y.name)) continue;
    for (std::size_t c = 0; c < 2; ++c) {
      const auto& along = orbit.at(c == 0 ? task.x.name : task.y.name);
      auto& values = table.columns[c].values;
      values.insert(values.end(), along.begin(), along.end());
      values.push_back(NAN);
    }
  }
  return table;
}

/// Neighbours along x that come to the same, as one cell.
FigureTable cells_of(const tasks::Basin& task, const Basins& found) {
  FigureTable table{"basin-cells.csv", {}};
  for (const char* name : {"attractor", "x", "y", "x_low", "x_high", "y_low", "y_high"})
    table.columns.push_back({name, {}});
  const auto &x = task.x.values, &y = task.y.values;
  const double half_x = 0.5 * (x[1] - x[0]), half_y = 0.5 * (y[1] - y[0]);
  for (std::size_t row = 0; row < y.size(); ++row)
    for (std::size_t first = 0, next; first < x.size(); first = next) {
      const int label = found.labels[row * x.size() + first];
      for (next = first + 1; next < x.size() && found.labels[row * x.size() + next] == label;) ++next;
      const double begin = x[first] - half_x, end = x[next - 1] + half_x;
      const double cell[] = {double(label), 0.5 * (begin + end), y[row], begin, end, y[row] - half_y, y[row] + half_y};
      for (std::size_t c = 0; c < 7; ++c) table.columns[c].values.push_back(cell[c]);
    }
  return table;
}

Axis axis_of_starts(const StartAxis& axis, bool has_cells) {
  const auto [low, high] = std::ranges::minmax(axis.values);
  const double margin = has_cells ? 0.5 * std::abs(axis.values[1] - axis.values[0]) : 0;
  const auto [words, symbol] = in_words(axis.name);
  return {.name = words,
          .unit = axis.unit,
          .symbol = symbol,
          .detail = "at the start",
          .from = low - margin,
          .to = high + margin};
}

}  // namespace

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const Basins& found) {
  const auto& task = scene.task<tasks::Basin>();
  const auto &x = task.x, &y = task.y;
  auto figure = figure_of(scene, "basin", "What starts come to");
  figure.width = 760, figure.height = 420, figure.key = Key::below;
  FigureTable starts{"basin.csv", {column_of(x.name, x.unit, {}), column_of(y.name, y.unit, {}), {"attractor", {}}}};
  for (std::size_t i = 0; i < task.places.size(); ++i) {
    const auto [at_x, at_y] = task.places[i];
    const double row[] = {at_x, at_y, found.labels[i] < 0 ? NAN : double(found.labels[i])};
    for (std::size_t c = 0; c < 3; ++c) starts.columns[c].values.push_back(row[c]);
  }
  if (!found.followed.empty()) starts.columns.push_back({"followed", {found.followed.begin(), found.followed.end()}});
  figure.tables = {std::move(starts), orbits_of(task, found)};
  if (!task.random) figure.tables.push_back(cells_of(task, found));

  Panel panel{.x = axis_of_starts(x, !task.random), .y = axis_of_starts(y, !task.random), .grid = false};
  std::size_t cycle = 0;
  for (std::size_t k = 0; k < found.basins.size(); ++k) {
    const auto& basin = found.basins[k];
    const auto colour = colour_of(basin.attractor.kind, cycle);
    if (basin.attractor.kind == Attractor::Kind::cycle) ++cycle;
    Line line{.table = "basin-cells.csv",
              .x = {2},
              .y = {3},
              .how = How::cells,
              .look = {.colour = colour},
              .title = title_of(basin, found.shares_of > 0),
              .where = {{1, '=', double(k)}},
              .corners = 4};
    if (task.random) {
      line.table = "basin.csv", line.x = {1}, line.y = {2}, line.how = How::points, line.where[0].column = 3;
      auto rim = line;  // light ones show by it
      rim.title = "", rim.look = {.colour = "#555555", .size = 0.5};
      line.look.size = 0.35;
      panel.lines.push_back(std::move(rim));
    }
    panel.lines.push_back(std::move(line));
  }
  if (std::ranges::any_of(found.basins, [&](const auto& basin) {
        return basin.attractor.orbit.contains(x.name) && basin.attractor.orbit.contains(y.name);
      }))
    panel.lines.push_back({.table = "basin-cycles.csv",
                           .look = {.colour = "#000000", .width = 1.5, .halo = true},
                           .title = "the motion of a cycle"});
  const bool of_structure = scene.structure && !scene.block;
  const auto structure = of_structure ? scene.structure->structure : oscillators::Structure();
  for (const auto& [name, axis] : {std::pair{'x', &x}, {'y', &y}})
    for (const double speed : surface_speeds(structure, *axis))
      panel.rules.push_back(
          {name, speed, {.colour = "#000000", .dash = "6,4", .width = 1.5, .halo = true}, "speed of the belt"});
  for (const auto& basin : found.basins)
    if (basin.attractor.kind == Attractor::Kind::steady && (of_structure || scene.plane)) {
      const auto at = [&](const StartAxis& axis) {
        return axis.is_velocity ? axis.velocity_of(0) : basin.attractor.points.front()[std::size_t(axis.coordinate)];
      };
      panel.marks.push_back({at(x),
                             at(y),
                             "",
                             Side::none,
                             {.colour = "#000000", .width = 2, .point = Point::cross, .size = 1.1},
                             true,
                             "where sliding is steady"});
    }
  figure.panels = {std::move(panel)};
  return write(folder, figure);
}

}  // namespace rosin::app::output
