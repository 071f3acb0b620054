/// Pictures of bowed strings: velocity, friction, temperature and bridge force over time, friction against slip rate,
/// and planes of transients with the limits that theory has for them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/planes/map.hpp"
#include "analysis/strings/strings.hpp"
#include "app/output/figure.hpp"
#include "app/output/pictures.hpp"
#include "app/output/scene_figure.hpp"
#include "app/scene/family.hpp"
#include "app/tasks/bowing.hpp"

namespace rosin::app::output {

using namespace results;

namespace {

using analysis::strings::Pixel;
using analysis::strings::StringRecord;

constexpr const char *position = "oscillator.bow_position", *load = "drive.normal_load",
                     *acceleration = "drive.speed.ramp.rate";

/// Ends of cells around values on a scale.
std::vector<double> borders(const analysis::planes::Axis& axis) {
  const auto& values = axis.values;
  const auto along = [&](double x) { return axis.logarithmic ? std::log(x) : x; };
  const auto back = [&](double x) { return axis.logarithmic ? std::exp(x) : x; };
  std::vector<double> ends;
  for (std::size_t i = 0; i <= values.size(); ++i) {
    const double before = i > 0 ? along(values[i - 1]) : 2 * along(values[0]) - along(values[1]);
    const double after =
        i < values.size() ? along(values[i]) : 2 * along(values.back()) - along(values[values.size() - 2]);
    ends.push_back(back(0.5 * (before + after)));
  }
  return ends;
}

/// A number of the scene that a plane is drawn over; of a ramp of the bow its rate.
Axis named(const scene::Scene& scene, const analysis::planes::Axis& values) {
  auto axis = values.parameter == acceleration
                  ? Axis{.name = "acceleration of the bow", .unit = "m/s²", .decades = values.logarithmic}
                  : axis_of(values.parameter, scene.describe(values.parameter), values.logarithmic);
  const auto ends = borders(values);
  axis.from = ends.front(), axis.to = ends.back();
  return axis;
}

/// A table of all strings of a plane, row by row: where each stands, and the ends of its cell.
FigureTable table_of_cells(const scene::Scene& scene, std::string file) {
  const auto &x = scene.string->x, &y = scene.string->y;
  const auto of_x = borders(x), of_y = borders(y);
  FigureTable table{std::move(file),
                    {column_of(x.parameter, scene.describe(x.parameter).unit, {}),
                     column_of(y.parameter, scene.describe(y.parameter).unit, {})}};
  for (const char* name : {"x_low", "x_high", "y_low", "y_high"}) table.columns.push_back({name, {}});
  for (std::size_t j = 0; j < y.values.size(); ++j)
    for (std::size_t i = 0; i < x.values.size(); ++i) {
      const double place[] = {x.values[i], y.values[j], of_x[i], of_x[i + 1], of_y[j], of_y[j + 1]};
      for (std::size_t c = 0; c < std::size(place); ++c) table.columns[c].values.push_back(place[c]);
    }
  return table;
}

/// A line of the theory over one axis of the plane.
struct Limit {
  std::string title;
  std::vector<double> x, y;
};

std::vector<Limit> limits_of(const scene::Scene& scene) {
  const auto& task = *scene.string;
  const bool swapped = task.x.parameter == load;
  const auto &along = swapped ? task.y : task.x, &force = swapped ? task.x : task.y;
  if (force.parameter != load) return {};
  std::vector<Limit> limits;
  const auto add = [&](std::string title, const std::function<double(double)>& of) {
    Limit limit{std::move(title), {}, {}};
    for (const double value : along.values) {
      const double N = of(value);
      if (!(N > 0) || !std::isfinite(N)) continue;
      limit.x.push_back(swapped ? N : value), limit.y.push_back(swapped ? value : N);
    }
    if (limit.x.size() > 1) limits.push_back(std::move(limit));
  };
  if (along.parameter == acceleration) {
    const double middle = along.values[along.values.size() / 2], N = force.values[force.values.size() / 2];
    const auto model = scene.family->string_with({{along.parameter, middle}, {force.parameter, N}});
    const auto& law = *model.law;
    const double at_rest = analysis::strings::friction_at_rest(law, N);
    const double speed = middle * analysis::strings::first_slip_of_slow_bow(model);
    const double falls = at_rest - law.steady_friction({speed / model.string.bow_position, N}).friction;
    if (!(falls > 0)) return {};
    const auto rays = analysis::strings::guettler_rays(model.string, at_rest, falls, task.good);
    add("several slips below", [&](double a) { return rays.lower * a; });
    add(fmt::format("late slips above ({:g} periods)", task.good), [&](double a) { return rays.upper * a; });
  } else if (along.parameter == position) {
    const auto limit = [&](double beta) {
      const auto model = scene.family->string_with({{along.parameter, beta}});
      return analysis::strings::schelleng_limits(model, model.speed.value(1e3));
    };
    add("Schelleng's maximum", [&](double beta) { return limit(beta).most; });
    add("Schelleng's minimum", [&](double beta) { return limit(beta).least; });
  }
  return limits;
}

}  // namespace

std::vector<std::string> write_string_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                              const StringRecord& record) {
  const auto& task = *scene.string;
  const auto& transient = record.bowing.transient;
  const double period = task.model.string.period(), step = task.model.string.step();
  // The first periods after the first slip show what a transient is.
  constexpr double before = 1, shown = 11;
  const double first = transient.slips.empty() ? 0 : std::max(0.0, record.bowing.first_slip - before * period);
  const double last = std::min(record.time.back(), first + (before + shown) * period);
  const auto from = std::size_t(std::ranges::lower_bound(record.time, first) - record.time.begin()),
             to = std::size_t(std::ranges::upper_bound(record.time, last) - record.time.begin());
  const auto extent = [&](const std::vector<double>& list) {
    return Extent::of(std::span(list).subspan(from, std::max<std::size_t>(to - from, 1)));
  };
  auto figure = figure_of(scene, "run", "A bowed string: what happens under the bow and at the bridge");
  figure.width = 900, figure.height = 140;
  Panel panel{.x = {.name = "time; slip is shaded", .unit = "s", .shown = {0, last}, .from = first, .to = last}};
  // Merged slips count as one.
  for (const auto& slip : transient.slips)
    if (const double on = double(slip.on) * step, off = double(slip.off) * step; off >= first && on <= last)
      panel.shades.push_back({'x', std::max(on, first), std::min(off, last), "#E3E8EE"});
  const auto add = [&](const char* name, const char* unit, Extent values, std::vector<Line> lines) {
    auto one = panel;
    one.y = {.name = name, .unit = unit, .shown = values};
    if (values.known())
      one.y.from = values.low - 0.06 * values.largest(), one.y.to = values.high + 0.06 * values.largest();
    one.lines = std::move(lines);
    figure.panels.push_back(std::move(one));
  };
  add("velocity", "m/s", extent(record.velocity),
      {{.table = "run.csv", .y = {3}, .title = "string"},
       {.table = "run.csv", .y = {2}, .look = {.style = 1}, .title = "bow"}});
  Extent friction;
  for (std::size_t i = from; i < to; ++i) friction.include(record.friction[i] / record.normal_load[i]);
  add("friction over load", "1", friction, {{.table = "run.csv", .y = {5, 6}}});
  const auto states = oscillators::BowContacts::state_names(*task.model.law);
  if (!states.empty() && states.front().name == "temperature_rise")
    add("temperature rise", "K", extent(record.states.front()), {{.table = "run.csv", .y = {9}}});
  add("bridge force", "N", extent(record.bridge_force), {{.table = "run.csv", .y = {7}}});
  if (task.sound)
    add("sound", task.sound->unit.c_str(), extent(record.heard),
        {{.table = "run.csv", .y = {int(9 + states.size() + 2 * record.contact_velocity.size())}}});
  auto files = write(folder, figure);

  // Friction against slip rate over the last periods, and the steady curve.
  constexpr double orbit = 8;
  const double begin = record.time.back() - orbit * period;
  double slipping = 1e-3;
  for (std::size_t i = 0; i < record.time.size(); ++i)
    if (record.time[i] >= begin) slipping = std::max(slipping, std::abs(record.slip_rate[i]));
  FigureTable steady{"run-steady.csv", {{"slip_rate (m/s)", {}}, {"friction_coefficient", {}}}};
  constexpr int points = 200;
  const double N = std::max(record.normal_load.back(), 1e-9);
  for (int i = 0; i <= points; ++i) {
    const double v = std::max(1e-4, slipping * i / points);
    steady.columns[0].values.push_back(v);
    steady.columns[1].values.push_back(task.model.law->steady_friction({v, N}).friction);
  }
  auto plane = figure_of(scene, "run-friction", "Friction against slip rate under the bow");
  plane.width = 640, plane.height = 380;
  Panel loop{.x = axis_of("slip_rate", "m/s"), .y = {.name = "friction over load μ", .from = 0, .after = 0.12}};
  loop.lines = {{.table = steady.file, .look = {.style = 1}, .title = "steady sliding"},
                {.table = "run.csv",
                 .x = {4},
                 .y = {5, 6},
                 .how = How::line_and_points,
                 .look = {.width = 0.7, .size = 0.25},
                 .title = fmt::format("in slip, last {:g} periods", orbit),
                 .where = {{1, '>', begin}, {8, '<', 0.5}}}};
  plane.panels = {std::move(loop)};
  plane.tables = {std::move(steady)};
  for (auto& file : write(folder, plane)) files.push_back(std::move(file));
  return files;
}

std::vector<std::string> write_string_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                              std::span<const Pixel> pixels) {
  const auto& task = *scene.string;
  auto table = table_of_cells(scene, "map.csv");
  std::vector<double> lengths, regimes, reproducible;
  for (const auto& pixel : pixels) {
    lengths.push_back(pixel.bowing.transient.length);
    regimes.push_back(double(pixel.bowing.transient.regime));
    reproducible.push_back(pixel.reproducible ? 1.0 : 0.0);
  }
  table.columns.push_back({"transient_length", lengths});
  table.columns.push_back({"regime", regimes});
  table.columns.push_back({"reproducible", reproducible});
  const auto figure_named = [&](const char* name, const char* what) {
    auto figure = figure_of(scene, name, what, {task.x.parameter, task.y.parameter});
    figure.width = 760, figure.key = Key::below;
    return figure;
  };
  auto figure = figure_named("map", "Length of the transient of a bowed string"),
       motions = figure_named("map-regime", "Motion that a bowed string ends in");
  Panel of_lengths{.x = named(scene, task.x), .y = named(scene, task.y), .grid = false}, of_regimes = of_lengths;
  const double most = task.options.transient.most;
  of_lengths.colours = ColourScale{
      {.name = fmt::format("transient (periods); black: none within {}", most), .from = 0, .to = most}, Palette::grey};
  const Line cells{.table = "map.csv", .how = How::cells, .z = {7}, .corners = 3};
  of_lengths.lines = {cells};
  constexpr std::size_t most_marks = 4000;
  if (!task.plane.finer.empty() && pixels.size() <= most_marks && std::ranges::count(reproducible, 0.0) > 0)
    of_lengths.lines.push_back({.table = "map.csv",
                                .how = How::points,
                                .look = {.colour = "#E69F00", .width = 1.5, .point = Point::cross, .size = 0.45},
                                .title = "other at a finer sample rate",
                                .where = {{9, '<', 0.5}}});
  static constexpr std::pair<const char*, const char*> regimes_of[] = {
      {"no slip", "#FFFFFF"},   {"Helmholtz", "#F0E442"}, {"two slips a period", "#56B4E9"},
      {"irregular", "#CC79A7"}, {"raucous", "#555555"},   {"sliding", "#009E73"}};
  for (std::size_t k = 0; k < std::size(regimes_of); ++k) {
    if (std::ranges::count(regimes, double(k)) == 0) continue;
    auto line = cells;
    line.z = {}, line.where = {{8, '=', double(k)}};
    line.title = regimes_of[k].first, line.look.colour = regimes_of[k].second;
    of_regimes.lines.push_back(std::move(line));
  }
  FigureTable limits{"map-limits.csv", {{"x", {}}, {"y", {}}, {"limit", {}}}};
  double number = 0;
  for (const auto& [title, x, y] : limits_of(scene)) {
    const Line line{.table = limits.file,
                    .look = {.colour = number == 0 ? "#0072B2" : "#D55E00",
                             .dash = number == 0 ? "solid" : "8,4",
                             .width = 1.8,
                             .halo = true},
                    .title = title,
                    .where = {{3, '=', number}}};
    of_lengths.lines.push_back(line), of_regimes.lines.push_back(line);
    for (std::size_t i = 0; i < x.size(); ++i)
      limits.columns[0].values.push_back(x[i]), limits.columns[1].values.push_back(y[i]),
          limits.columns[2].values.push_back(number);
    ++number;
  }
  figure.panels = {std::move(of_lengths)}, motions.panels = {std::move(of_regimes)};
  figure.tables = {std::move(table), std::move(limits)};
  auto files = write(folder, figure);
  for (auto& file : write(folder, motions)) files.push_back(std::move(file));
  return files;
}

std::vector<std::string> write_string_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                              const std::vector<std::vector<Pixel>>& planes,
                                              const std::vector<double>& separation) {
  const auto& task = *scene.string;
  auto table = table_of_cells(scene, "compare.csv");
  std::vector<std::string> varied = {task.x.parameter, task.y.parameter};
  if (std::ranges::any_of(task.members, [&](const auto& member) { return member.family != task.members[0].family; }))
    varied.emplace_back("law");
  auto figure = figure_of(scene, "compare", "Transients of bowed strings side by side", varied);
  const double most = task.options.transient.most;
  const auto add = [&](std::string title, ColourScale colours) {
    const auto &x = named(scene, task.x), &y = named(scene, task.y);
    Panel panel{.x = x, .y = y, .title = std::move(title), .colours = std::move(colours), .grid = false};
    // What hangs on the sample rate shows the ground.
    panel.shades = {{'x', x.from, x.to, "#E69F00", "not reproducible"}};
    panel.lines = {{.table = table.file, .how = How::cells, .z = {int(table.columns.size())}, .corners = 3}};
    figure.panels.push_back(std::move(panel));
  };
  for (std::size_t k = 0; k < planes.size(); ++k) {
    std::vector<double> lengths;
    for (const auto& pixel : planes[k]) lengths.push_back(pixel.reproducible ? pixel.bowing.transient.length : NAN);
    table.columns.push_back({"transient_length of " + task.members[k].name, std::move(lengths)});
    add(task.members[k].name, {{.name = "transient (periods)", .from = 0, .to = most}, Palette::grey});
  }
  table.columns.push_back({"separation", separation});
  add("least difference", {{.name = "difference (periods)", .from = 0}, Palette::blue});
  figure.columns = int(figure.panels.size());
  figure.width = 430 * figure.columns, figure.height = 270, figure.key = Key::below;
  figure.tables = {std::move(table)};
  return write(folder, figure);
}

}  // namespace rosin::app::output
