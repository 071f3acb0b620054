/// The picture of basins: what each start comes to, in colours, with the cycles and steady sliding where they are.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/basins/basins.hpp"
#include "app/output/caption.hpp"
#include "app/output/digits.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/basin.hpp"

namespace rosin::app::output {

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
void write_orbits(const std::filesystem::path& path, const tasks::Basin& task, const Basins& found) {
  std::string text = task.x.name + "," + task.y.name + "\n";
  for (const auto& basin : found.basins) {
    const auto& orbit = basin.attractor.orbit;
    if (!orbit.contains(task.x.name) || !orbit.contains(task.y.name)) continue;
    const auto &x = orbit.at(task.x.name), &y = orbit.at(task.y.name);
    for (std::size_t i = 0; i < x.size(); ++i) text += fmt::format("{},{}\n", x[i], y[i]);
    text += '\n';
  }
  write_whole(path, text);
}

/// Neighbours along x that come to the same, as one box: label, centre, ends along x and y.
void write_cells(const std::filesystem::path& path, const tasks::Basin& task, const Basins& found) {
  const auto &x = task.x.values, &y = task.y.values;
  const double half_x = 0.5 * (x[1] - x[0]), half_y = 0.5 * (y[1] - y[0]);
  std::vector<double> columns[7];
  for (std::size_t row = 0; row < y.size(); ++row)
    for (std::size_t first = 0, next; first < x.size(); first = next) {
      const int label = found.labels[row * x.size() + first];
      for (next = first + 1; next < x.size() && found.labels[row * x.size() + next] == label;) ++next;
      const double begin = x[first] - half_x, end = x[next - 1] + half_x;
      const double cell[] = {double(label), 0.5 * (begin + end), y[row], begin, end, y[row] - half_y, y[row] + half_y};
      for (std::size_t c = 0; c < 7; ++c) columns[c].push_back(cell[c]);
    }
  write_csv(path, {{"attractor", columns[0]},
                   {"x", columns[1]},
                   {"y", columns[2]},
                   {"x_low", columns[3]},
                   {"x_high", columns[4]},
                   {"y_low", columns[5]},
                   {"y_high", columns[6]}});
}

}  // namespace

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const Basins& found) {
  const auto& task = scene.task<tasks::Basin>();
  const auto &x = task.x, &y = task.y;
  std::vector<double> columns[3];
  for (std::size_t i = 0; i < task.places.size(); ++i) {
    columns[0].push_back(task.places[i].first), columns[1].push_back(task.places[i].second);
    columns[2].push_back(found.labels[i] < 0 ? NAN : double(found.labels[i]));
  }
  std::vector<Column> table{{column_header(x.name, x.unit), columns[0]},
                            {column_header(y.name, y.unit), columns[1]},
                            {"attractor", columns[2]}};
  const std::vector<double> followed(found.followed.begin(), found.followed.end());
  if (!followed.empty()) table.push_back({"followed", followed});
  write_csv(folder / "basin.csv", table);
  write_orbits(folder / "basin-cycles.csv", task, found);
  std::vector<std::string> files = {"basin.csv", "basin-cycles.csv", "basin.gp"};
  if (!task.random) write_cells(folder / files.emplace_back("basin-cells.csv"), task, found);

  const Sheet sheet{"basin",
                    "What starts come to",
                    {.width = 760, .panel = 420, .key = Layout::Key::below},
                    scene.title,
                    caption(scene)};
  std::string script = fmt::format("set xlabel {}\nset ylabel {}\n", label(readable(x.name) + " at the start", x.unit),
                                   label(readable(y.name) + " at the start", y.unit));
  script +=
      "set key samplen 1.6\nset style fill "
      "solid 1 border linecolor '#777777'\n";
  const auto range = [&](const tasks::StartAxis& axis) {
    const auto [low, high] = std::ranges::minmax(axis.values);
    const double margin = task.random ? 0 : 0.5 * std::abs(axis.values[1] - axis.values[0]);
    return std::pair(low - margin, high + margin);
  };
  const auto [x_low, x_high] = range(x);
  const auto [y_low, y_high] = range(y);
  script += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x_low, x_high, y_low, y_high);
  std::vector<std::string> curves;
  std::size_t cycle = 0;
  for (std::size_t k = 0; k < found.basins.size(); ++k) {
    const auto& basin = found.basins[k];
    const auto colour = colour_of(basin.attractor.kind, cycle);
    if (basin.attractor.kind == Attractor::Kind::cycle) ++cycle;
    if (task.random)
      for (const auto& [size, fill] :
           {std::pair{0.5, "#555555"}, {0.35, colour.c_str()}})  // light ones show by the rim
        curves.push_back(
            fmt::format("'basin.csv' using 1:($3=={}?$2:NaN) with points pointtype 7 pointsize {} "
                        "linecolor '{}' notitle",
                        k, size, fill));
    else  // borders of their colour, so that no seams show
      curves.push_back(
          fmt::format("'basin-cells.csv' using 2:($1=={}?$3:NaN):4:5:6:7 with boxxyerror fillcolor '{}' "
                      "fillstyle solid 1 border linecolor '{}' notitle",
                      k, colour, colour));
    curves.push_back(fmt::format("NaN with boxes fillcolor '{}' title {}", colour,
                                 single_quoted(title_of(basin, found.shares_of > 0))));
  }
  const auto line = [&](const std::string& what, const char* dash, const std::string& title) {
    curves.push_back(what + " with lines linewidth 4 linecolor '#FFFFFF' notitle");
    curves.push_back(
        fmt::format("{} with lines linewidth 1.5 linecolor '#000000' dashtype {} title '{}'", what, dash, title));
  };
  const bool shows_orbits = std::ranges::any_of(found.basins, [&](const auto& basin) {
    return basin.attractor.orbit.contains(x.name) && basin.attractor.orbit.contains(y.name);
  });
  if (shows_orbits) line("'basin-cycles.csv' using 1:2", "solid", "the motion of a cycle");
  const bool of_structure = scene.structure && !scene.block;
  const auto structure = of_structure ? scene.structure->structure : oscillators::Structure();
  for (const double speed : surface_speeds(structure, y)) line(fmt::format("{}", speed), "(6,4)", "speed of the belt");
  for (const double speed : surface_speeds(structure, x))
    line(fmt::format("'+' using ({}):({}+({})*$0/99.)", speed, y_low, y_high - y_low), "(6,4)", "speed of the belt");
  for (const auto& basin : found.basins)
    if (basin.attractor.kind == Attractor::Kind::steady && (of_structure || scene.plane)) {
      const auto at = [&](const tasks::StartAxis& axis) {
        return axis.is_velocity ? axis.velocity_of(0) : basin.attractor.points.front()[std::size_t(axis.coordinate)];
      };
      curves.push_back(
          fmt::format("'+' using ({}):({}) every ::::0 with points pointtype 2 pointsize 1.1 linewidth 2 "
                      "linecolor '#000000' title 'where sliding is steady'",
                      at(x), at(y)));
    }
  script += fmt::format("plot {}\n", fmt::join(curves, ", \\\n     "));
  write_whole(folder / "basin.gp", sheet.with(std::move(script)));
  return files;
}

}  // namespace rosin::app::output
