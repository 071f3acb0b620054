/// Pictures of curves, motions, cycles, experiments and comparisons.
#include "app/output/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "analysis/branches/branches.hpp"
#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/steady/mode_windows.hpp"
#include "app/output/comparison.hpp"
#include "app/output/curve.hpp"
#include "app/output/figure.hpp"
#include "app/output/scene_figure.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/tasks/branch.hpp"
#include "app/tasks/compare.hpp"
#include "app/tasks/stability.hpp"

namespace rosin::app::output {

namespace fs = std::filesystem;
using namespace results;

namespace {

constexpr double row_height = 140;  ///< of panels below each other, in pixels
constexpr std::size_t most_panels = 12;

/// Velocities, accelerations and forces show little beside places and slip rates.
bool tells_little(const std::string& name) {
  return name.find("velocity") != std::string::npos || name.find("acceleration") != std::string::npos ||
         name.starts_with("friction_force");
}

std::size_t index_of(const std::vector<std::string>& names, const std::string& name) {
  return std::size_t(std::ranges::find(names, name) - names.begin());
}

}  // namespace

std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene, const Curve& curve) {
  auto figure = figure_of(scene, "curve", "The steady friction curve with its extrema");
  figure.width = 720, figure.height = 370;
  Panel panel{.x = axis_of("slip_rate", "m/s"), .y = axis_of("friction_coefficient", "1")};
  panel.x.decades = true;
  panel.y.name = "steady friction coefficient";
  panel.y.before = panel.y.after = 0.12;
  panel.lines = {{.table = "curve.csv"}};
  for (const auto& e : curve.extrema)
    panel.marks.push_back({e.slip_rate,
                           e.friction_coefficient,
                           fmt::format("{:.3g} m/s", e.slip_rate),
                           e.maximum ? Side::above : Side::below,
                           {.style = 1, .point = e.maximum ? Point::up : Point::down, .size = 1.4},
                           true,
                           e.maximum ? "maximum" : "minimum"});
  figure.panels = {std::move(panel)};
  return write(folder, figure);
}

namespace {

/// Number of the contact in "slip_rate_2"; 0 for what is no contact's.
int contact_of_column(const std::string& name) {
  const auto bar = name.rfind('_');
  if (bar == std::string::npos || name.find("displacement") != std::string::npos) return 0;
  const bool is_number = bar + 1 < name.size() && std::all_of(name.begin() + long(bar) + 1, name.end(),
                                                              [](unsigned char c) { return std::isdigit(c) != 0; });
  return is_number ? std::stoi(name.substr(bar + 1)) : 0;
}

/// Whether an event says that the one contact sticks from then on, or slips: at a stop an impact tears it off, and rest
/// and leave are its own where the surface rests.
bool tells_stick(const scene::Scene& scene, const analysis::motion::RunEvent& event) {
  if (event.coordinate == 0) return true;
  const auto& contact = scene.structure->structure.contacts.front();
  if (contact.tangential[event.coordinate - 1] == 0) return false;
  return event.kind == "impact" ||
         ((event.kind == "rest" || event.kind == "leave") && contact.speed.constant() && contact.speed.level() == 0);
}
bool starts_stuck(const analysis::motion::Run& run) {
  const auto slip = index_of(run.column_names, "slip_rate");
  return slip < run.columns.size() && run.columns[slip].front() == 0;
}

/// Stick or slip over time; what the motion began with follows from its first event.
FigureTable strip_of(const scene::Scene& scene, const analysis::motion::Run& run) {
  std::vector<double> time, sticks;
  const auto add = [&](double t, bool stick) { time.push_back(t), sticks.push_back(stick ? 1 : 0); };
  const auto stays = [&](const auto& event) { return event.kind == "reversal" || !tells_stick(scene, event); };
  const auto first = std::ranges::find_if_not(run.events, stays);
  bool stick = first == run.events.end() ? run.metrics.at("stick_time") > 0
               : first->coordinate > 0   ? starts_stuck(run)
                                         : first->kind == "slip";
  add(run.time.front(), stick);
  for (const auto& event : run.events)
    if (!stays(event)) add(event.time, stick = event.kind == "stick" || event.kind == "rest");
  add(run.time.back(), stick);
  return {"run-strip.csv", {{"time (s)", time}, {"stick", sticks}}};
}

FigureTable events_of(const analysis::motion::Run& run) {
  FigureTable table{"run-events.csv", {{"time (s)", {}}, {"kind", {}}, {"contact", {}}}};
  for (const auto& event : run.events) {
    table.columns[0].values.push_back(event.time);
    table.columns[1].texts.push_back(event.kind);
    table.columns[2].values.push_back(event.contact);
  }
  return table;
}

/// Columns that have something to show: what never changes has not, but for the slip rate, beside which the drive
/// stands.
std::vector<std::size_t> shown_columns(const scene::Scene& scene, const analysis::motion::Run& run) {
  // The load of a single contact that gives way.
  const bool load_tells = scene.structure && scene.structure->structure.contacts.size() == 1 &&
                          scene.structure->structure.contacts[0].normal.size() > 0;
  std::vector<std::size_t> shown;
  for (std::size_t c = 0; c < run.columns.size() && shown.size() < most_panels; ++c) {
    const auto& name = run.column_names[c];
    const auto [low, high] = std::ranges::minmax(run.columns[c]);
    if (!tells_little(name) && (!name.starts_with("normal_load") || load_tells) &&
        (low < high || name.starts_with("slip_rate")))
      shown.push_back(c);
  }
  if (shown.empty()) shown.push_back(0);
  return shown;
}

/// Lines at events, of a contact where there are several; so many that they would hide the curve are left out.
std::vector<Line> lines_at_events(const analysis::motion::Run& run, int contact) {
  constexpr std::size_t most_lines = 200;
  struct Kind {
    const char *name, *dash, *colour;
  };
  static constexpr Kind kinds[] = {
      {"stick", "solid", "#888888"}, {"slip", "6,4", "#B0560F"}, {"reversal", "2,3", "#000000"}};
  std::vector<Line> lines;
  for (const auto& [name, dash, colour] : kinds)
    if (run.events.size() <= most_lines &&
        std::ranges::any_of(run.events, [&](const auto& event) { return event.kind == name; }))
      lines.push_back({.table = "run-events.csv",
                       .how = How::upright,
                       .look = {.colour = colour, .dash = dash, .width = 0.8},
                       .title = name,
                       .where = {{2, '=', 0, name}, {3, '=', double(contact)}}});
  return lines;
}

/// The path in the plane, with its stops.
Figure path_of(const scene::Scene& scene, const analysis::motion::Run& run) {
  auto figure = figure_of(scene, "run-path", "The path in the plane, with its stops");
  figure.width = 640, figure.height = 480;
  FigureTable stops{"run-stops.csv", {{"x (m)", {}}, {"y (m)", {}}}};
  for (const auto& event : run.events)
    if (event.kind == "stick")
      stops.columns[0].values.push_back(event.displacement), stops.columns[1].values.push_back(event.displacement_y);
  auto all = Extent::of(run.columns[0]);
  for (const double y : run.columns[1]) all.include(y);
  Panel panel{.x = {.name = "x", .unit = "m", .shown = all},
              .y = {.name = "y", .unit = "m", .shown = all, .before = 0, .after = 0}};
  panel.lines = {{.table = "run.csv", .x = {2}, .y = {3}}};
  if (!stops.columns[0].values.empty())
    panel.lines.push_back(
        {.table = "run-stops.csv", .how = How::points, .look = {.style = 1, .size = 0.8}, .title = "stick"});
  figure.tables = {std::move(stops)};
  figure.panels = {std::move(panel)};
  return figure;
}

/// The path inside the ring of a contact, and the circle on which it touches.
Figure path_in_ring(const scene::Scene& scene, const analysis::motion::Run& run, std::size_t contact) {
  const auto& of = scene.structure->structure.contacts[contact];
  const std::string name = fmt::format("run-path-{}", contact + 1);
  auto figure = figure_of(scene, name, fmt::format("The path inside the ring of contact {}", contact + 1));
  figure.width = 640, figure.height = 480;
  std::vector<double> x, y, circle_x, circle_y;
  Extent all;
  for (std::size_t i = 0; i < run.time.size(); ++i) {
    double along_normal = 0, along_tangent = 0;
    for (Eigen::Index k = 0; k < of.tangential.size(); ++k) {
      const double q = run.columns[std::size_t(k)][i];
      along_normal += of.normal(k, 0) * q, along_tangent += of.tangential[k] * q;
    }
    x.push_back(along_normal), y.push_back(along_tangent);
    all.include(x.back()), all.include(y.back());
  }
  constexpr int parts = 120;
  for (int i = 0; i <= parts; ++i) {
    const double angle = 2 * std::numbers::pi * i / parts;
    circle_x.push_back(of.ring->centre[0] + of.gap[0] * std::cos(angle));
    circle_y.push_back(of.ring->centre[1] + of.gap[0] * std::sin(angle));
    all.include(circle_x.back()), all.include(circle_y.back());
  }
  figure.tables = {{name + ".csv", {{"x (m)", x}, {"y (m)", y}}},
                   {name + "-ring.csv", {{"x (m)", circle_x}, {"y (m)", circle_y}}}};
  figure.panels = {{.x = {.name = "along the normal", .unit = "m", .shown = all},
                    .y = {.name = "along the tangent", .unit = "m", .shown = all, .before = 0, .after = 0},
                    .lines = {{.table = name + ".csv", .title = "path"},
                              {.table = name + "-ring.csv", .look = {.style = reference_style}, .title = "touches"}}}};
  return figure;
}

}  // namespace

/// Every column that tells against time, with the events, the drive, and a strip of stick and slip.
std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::motion::Run& run) {
  auto figure = figure_of(scene, "run", "Every column of a run against time, with its events");
  figure.height = row_height;
  figure.tables = {events_of(run)};
  auto time = axis_of("time", "s");
  if (run.time.size() > 1) time.from = run.time.front(), time.to = run.time.back();
  // What the slider is driven by: its speed beside the slip rate, and a load that changes in a panel of its own.
  const bool driven = !scene.plane && !scene.structure && run.time.size() > 1;
  const auto& drive = scene.model.drive;
  std::vector<double> speed, load;
  for (const double t : driven ? run.time : std::vector<double>())
    speed.push_back(drive.speed.value(t)), load.push_back(drive.normal_load.value(t));
  if (driven)
    figure.tables.push_back(
        {"run-drive.csv", {{"time (s)", run.time}, {"drive_speed (m/s)", speed}, {"normal_load (N)", load}}});
  // Where there are several contacts, each panel of a contact has its own events.
  const bool several = std::ranges::any_of(run.events, [](const auto& event) { return event.contact > 0; });
  for (const auto c : shown_columns(scene, run)) {
    const auto& name = run.column_names[c];
    Panel panel{.x = time, .y = axis_of(name, run.column_units[c], Extent::of(run.columns[c]))};
    // A coefficient that begins near 0 has its decades there alone.
    panel.y.decades = !name.starts_with("friction_coefficient") && panel.y.shown.spans_decades();
    panel.lines = {{.table = "run.csv", .y = {int(c) + 2}}};
    if (driven && name == "slip_rate")
      panel.lines.push_back({.table = "run-drive.csv", .look = {.style = reference_style}, .title = "drive speed"});
    const int contact = several ? contact_of_column(name) : 0;
    if (!several || contact > 0)
      for (auto& line : lines_at_events(run, contact)) panel.lines.push_back(std::move(line));
    figure.panels.push_back(std::move(panel));
  }
  if (driven && !drive.normal_load.constant())
    figure.panels.push_back({.x = time,
                             .y = axis_of("normal_load", "N", Extent::of(load)),
                             .lines = {{.table = "run-drive.csv", .y = {3}}}});
  if (run.metrics.contains("stick_time") && run.time.size() > 1) {
    figure.tables.push_back(strip_of(scene, run));
    figure.panels.push_back({.x = time,
                             .y = {.from = -0.2, .to = 1.2, .ticks = {{0, "slip"}, {1, "stick"}}},
                             .lines = {{.table = "run-strip.csv", .how = How::steps}}});
  }
  auto files = write(folder, figure);
  if (scene.plane)
    for (auto& file : write(folder, path_of(scene, run))) files.push_back(std::move(file));
  if (scene.structure)
    for (std::size_t j = 0; j < scene.structure->structure.contacts.size(); ++j)
      if (scene.structure->structure.contacts[j].ring)
        for (auto& file : write(folder, path_in_ring(scene, run, j))) files.push_back(std::move(file));
  return files;
}

/// Frequencies and growth rates of all modes along the parameter, with the thresholds.
std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::steady::Scan& scan) {
  const auto& [parameter, axis] = *scene.task<tasks::Stability>().scan;
  std::size_t modes = 0;
  for (const auto& values : scan.eigenvalues) modes = std::max(modes, values.size());
  FigureTable table{"stability.csv", {column_of(parameter.name, parameter.unit, scan.values)}};
  // Frequencies and growth rates near the thresholds, which those of far faster modes would press into a line.
  Extent near, growth, any_growth, frequencies;
  const auto is_near = [&](double frequency) {
    constexpr double beside = 1.25;
    return std::ranges::any_of(scan.thresholds, [&](const auto& threshold) {
      const double ratio = frequency * 2 * std::numbers::pi / threshold.angular_frequency;
      return ratio < beside && ratio * beside > 1;
    });
  };
  for (std::size_t b = 0; b < modes; ++b) {
    std::vector<double> frequency, rate;
    for (const auto& values : scan.eigenvalues) {
      const bool there = b < values.size() && values[b].imag() >= 0;
      frequency.push_back(there ? values[b].imag() / (2 * std::numbers::pi) : NAN);
      rate.push_back(there ? values[b].real() : NAN);
      frequencies.include(frequency.back()), any_growth.include(rate.back());
      if (there && is_near(frequency.back())) near.include(frequency.back()), growth.include(rate.back());
    }
    table.columns.push_back({fmt::format("frequency_{} (Hz)", b + 1), std::move(frequency)});
    table.columns.push_back({fmt::format("growth_rate_{} (1/s)", b + 1), std::move(rate)});
  }
  auto figure =
      figure_of(scene, "stability", "Frequencies and growth rates of the modes along a parameter", {parameter.name});
  figure.height = 235;
  Panel above{.x = axis_of(parameter.name, parameter, axis.logarithmic)};
  above.x.from = scan.values.front(), above.x.to = scan.values.back();
  // Steady sliding is unstable from each onset to the next end.
  double from = scan.values.front();
  const auto shade = [&](double to) { above.shades.push_back({'x', from, to, "#F7E9DC"}); };
  for (const auto& threshold : scan.thresholds)
    if (threshold.onset)
      from = threshold.value;
    else
      shade(threshold.value);
  if (!scan.thresholds.empty() && scan.thresholds.back().onset) shade(scan.values.back());
  for (const auto& window : scan.windows)
    for (const auto* edge : {&window.onset, &window.end})
      if (*edge)
        above.rules.push_back({'x',
                               (*edge)->value,
                               {.colour = "#888888", .dash = (*edge)->onset ? "6,4" : "2,3", .width = 1},
                               "threshold, unstable where shaded"});
  auto below = above;
  above.y = {.name = "frequency", .unit = "Hz", .before = 0};
  below.y = {.name = "growth rate", .unit = "1/s", .zero = true};
  for (std::size_t b = 0; b < modes; ++b)
    for (auto* panel : {&above, &below})
      panel->lines.push_back({.table = "stability.csv",
                              .y = {int(2 * b) + (panel == &above ? 2 : 3)},
                              .how = How::points,
                              .look = {.size = 0.35}});
  constexpr double pressed = 20;
  const double spread = near.high - near.low;
  if (spread > 0 && (frequencies.high > pressed * spread ||
                     any_growth.high - any_growth.low > pressed * (growth.high - growth.low))) {
    figure.caption += "; shown are modes near the threshold alone";
    for (const auto& [panel, range] : {std::pair{&above, near}, {&below, growth}}) {
      const double room = 0.06 * (range.high - range.low);
      panel->y.from = range.low - room, panel->y.to = range.high + room;
    }
  }
  figure.tables = {std::move(table)};
  figure.panels = {std::move(above), std::move(below)};
  return write(folder, figure);
}

/// The fastest slip of each motion and the period of cycles, stable ones as lines and unstable ones dashed.
std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::branches::Branches& found) {
  const auto& parameter = scene.task<tasks::Branch>().parameter;
  const auto& options = scene.task<tasks::Branch>().options;
  Extent rates, periods;
  for (const auto& at : found.steady)
    if (at.why.empty()) rates.include(std::abs(at.slip_rates.front()));
  std::string metric = "slip_rate_max";
  std::vector<std::string> names;
  for (const auto& cycle : found.cycles)
    for (const auto& at : cycle.branch.points) {
      if (at.view.metrics.contains("slip_rate_1_max")) metric = "slip_rate_1_max";
      if (names.empty())
        for (const auto& [name, value] : at.view.metrics)
          if (name != metric) names.push_back(name);
      rates.include(at.view.metrics.at(metric));
      periods.include(at.view.metrics.at("period"));
    }
  auto figure = figure_of(scene, "branch", "Steady sliding and cycles along a parameter", {parameter.name});
  figure.height = 240;
  Panel above{.x = axis_of(parameter.name, parameter, options.parameter.logarithmic)};
  std::tie(above.x.from, above.x.to) = std::minmax(options.parameter.from, options.parameter.to);
  const auto mark = [&](double value, const char* dash, const char* title) {
    above.rules.push_back({'x', value, {.colour = "#888888", .dash = dash, .width = 1}, title});
  };
  for (const auto& crossing : found.crossings) mark(crossing.value, "6,4", "Hopf point");
  for (const auto& cycle : found.cycles)
    for (const auto& special : cycle.branch.special) mark(special.p, "2,3", "fold, torus, grazing");
  auto below = above;
  above.y = {.name = "largest slip rate", .unit = "m/s", .shown = rates};
  below.y = {.name = "period", .unit = "s", .shown = periods};
  const int period = int(index_of(names, "period")) + 6, small_cycles = int(names.size()) + 6;
  const auto add = [&](Panel& panel, int column, int branch, int stable, Look look, std::string title) {
    if (stable == 0) look.dash = "6,4";
    panel.lines.push_back({.table = "branch.csv",
                           .x = {2},
                           .y = {column},
                           .look = look,
                           .title = std::move(title),
                           .where = {{1, '=', double(branch)}, {3, '=', double(stable)}}});
  };
  const Look grey{.colour = "#444444", .dash = "solid", .width = 1.5};
  if (!found.steady.empty()) add(above, 4, -1, 1, grey, "steady sliding"), add(above, 4, -1, 0, grey, "");
  for (std::size_t b = 0; b < found.cycles.size(); ++b) {
    const Look look{.style = style_of(b % 4), .dash = "solid", .width = 2};
    const bool doubled = found.cycles[b].from == "period-doubling";
    for (auto* panel : {&above, &below}) {
      const int column = panel == &above ? 4 : period;
      add(*panel, column, int(b), 1, look, b == 0 ? "cycles, stable" : doubled ? "doubled" : "");
      add(*panel, column, int(b), 0, look, b == 0 ? "unstable" : "");
    }
  }
  for (std::size_t b = 0; b < found.cycles.size(); ++b)
    if (small_cycles_of(found, found.cycles[b]))
      above.lines.push_back({.table = "branch.csv",
                             .x = {2},
                             .y = {small_cycles},
                             .look = {.colour = "#C0392B", .dash = "solid", .width = 1},
                             .title = "weakly nonlinear",
                             .where = {{1, '=', double(b)}}});
  figure.panels = {std::move(above)};
  if (!found.cycles.empty()) figure.panels.push_back(std::move(below));
  return write(folder, figure);
}

namespace {

/// An oscillator that is followed by steps: for each coordinate a row, in time and against its velocity.
void add_coordinates(Figure& figure, const analysis::motion::SteppedOscillator& oscillator,
                     const analysis::cycles::StructureCycle& cycle, const Axis& time) {
  const auto axis = [&](std::size_t c) {
    return axis_of(cycle.column_names[c], cycle.column_units[c], Extent::of(cycle.columns[c]));
  };
  const std::size_t rows = std::size_t(oscillator.coordinates);
  figure.height = 205;
  for (std::size_t i = 0; i < rows; ++i) {
    const int place = int(i) + 2, velocity = int(rows + i) + 2;
    figure.panels.push_back({.x = time, .y = axis(i), .lines = {{.table = "cycle.csv", .y = {place}}}});
    figure.panels.push_back(
        {.x = axis(i), .y = axis(rows + i), .lines = {{.table = "cycle.csv", .x = {place}, .y = {velocity}}}});
  }
}

/// The steady curve over the slip rates of a cycle, for comparison.
FigureTable steady_beside(const oscillators::Model& model, double low, double high) {
  constexpr std::size_t points = 400;
  const double speed = model.drive.speed.level(), load = model.drive.normal_load.level();
  const double sign = speed < 0 ? -1 : 1, fastest = sign > 0 ? high : -low;
  const double slowest = std::max(sign > 0 ? low : -high, 1e-6 * fastest);
  std::vector<double> rates(points), steady(points);
  for (std::size_t i = 0; i < points; ++i) {
    const double v = slowest * std::pow(fastest / slowest, double(i) / (points - 1));
    rates[i] = sign * v;
    steady[i] = sign * model.law->steady_friction({v, load}).friction;
  }
  return {"cycle-steady.csv", {{"slip_rate (m/s)", rates}, {"friction_coefficient", steady}}};
}

/// A slider: in time, against slip rate beside steady sliding, and in the phase plane.
void add_slider(Figure& figure, const oscillators::Model& model, const analysis::cycles::StructureCycle& cycle,
                const Axis& time) {
  const auto value = [&](const char* metric) { return cycle.metrics.at(metric).value; };
  const double low = value("slip_rate_min"), high = value("slip_rate_max"), period = value("period");
  figure.height = 270;
  figure.tables = {steady_beside(model, low, high)};
  auto rate = axis_of("slip_rate", "m/s", {low, high}), linear_rate = rate, size = rate;
  rate.decades = rate.shown.spans_decades();
  size.name = "size of slip rate", size.symbol = "|v|", size.decades = true;
  const auto way = axis_of("displacement", "m", Extent::of(cycle.columns[0])),
             friction = axis_of("friction_coefficient", "1");
  const Rule drive{'y', model.drive.speed.level(), {.style = reference_style}, "drive"};
  const auto beside_steady = [](bool absolute) {
    return std::vector<Line>{
        {.table = "cycle.csv", .x = {4, 0, absolute}, .y = {6}, .title = "cycle"},
        {.table = "cycle-steady.csv", .x = {1, 0, absolute}, .look = {.style = 1}, .title = "steady sliding"}};
  };
  auto two = time;
  two.to = 2 * period, two.shown = {0, 2 * period};
  figure.panels = {
      {.x = two,
       .y = rate,
       .lines = {{.table = "cycle.csv", .y = {4}},
                 {.table = "cycle.csv", .x = {.column = 1, .plus = period}, .y = {4}}},
       .rules = {drive}},
      {.x = linear_rate, .y = friction, .lines = beside_steady(false)},
      {.x = way, .y = rate, .lines = {{.table = "cycle.csv", .x = {2}, .y = {4}, .title = "cycle"}}, .rules = {drive}},
      {.x = size, .y = friction, .lines = beside_steady(true)}};
  if (!model.law->has_states() || !(model.lambda > 0)) return;
  // A law with memory moves in three dimensions: a panel more.
  const auto& state = model.law->states().front();
  auto level = Extent::of(cycle.columns[5]);
  if (level.largest() < 1) level = {};
  auto short_rate = rate;
  short_rate.name = "";
  figure.panels.push_back({.x = way,
                           .y = short_rate,
                           .lines = {{.table = "cycle.csv", .x = {2}, .y = {4}, .z = {7}}},
                           .z = axis_of(state.name, state.unit, level)});
}

/// For each contact a row: slip rate in time, and the plane of its coordinate and velocity, with stick marked. Where
/// its load follows motion, a second row: friction and load in time, and against each other.
void add_contacts(Figure& figure, const oscillators::Structure& structure,
                  const analysis::cycles::StructureCycle& cycle, const Axis& time) {
  constexpr std::size_t most_rows = 5;
  const std::size_t contacts = structure.contacts.size();
  figure.height = 205;
  const auto column = [&](const std::string& name) { return index_of(cycle.column_names, name); };
  const auto axis = [&](std::size_t c) {
    return axis_of(cycle.column_names[c], cycle.column_units[c], Extent::of(cycle.columns[c]));
  };
  const auto number = [](std::size_t c) { return Cell{int(c) + 2}; };
  for (std::size_t j = 0; j < contacts; ++j) {
    const auto& contact = structure.contacts[j];
    const bool shows_forces = contact.normal.size() > 0 && !contact.frictionless();
    if (figure.panels.size() / 2 + (shows_forces ? 2 : 1) > most_rows) break;
    const auto of_contact = [&](const char* name) {
      return column(contacts > 1 ? fmt::format("{}_{}", name, j + 1) : name);
    };
    // The translation that the contact's direction is most along.
    const Eigen::VectorXd direction = contact.frictionless() ? contact.normal.col(0) : contact.tangential;
    int i = 0;
    for (int k = 0; k < structure.size(); ++k)
      if (structure.unit(k) == "m" && std::abs(direction[k]) > (structure.unit(i) == "m" ? std::abs(direction[i]) : 0))
        i = k;
    const std::size_t place = std::size_t(i), speed = column(cycle.column_names[structure.names.size() + place]),
                      slip = of_contact(contact.frictionless() ? "normal_load" : "slip_rate");
    const bool sticks =
        !contact.frictionless() && std::ranges::any_of(cycle.columns[slip], [](double u) { return u == 0; });
    // A curve, and where it sticks, over it.
    const auto add = [&](Axis x, Axis y, std::vector<std::tuple<Cell, Cell, std::string>> curves) {
      Panel panel{.x = std::move(x), .y = std::move(y)};
      for (std::size_t k = 0; k < curves.size(); ++k) {
        const auto& [over, of, title] = curves[k];
        panel.lines.push_back(
            {.table = "cycle.csv", .x = over, .y = of, .look = {.style = style_of(k)}, .title = title});
        if (sticks && k + 1 == curves.size())
          panel.lines.push_back({.table = "cycle.csv",
                                 .x = over,
                                 .y = of,
                                 .look = {.style = 1, .dash = "solid", .width = 5},
                                 .title = "stick",
                                 .where = {{int(slip) + 2, '=', 0}}});
      }
      figure.panels.push_back(std::move(panel));
    };
    add(time, axis(slip), {{Cell{1}, number(slip), ""}});
    add(axis(place), axis(speed), {{number(place), number(speed), ""}});
    if (!shows_forces) continue;
    const std::size_t friction = of_contact("friction_force"), load = of_contact("normal_load");
    auto force = axis(load), loads = force, frictions = axis(friction);
    force.name = "force", loads.name = "load", frictions.name = "friction";
    for (const double F : cycle.columns[friction]) force.shown.include(F);
    add(time, force, {{Cell{1}, number(load), "load"}, {Cell{1}, number(friction), "friction"}});
    add(loads, frictions, {{number(load), number(friction), ""}});
  }
}

}  // namespace

std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::cycles::StructureCycle& cycle) {
  auto figure = figure_of(scene, "cycle", "One periodic motion: in time, and in the phase plane");
  figure.width = 940, figure.columns = 2, figure.key = Key::own;
  auto time = axis_of("time", "s", {0, cycle.metrics.at("period").value});
  time.from = 0, time.to = time.shown.high;
  if (const auto* stepped = scene::stepped_of(scene))
    add_coordinates(figure, *stepped, cycle, time);
  else if (scene.structure)
    add_contacts(figure, scene.structure->structure, cycle, time);
  else
    add_slider(figure, scene.model, cycle, time);
  return write(folder, figure);
}

std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const Comparison& comparison) {
  auto& compare = scene.task<tasks::Compare>();
  const auto& members = compare.members;
  const auto& names = comparison.column_names;
  std::vector<std::string> varied;  // the caption tells what members have in common
  const auto law_of = [](const auto& member) { return member.scene.model.law->card().name; };
  if (std::ranges::any_of(members, [&](const auto& member) { return law_of(member) != law_of(members.front()); }))
    varied.emplace_back("law");
  auto figure = figure_of(scene, "compare", "Members of a comparison, one over the other", varied);
  std::vector<Extent> extents(names.size());
  for (std::size_t k = 0; k < comparison.series.size(); ++k) {
    const auto& series = comparison.series[k];
    FigureTable table{fmt::format("compare-{}.csv", k + 1),
                      {column_of(comparison.x_name, comparison.x_unit, series.x)}};
    for (std::size_t c = 0; c < series.columns.size(); ++c) {
      table.columns.push_back(column_of(names[c], comparison.column_units[c], series.columns[c]));
      for (const double value : series.columns[c]) extents[c].include(value);
    }
    figure.tables.push_back(std::move(table));
  }
  const auto add = [&](Axis x, Cell over, std::size_t c) {
    Panel panel{.x = std::move(x), .y = axis_of(names[c], comparison.column_units[c], extents[c])};
    for (std::size_t k = 0; k < comparison.series.size(); ++k)
      panel.lines.push_back({.table = figure.tables[k].file,
                             .x = over,
                             .y = {int(c) + 2},
                             .look = {.style = style_of(k)},
                             .title = members[k].name});
    figure.panels.push_back(std::move(panel));
  };
  auto x = axis_of(comparison.x_name, comparison.x_unit);
  x.decades = comparison.x_name == "slip_rate" || comparison.x_name == "frequency";
  // Columns that never change have nothing to show.
  const auto changes = [&](std::size_t c) {
    return std::ranges::any_of(comparison.series, [&](const auto& series) {
      return !series.columns[c].empty() && std::ranges::min(series.columns[c]) < std::ranges::max(series.columns[c]);
    });
  };
  for (std::size_t c = 0; c < names.size() && figure.panels.size() < most_panels; ++c)
    if (!tells_little(names[c]) && changes(c)) add(x, {1}, c);
  if (figure.panels.empty()) add(x, {1}, 0);
  figure.height = figure.panels.size() == 1 ? 380 : row_height;
  // Motions are told apart by their loops of friction over slip rate, which stand below.
  const auto rate = index_of(names, "slip_rate"), friction = index_of(names, "friction_coefficient");
  const bool imposed = std::isinf(members.front().scene.model.slider.stiffness);  // the slip rate: loops are one
  if (!imposed && comparison.x_name == "time" && rate < names.size() && friction < names.size()) {
    add(axis_of("slip_rate", "m/s", extents[rate]), {int(rate) + 2}, friction);
    figure.panels.back().height = 290;
  }
  return write(folder, figure);
}

}  // namespace rosin::app::output
