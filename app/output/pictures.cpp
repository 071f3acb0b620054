/// Pictures of curves, motions, cycles, experiments and comparisons.
#include "app/output/pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/branches/branches.hpp"
#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/steady/mode_windows.hpp"
#include "app/output/caption.hpp"
#include "app/output/comparison.hpp"
#include "app/output/curve.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/tasks/branch.hpp"
#include "app/tasks/compare.hpp"
#include "app/tasks/stability.hpp"

namespace rosin::app::output {

namespace fs = std::filesystem;

std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene, const Curve& curve) {
  const Sheet sheet{
      "curve", "The steady friction curve with its extrema", {.width = 720, .panel = 370}, scene.title, caption(scene)};
  std::string script = "set logscale x\nset format x '10^{%T}'\nset xlabel 'slip rate v (m/s)'\n";
  script += "set ylabel 'steady friction coefficient μ'\nset grid\n";
  std::string marks;
  for (const auto& e : curve.extrema)
    marks += fmt::format("{},{},{},{:.3g} m/s\n", e.slip_rate, e.friction_coefficient, e.maximum ? 1 : 2, e.slip_rate);
  if (!marks.empty()) script += "$extrema << EOD\n" + marks + "EOD\n";
  script += "set offsets graph 0, 0, 0.12, 0.12\nplot 'curve.csv' using 1:2 with lines linestyle 1 notitle";
  // Only kinds that occur: gnuplot 5.4 crashes on labels without a point.
  for (const bool maximum : {true, false}) {
    const auto is_kind = [&](const analysis::steady::Extremum& e) { return e.maximum == maximum; };
    if (std::none_of(curve.extrema.begin(), curve.extrema.end(), is_kind)) continue;
    const auto chosen = fmt::format("$extrema using 1:($3=={} ? $2 : NaN)", maximum ? 1 : 2);
    script += fmt::format(", \\\n     {} with points pointtype {} pointsize 1.4 linecolor '#B0560F' title '{}'", chosen,
                          maximum ? 9 : 11, maximum ? "maximum" : "minimum");
    script += fmt::format(", \\\n     {}:4 with labels offset 0,{} notitle", chosen, maximum ? 1.1 : -1.2);
  }
  script += '\n';
  write_whole(folder / "curve.gp", sheet.with(std::move(script)));
  return {"curve.gp"};
}

constexpr int run_panel = 140;  ///< pixels: height of a panel's frame
constexpr std::size_t most_panels = 12;

/// Number of the contact in "slip_rate_2"; 0 for what is no contact's.
int contact_of_column(const std::string& name) {
  const auto bar = name.rfind('_');
  if (bar == std::string::npos || name.find("displacement") != std::string::npos) return 0;
  const bool is_number = bar + 1 < name.size() && std::all_of(name.begin() + long(bar) + 1, name.end(),
                                                              [](unsigned char c) { return std::isdigit(c) != 0; });
  return is_number ? std::stoi(name.substr(bar + 1)) : 0;
}

namespace {
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
  const auto slip = std::ranges::find(run.column_names, "slip_rate");
  return slip != run.column_names.end() && run.columns[std::size_t(slip - run.column_names.begin())].front() == 0;
}
}  // namespace

std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::motion::Run& run) {
  std::vector<std::size_t> shown;
  // The load of a single contact that gives way.
  const bool load_tells = scene.structure && scene.structure->structure.contacts.size() == 1 &&
                          scene.structure->structure.contacts[0].normal.size() > 0;
  const auto is_shown = [&](const std::string& name) {
    return name.find("velocity") == std::string::npos && name.find("acceleration") == std::string::npos &&
           !name.starts_with("friction_force") && (!name.starts_with("normal_load") || load_tells);
  };
  // What never changes has nothing to show, but for the slip rate, beside which the drive stands.
  const auto tells = [&](std::size_t c) {
    const auto [low, high] = std::ranges::minmax(run.columns[c]);
    return low < high || run.column_names[c].starts_with("slip_rate");
  };
  for (std::size_t c = 0; c < run.columns.size() && shown.size() < most_panels; ++c)
    if (is_shown(run.column_names[c]) && tells(c)) shown.push_back(c);
  if (shown.empty()) shown.push_back(0);
  std::string events;
  for (const auto& event : run.events) events += fmt::format("{},{},{}\n", event.time, event.kind, event.contact);
  write_whole(folder / "run-events.csv", "time (s),kind,contact\n" + events);

  const bool strip = run.metrics.contains("stick_time") && run.time.size() > 1;
  if (strip) {  // stick or slip over time; what the motion began with follows from its first event
    std::string steps = "time (s),stick\n";
    const auto stays = [&](const auto& event) { return event.kind == "reversal" || !tells_stick(scene, event); };
    const auto first = std::ranges::find_if_not(run.events, stays);
    const double stuck = run.metrics.at("stick_time");
    bool stick = first == run.events.end() ? stuck > 0
                 : first->coordinate > 0   ? starts_stuck(run)
                                           : first->kind == "slip";
    steps += fmt::format("{},{}\n", run.time.front(), stick ? 1 : 0);
    for (const auto& event : run.events)
      if (!stays(event)) {
        stick = event.kind == "stick" || event.kind == "rest";
        steps += fmt::format("{},{}\n", event.time, stick ? 1 : 0);
      }
    steps += fmt::format("{},{}\n", run.time.back(), stick ? 1 : 0);
    write_whole(folder / "run-strip.csv", steps);
  }
  // What the slider is driven by: its speed beside the slip rate, and a load that changes in a panel of its own.
  const bool driven = !scene.plane && !scene.structure && run.time.size() > 1;
  const auto& drive = scene.model.drive;
  const bool loaded = driven && !drive.normal_load.constant();
  if (driven) {
    std::vector<double> speed, load;
    for (const double t : run.time) speed.push_back(drive.speed.value(t)), load.push_back(drive.normal_load.value(t));
    write_csv(folder / "run-drive.csv",
              {{"time (s)", run.time}, {"drive_speed (m/s)", speed}, {"normal_load (N)", load}});
  }
  const int panels = static_cast<int>(shown.size()) + (strip ? 1 : 0) + (loaded ? 1 : 0);
  constexpr std::size_t most_lines = 200;  // more would hide the curve
  struct Kind {
    const char *name, *dash, *colour;
  };
  std::vector<Kind> kinds = {
      {"stick", "solid", "#888888"}, {"slip", "(6,4)", "#B0560F"}, {"reversal", "(2,3)", "#000000"}};
  std::erase_if(kinds, [&](const Kind& kind) {
    return run.events.size() > most_lines ||
           std::ranges::none_of(run.events, [&](const auto& event) { return event.kind == kind.name; });
  });
  const Sheet sheet{"run",
                    "Every column of a run against time, with its events",
                    {.panels = panels, .panel = run_panel},
                    scene.title,
                    caption(scene)};
  std::string script;
  // The key stands between title and curves: a title may be as wide as the picture.
  script += "set grid x\n";
  if (run.time.size() > 1) script += fmt::format("set xrange [{}:{}]\n", run.time.front(), run.time.back());
  // Where there are several contacts, each panel of a contact has its own events.
  const bool several = std::ranges::any_of(run.events, [](const auto& event) { return event.contact > 0; });
  bool in_key = false;
  for (const auto c : shown) {
    const auto [low, high] = std::ranges::minmax(run.columns[c]);
    // A coefficient that begins near 0 has its decades there alone.
    const bool decades = !run.column_names[c].starts_with("friction_coefficient") && spans_decades(low, high);
    const auto name = readable(run.column_names[c]);
    const auto& unit = run.column_units[c];
    const auto drawn = decades ? DrawnRange{0, 1, label(name, unit), low, high} : drawn_range(name, unit, low, high);
    script += fmt::format("\n{}\nset ylabel {}\n", axis_scale('y', decades), drawn.label);
    script += decades ? "set ytics autofreq\n" : fmt::format("set ytics {:g}\n", tick_step(drawn.low, drawn.high));
    script += decades ? "unset offsets\n" : "set offsets 0, 0, graph 0.05, graph 0.05\n";
    script +=
        c == shown.back() && !strip && !loaded ? "set xlabel 'time (s)'\nset format x '%g'\n" : "set format x ''\n";
    script += fmt::format("plot 'run.csv' using 1:{} with lines linestyle 1 notitle", drawn.column(int(c) + 2));
    if (driven && c == shown.front()) script += ", \\\n     NaN with lines linestyle 3 title 'drive speed'";
    if (driven && run.column_names[c] == "slip_rate")
      script += fmt::format(", \\\n     'run-drive.csv' using 1:{} with lines linestyle 3 notitle", drawn.column(2));
    const int contact = several ? contact_of_column(run.column_names[c]) : 0;
    for (const auto& kind : kinds) {  // a line over the height of the curve
      if (several && contact == 0) continue;
      script += fmt::format(
          ", \\\n     'run-events.csv' using 1:(strcol(2) eq '{}' && $3 == {} ? {} : NaN):(0):({}) with vectors nohead "
          "linecolor '{}' linewidth 0.8 dashtype {} {}",
          kind.name, contact, drawn.low, drawn.high - drawn.low, kind.colour, kind.dash,
          in_key ? "notitle" : fmt::format("title '{}'", kind.name));
    }
    in_key = in_key || !several || contact > 0;
    script += '\n';
  }
  if (loaded) {
    double low = infinity, high = -infinity;
    for (const double t : run.time) {
      low = std::min(low, drive.normal_load.value(t));
      high = std::max(high, drive.normal_load.value(t));
    }
    const auto [factor, unit] = scaled("N", high);
    script += fmt::format("\n{}\nset ylabel {}\nset ytics {:g}\nset offsets 0, 0, graph 0.06, graph 0.06\n",
                          axis_scale('y', false), label(readable("normal_load"), unit),
                          tick_step(low * factor, high * factor));
    script += strip ? "set format x ''\n" : "set xlabel 'time (s)'\nset format x '%g'\n";
    script += fmt::format("plot 'run-drive.csv' using 1:($3*{}) with lines linestyle 1 notitle\n", factor);
  }
  if (strip)
    script +=
        "\nunset logscale y\nunset offsets\nset ylabel ''\nset yrange [-0.2:1.2]\nset ytics ('slip' 0, 'stick' 1)\n"
        "set xlabel 'time (s)'\nset format x '%g'\n"
        "plot 'run-strip.csv' using 1:2 with steps linestyle 1 notitle\n";
  write_whole(folder / "run.gp", sheet.with(std::move(script)));
  std::vector<std::string> files = {"run-events.csv", "run.gp"};
  if (scene.plane) {
    std::string stops = "x (m),y (m)\n";
    for (const auto& event : run.events)
      if (event.kind == "stick") stops += fmt::format("{},{}\n", event.displacement, event.displacement_y);
    write_whole(folder / "run-stops.csv", stops);
    double largest = 0;
    for (const int c : {0, 1})
      for (const double x : run.columns[static_cast<std::size_t>(c)]) largest = std::max(largest, std::abs(x));
    const auto [factor, unit] = scaled("m", largest);
    const Sheet plane{
        "run-path", "The path in the plane, with its stops", {.width = 640, .panel = 480}, scene.title, caption(scene)};
    std::string path = fmt::format("set grid\nset xlabel 'x ({0})'\nset ylabel 'y ({0})'\n", unit);
    path += fmt::format(
        "plot 'run.csv' using ($2*{0}):($3*{0}) with lines linestyle 1 notitle, \\\n     'run-stops.csv' "
        "using ($1*{0}):($2*{0}) with points linestyle 2 pointtype 7 pointsize 0.8 title 'stick'\n",
        factor);
    write_whole(folder / "run-path.gp", plane.with(std::move(path)));
    files.insert(files.end(), {"run-path.gp", "run-stops.csv"});
  }
  if (strip) files.emplace_back("run-strip.csv");
  if (driven) files.emplace_back("run-drive.csv");
  return files;
}

/// Frequencies and growth rates of all modes along the parameter, with the thresholds.
std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::steady::Scan& scan) {
  const auto& [parameter, axis] = *scene.task<tasks::Stability>().scan;
  std::size_t branches = 0;
  for (const auto& values : scan.eigenvalues) branches = std::max(branches, values.size());
  std::vector<std::vector<double>> columns(1 + 2 * branches);
  std::vector<std::string> names = {column_header(parameter.name, parameter.unit)};
  for (std::size_t b = 0; b < branches; ++b) {
    names.push_back(fmt::format("frequency_{} (Hz)", b + 1));
    names.push_back(fmt::format("growth_rate_{} (1/s)", b + 1));
  }
  double fastest = 0;
  // Frequencies and growth rates near the thresholds, which those of far faster modes would press into a line.
  Range near{infinity, -infinity}, growth{infinity, -infinity}, any_growth{infinity, -infinity};
  const auto include = [](Range& range, double x) {
    range.low = std::min(range.low, x), range.high = std::max(range.high, x);
  };
  for (std::size_t i = 0; i < scan.values.size(); ++i) {
    columns[0].push_back(scan.values[i]);
    for (std::size_t b = 0; b < branches; ++b) {
      const bool there = b < scan.eigenvalues[i].size() && scan.eigenvalues[i][b].imag() >= 0;
      const double frequency = there ? scan.eigenvalues[i][b].imag() / (2 * std::numbers::pi) : NAN;
      columns[1 + 2 * b].push_back(frequency);
      columns[2 + 2 * b].push_back(there ? scan.eigenvalues[i][b].real() : NAN);
      if (!there) continue;
      fastest = std::max(fastest, frequency);
      include(any_growth, scan.eigenvalues[i][b].real());
      constexpr double beside = 1.25;  // in frequency
      if (std::ranges::any_of(scan.thresholds, [&](const auto& threshold) {
            const double ratio = frequency * 2 * std::numbers::pi / threshold.angular_frequency;
            return ratio < beside && ratio * beside > 1;
          }))
        include(near, frequency), include(growth, scan.eigenvalues[i][b].real());
    }
  }
  std::vector<Column> table;
  for (std::size_t c = 0; c < columns.size(); ++c) table.push_back({names[c], columns[c]});
  write_csv(folder / "stability.csv", table);
  Sheet sheet{"stability",
              "Frequencies and growth rates of the modes along a parameter",
              {.panels = 2, .panel = 235},
              scene.title,
              caption(scene, {parameter.name})};
  std::string script = "set grid\n";
  script += axis_scale('x', axis.logarithmic) + '\n';
  script += fmt::format("set xrange [{}:{}]\n", scan.values.front(), scan.values.back());
  // Steady sliding is unstable from each onset to the next end.
  double from = scan.values.front();
  const auto shade = [&](double to) {
    script += fmt::format(
        "set object rectangle from {}, graph 0 to {}, graph 1 behind fillcolor '#F7E9DC' fillstyle solid noborder\n",
        from, to);
  };
  for (const auto& threshold : scan.thresholds)
    if (threshold.onset)
      from = threshold.value;
    else
      shade(threshold.value);
  if (!scan.thresholds.empty() && scan.thresholds.back().onset) shade(scan.values.back());
  for (const auto& window : scan.windows)
    for (const auto* edge : {&window.onset, &window.end})
      if (*edge)
        script += fmt::format("set arrow from {0}, graph 0 to {0}, graph 1 nohead linecolor '#888888' dashtype {1}\n",
                              (*edge)->value, (*edge)->onset ? "(6,4)" : "(2,3)");
  constexpr double pressed = 20;
  const double spread = near.high - near.low, growths = growth.high - growth.low;
  const bool near_alone =
      spread > 0 && (fastest > pressed * spread || any_growth.high - any_growth.low > pressed * growths);
  if (near_alone) sheet.caption += "; shown are modes near the threshold alone";
  const auto view = [&](Range range, double factor) {
    const double room = 0.06 * (range.high - range.low);
    return near_alone ? fmt::format("set yrange [{}:{}]\n", (range.low - room) * factor, (range.high + room) * factor)
                      : "";
  };
  const auto hertz = scaled("Hz", near_alone ? near.high : fastest);
  const auto plot = [&](std::size_t first, double factor, std::string thresholds) {
    std::vector<std::string> curves;
    for (std::size_t b = 0; b < branches; ++b)
      curves.push_back(
          fmt::format("'stability.csv' using 1:(${}*{}) with points pointtype 7 pointsize 0.35 linecolor "
                      "'#00336F' notitle",
                      first + 2 * b, factor));
    if (!thresholds.empty()) curves.push_back(std::move(thresholds));
    return fmt::format("plot {}\n", fmt::join(curves, ", \\\n     "));
  };
  script += fmt::format(
      "set ylabel 'frequency ({})'\nset format x ''\n{}{}", hertz.unit, view(near, hertz.factor),
      plot(2, hertz.factor,
           scan.thresholds.empty()
               ? ""
               : fmt::format(
                     "NaN with lines linecolor '#888888' dashtype (6,4) title 'threshold, unstable where shaded'")));
  script += fmt::format("set xlabel {}\nset ylabel 'growth rate (1/s)'\nset format x '%g'\n",
                        axis_label('x', parameter.name, parameter.meaning, parameter.unit));
  script += view(growth, 1);
  script += plot(3, 1, "0 with lines linecolor '#000000' linewidth 0.6 notitle");
  write_whole(folder / "stability.gp", sheet.with(std::move(script)));
  return {"stability.csv", "stability.gp"};
}

/// The fastest slip of each motion and the period of cycles, stable ones as lines and unstable ones dashed.
std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::branches::Branches& found) {
  const auto& parameter = scene.task<tasks::Branch>().parameter;
  const auto& options = scene.task<tasks::Branch>().options;
  double fastest = 0, longest = 0;
  for (const auto& at : found.steady)
    if (at.why.empty()) fastest = std::max(fastest, std::abs(at.slip_rates.front()));
  std::string metric = "slip_rate_max";
  std::vector<std::string> names;
  for (const auto& cycle : found.cycles)
    for (const auto& at : cycle.branch.points) {
      if (at.view.metrics.contains("slip_rate_1_max")) metric = "slip_rate_1_max";
      if (names.empty())
        for (const auto& [name, value] : at.view.metrics)
          if (name != metric) names.push_back(name);
      fastest = std::max(fastest, at.view.metrics.at(metric));
      longest = std::max(longest, at.view.metrics.at("period"));
    }
  const auto speed = scaled("m/s", fastest), time = scaled("s", longest);
  const auto period = std::ranges::find(names, "period") - names.begin() + 6;
  const bool has_cycles = !found.cycles.empty();
  const Sheet sheet{"branch",
                    "Steady sliding and cycles along a parameter",
                    {.panels = has_cycles ? 2 : 1, .panel = 240},
                    scene.title,
                    caption(scene, {parameter.name})};
  std::string script = "set grid\n";
  script += axis_scale('x', options.parameter.logarithmic) + '\n';
  const auto [low, high] = std::minmax(options.parameter.from, options.parameter.to);
  script += fmt::format("set xrange [{}:{}]\n", low, high);
  const auto mark = [&](double value, const char* dash) {
    script += fmt::format("set arrow from {0}, graph 0 to {0}, graph 1 nohead linecolor '#888888' dashtype {1}\n",
                          value, dash);
  };
  for (const auto& crossing : found.crossings) mark(crossing.value, "(6,4)");
  for (const auto& cycle : found.cycles)
    for (const auto& special : cycle.branch.special) mark(special.p, "(2,3)");
  const auto curves = [&](std::ptrdiff_t column, double factor, bool with_steady, bool titled) {
    std::vector<std::string> parts;
    const auto part = [&](int branch, int stable, const char* style, std::string title) {
      parts.push_back(
          fmt::format("'branch.csv' using ($1 == {0} && $3 == {1} ? $2 : NaN):(${2}*{3}) with lines {4} {5}", branch,
                      stable, column, factor, style, title.empty() || !titled ? "notitle" : "title '" + title + "'"));
    };
    if (with_steady && !found.steady.empty()) {
      part(-1, 1, "linecolor '#444444' linewidth 1.5", "steady sliding");
      part(-1, 0, "linecolor '#444444' linewidth 1.5 dashtype (6,4)", "");
    }
    for (std::size_t b = 0; b < found.cycles.size(); ++b) {
      static constexpr const char* colors[] = {"#00336F", "#B0560F", "#3C7A3A", "#7A3A78"};
      const auto solid = fmt::format("linecolor '{}' linewidth 2", colors[b % std::size(colors)]);
      const auto dashed = solid + " dashtype (6,4)";
      part(int(b), 1, solid.c_str(),
           b == 0                                      ? "cycles, stable"
           : found.cycles[b].from == "period-doubling" ? "doubled"
                                                       : "");
      part(int(b), 0, dashed.c_str(), b == 0 ? "unstable" : "");
    }
    bool named = false;
    for (std::size_t b = 0; titled && b < found.cycles.size(); ++b)
      if (small_cycles_of(found, found.cycles[b]))
        parts.push_back(fmt::format(
            "'branch.csv' using ($1 == {} ? $2 : NaN):(${}*{}) with lines linecolor '#C0392B' linewidth 1 {}", b,
            names.size() + 6, factor, std::exchange(named, true) ? "notitle" : "title 'weakly nonlinear'"));
    if (titled && !found.crossings.empty())
      parts.emplace_back("NaN with lines linecolor '#888888' dashtype (6,4) title 'Hopf point'");
    if (titled && std::ranges::any_of(found.cycles, [](const auto& c) { return !c.branch.special.empty(); }))
      parts.emplace_back("NaN with lines linecolor '#888888' dashtype (2,3) title 'fold, torus, grazing'");
    return fmt::format("plot {}\n", fmt::join(parts, ", \\\n     "));
  };
  const auto axis = fmt::format("set xlabel {}\nset format x '%g'\n",
                                axis_label('x', parameter.name, parameter.meaning, parameter.unit));
  script += fmt::format("set ylabel 'largest slip rate ({})'\n", speed.unit);
  script += has_cycles ? "set format x ''\n" : axis;
  script += curves(4, speed.factor, true, true);
  if (has_cycles)
    script += fmt::format("{}set ylabel 'period ({})'\n{}", axis, time.unit, curves(period, time.factor, false, false));
  write_whole(folder / "branch.gp", sheet.with(std::move(script)));
  return {"branch.gp"};
}

namespace {
/// Of an oscillator that is followed by steps: for each coordinate a row, in time and against its velocity.
std::vector<std::string> write_coordinates(const fs::path& folder, const scene::Scene& scene,
                                           const analysis::motion::SteppedOscillator& oscillator,
                                           const analysis::cycles::StructureCycle& cycle) {
  const std::size_t rows = std::size_t(oscillator.coordinates);
  const Sheet sheet{"cycle",
                    "One periodic motion: coordinates in time, and against their velocities",
                    {.width = 940, .panels = int(2 * rows), .columns = 2, .panel = 205, .between_rows = 90},
                    scene.title,
                    caption(scene)};
  const auto scaled_column = [&](std::size_t c) {
    const auto [low, high] = std::ranges::minmax(cycle.columns[c]);
    return scaled(cycle.column_units[c], std::max(std::abs(low), std::abs(high)));
  };
  const auto time = scaled("s", cycle.metrics.at("period").value);
  std::string script = "set grid\nset offsets 0, 0, graph 0.05, graph 0.05\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const auto place = scaled_column(i), velocity = scaled_column(rows + i);
    script += fmt::format(
        "\nset xlabel 'time ({})'\nset ylabel {}\nplot 'cycle.csv' using ($1*{}):(${}*{}) with lines linestyle 1 "
        "notitle\n",
        time.unit, label(readable(cycle.column_names[i]), place.unit), time.factor, i + 2, place.factor);
    script += fmt::format(
        "\nset xlabel {}\nset ylabel {}\nplot 'cycle.csv' using (${}*{}):(${}*{}) with lines linestyle 1 notitle\n",
        label(readable(cycle.column_names[i]), place.unit),
        label(readable(cycle.column_names[rows + i]), velocity.unit), i + 2, place.factor, rows + i + 2,
        velocity.factor);
  }
  write_whole(folder / "cycle.gp", sheet.with(std::move(script)));
  return {"cycle.gp"};
}

/// Of a slider: in time, against slip rate beside steady sliding, and in the phase plane.
std::vector<std::string> write_slider(const fs::path& folder, const scene::Scene& scene,
                                      const analysis::cycles::StructureCycle& cycle) {
  const auto value = [&](const char* metric) { return cycle.metrics.at(metric).value; };
  const double low = value("slip_rate_min"), high = value("slip_rate_max"), period = value("period");
  const double speed = scene.model.drive.speed.level(), load = scene.model.drive.normal_load.level();
  // the steady curve over the slip rates of the cycle, for comparison
  constexpr std::size_t points = 400;
  const double sign = speed < 0 ? -1 : 1, fastest = sign > 0 ? high : -low;
  const double slowest = std::max(sign > 0 ? low : -high, 1e-6 * fastest);
  std::vector<double> rates(points), steady(points);
  for (std::size_t i = 0; i < points; ++i) {
    const double v = slowest * std::pow(fastest / slowest, double(i) / (points - 1));
    rates[i] = sign * v;
    steady[i] = sign * scene.model.law->steady_friction({v, load}).friction;
  }
  write_csv(folder / "cycle-steady.csv", {{"slip_rate (m/s)", rates}, {"friction_coefficient", steady}});

  const auto [nearest, onward] = std::ranges::minmax(cycle.columns[0]);
  const double farthest = std::max(std::abs(nearest), std::abs(onward));
  const auto time = scaled("s", 2 * period), way = scaled("m", farthest);
  const auto rate = scaled("m/s", std::max(std::abs(low), std::abs(high)));
  // a logarithmic axis keeps SI units
  const bool decades = spans_decades(low, high);
  const auto decade_rate = decades ? Scaled{1, "m/s"} : rate;

  // A law with memory moves in three dimensions: a panel more.
  const bool space = scene.model.law->has_states() && scene.model.lambda > 0;
  const Sheet sheet{"cycle",
                    "One periodic motion: in time, against slip rate, and in the phase plane",
                    {.width = 940,
                     .panels = space ? 5 : 4,
                     .columns = 2,
                     .panel = 270,
                     .above = 26,
                     .between_rows = 90,
                     .key = Layout::Key::own},
                    scene.title,
                    caption(scene)};
  std::string script = fmt::format("period = {}\nspeed = {}\n# from SI to the units of the axes\nT = {}\nX = {}\n",
                                   period, speed, time.factor, way.factor);
  script += "set grid\nset key at graph 1,1.02 right bottom horizontal\n";

  script += fmt::format("\nset xlabel 'time ({})'\nset ylabel 'slip rate v ({})'\n", time.unit, decade_rate.unit);
  script += fmt::format("V = {}\n{}\n", decade_rate.factor, axis_scale('y', decades));
  script += R"(set xrange [0:2*period*T]
plot 'cycle.csv' using ($1*T):($4*V) with lines linestyle 1 notitle, \
     'cycle.csv' using (($1+period)*T):($4*V) with lines linestyle 1 notitle, \
     speed*V with lines linestyle 3 title 'drive'
set autoscale x
)";
  script +=
      fmt::format("\nset xlabel 'slip rate v ({})'\nV = {}\n{}\n", rate.unit, rate.factor, axis_scale('y', false));
  script += R"(set ylabel 'friction coefficient μ'
plot 'cycle.csv' using ($4*V):6 with lines linestyle 1 title 'cycle', \
     'cycle-steady.csv' using ($1*V):2 with lines linestyle 2 title 'steady sliding'
)";
  const std::string plane =
      fmt::format("\nset xlabel 'displacement x ({})'\nset ylabel 'slip rate v ({})'\nV = {}\n{}\n", way.unit,
                  decade_rate.unit, decade_rate.factor, axis_scale('y', decades));
  script += plane;
  script += R"(plot 'cycle.csv' using ($2*X):($4*V) with lines linestyle 1 title 'cycle', \
     speed*V with lines linestyle 3 title 'drive'
)";
  script += fmt::format("\n{}\n{}\n", axis_scale('y', false), axis_scale('x', true));
  script += R"(set xlabel '|slip rate v| (m/s)'
set ylabel 'friction coefficient μ'
plot 'cycle.csv' using (abs($4)):6 with lines linestyle 1 title 'cycle', \
     'cycle-steady.csv' using (abs($1)):2 with lines linestyle 2 title 'steady sliding'
)";
  if (space) {
    const auto& state = scene.model.law->states().front();
    script += fmt::format("\n{}", axis_scale('x', false)) + plane;
    script += fmt::format("set xlabel 'displacement x ({})' offset 0,-1\nset ylabel 'v ({})' offset 2,-1\n", way.unit,
                          decade_rate.unit);
    const auto [least, most] = std::ranges::minmax(cycle.columns[5]);
    const double largest = std::max(std::abs(least), std::abs(most));
    const auto level = largest < 1 ? Scaled{1, state.unit} : scaled(state.unit, largest);
    script += fmt::format("Z = {}\nset zlabel '{} ({})' rotate by 90 offset -3,0\nset xtics {:g} offset -1,-0.5\n",
                          level.factor, readable(state.name), readable_unit(level.unit),
                          2 * tick_step(nearest * way.factor, onward * way.factor));
    constexpr double few = 3;  // labels along a side that is seen from its end
    script += fmt::format("set ytics {:g}\n", decades ? std::pow(10, std::ceil(std::log10(high / low) / few))
                                                      : 2 * tick_step(low * rate.factor, high * rate.factor));
    script += "set origin narrow ? 0.16 : 0.15,below_rows/high\nset size narrow ? 0.74 : 0.7,(frame+100)/high\n";
    script += R"(unset lmargin
unset rmargin
unset tmargin
unset bmargin
set view 62,35,1.15,1
set xyplane 0
unset key
splot 'cycle.csv' using ($2*X):($4*V):($7*Z) with lines linestyle 1
)";
  }
  write_whole(folder / "cycle.gp", sheet.with(std::move(script)));
  return {"cycle-steady.csv", "cycle.gp"};
}
}  // namespace

/// For each contact a row: slip rate in time, and the plane of its coordinate and velocity, with stick marked. Where
/// its load follows motion, a second row: friction and load in time, and against each other.
std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const analysis::cycles::StructureCycle& cycle) {
  if (const auto* stepped = scene::stepped_of(scene)) return write_coordinates(folder, scene, *stepped, cycle);
  if (!scene.structure) return write_slider(folder, scene, cycle);
  const auto& structure = scene.structure->structure;
  const auto column = [&](const std::string& name) {
    return std::size_t(std::ranges::find(cycle.column_names, name) - cycle.column_names.begin());
  };
  const auto size = [&](std::size_t c) {
    const auto [low, high] = std::ranges::minmax(cycle.columns[c]);
    return std::max(std::abs(low), std::abs(high));
  };
  constexpr std::size_t most_rows = 5;
  const std::size_t contacts = structure.contacts.size();
  const auto shows_forces = [&](std::size_t j) {
    return structure.contacts[j].normal.size() > 0 && !structure.contacts[j].frictionless();
  };
  std::size_t rows = 0, drawn = 0;  // of the contacts that have room
  for (std::size_t of_this = 0; drawn < contacts; ++drawn, rows += of_this)
    if (of_this = shows_forces(drawn) ? 2 : 1; rows + of_this > most_rows) break;
  const Sheet sheet{"cycle",
                    "One periodic motion: slip rate in time, and the phase plane",
                    {.width = 940,
                     .panels = int(2 * rows),
                     .columns = 2,
                     .panel = 205,
                     .above = 26,
                     .between_rows = 90,
                     .key = Layout::Key::own},
                    scene.title,
                    caption(scene)};
  std::string script = "set grid\nset key at graph 1,1.02 right bottom horizontal\n";
  script += "set offsets 0, 0, graph 0.05, graph 0.05\n";
  const auto time = scaled("s", cycle.metrics.at("period").value);
  for (std::size_t j = 0; j < drawn; ++j) {
    const auto& contact = structure.contacts[j];
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
    const auto rate = scaled(cycle.column_units[slip], size(slip)),
               way = scaled(cycle.column_units[place], size(place)),
               velocity = scaled(cycle.column_units[speed], size(speed));
    const bool has_stick =
        !contact.frictionless() && std::ranges::any_of(cycle.columns[slip], [](double u) { return u == 0; });
    // A curve of two columns, numbered as in the file, each with its factor; and where it sticks, over it.
    struct Along {
      std::size_t column;
      double factor;
    };
    const Along t{1, time.factor}, u{slip + 2, rate.factor}, x{place + 2, way.factor}, v{speed + 2, velocity.factor};
    const auto curve = [](Along horizontal, Along vertical, const char* style) {
      return fmt::format("'cycle.csv' using (${}*{}):(${}*{}) with lines {}", horizontal.column, horizontal.factor,
                         vertical.column, vertical.factor, style);
    };
    const auto stick = [&](Along horizontal, Along vertical) {
      return !has_stick ? "\n"
                        : fmt::format(
                              ", \\\n     'cycle.csv' using (${}*{}):(${} == 0 ? ${}*{} : NaN) with lines "
                              "linecolor '#B0560F' linewidth 5 title 'stick'\n",
                              horizontal.column, horizontal.factor, u.column, vertical.column, vertical.factor);
    };
    const char* alone = "linestyle 1 notitle";
    script += fmt::format("\nset xlabel 'time ({})'\nset ylabel {}\nplot {}{}", time.unit,
                          label(readable(cycle.column_names[slip]), rate.unit), curve(t, u, alone), stick(t, u));
    script +=
        fmt::format("\nset xlabel {}\nset ylabel {}\nplot {}{}", label(readable(cycle.column_names[place]), way.unit),
                    label(readable(cycle.column_names[speed]), velocity.unit), curve(x, v, alone), stick(x, v));
    if (!shows_forces(j)) continue;
    const std::size_t friction = of_contact("friction_force"), load = of_contact("normal_load");
    const auto force = scaled("N", size(load)), held = scaled("N", size(friction));
    const Along N{load + 2, force.factor}, beside_load{friction + 2, force.factor}, F{friction + 2, held.factor};
    script += fmt::format(
        "\nset xlabel 'time ({})'\nset ylabel 'force ({})'\nset key samplen 1.5 width -2\nplot {}, \\\n     {}{}",
        time.unit, force.unit, curve(t, N, "linestyle 1 title 'load'"),
        curve(t, beside_load, "linestyle 2 title 'friction'"), stick(t, beside_load));
    script += fmt::format("\nset xlabel 'load ({})'\nset ylabel 'friction ({})'\nplot {}{}", force.unit, held.unit,
                          curve(N, F, alone), stick(N, F));
  }
  write_whole(folder / "cycle.gp", sheet.with(std::move(script)));
  return {"cycle.gp"};
}

std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const Comparison& comparison) {
  auto& compare = scene.task<tasks::Compare>();
  std::vector<std::string> files;
  for (std::size_t k = 0; k < comparison.series.size(); ++k) {
    const auto& series = comparison.series[k];
    std::vector<Column> table{{column_header(comparison.x_name, comparison.x_unit), series.x}};
    for (std::size_t c = 0; c < series.columns.size(); ++c)
      table.push_back({column_header(comparison.column_names[c], comparison.column_units[c]), series.columns[c]});
    files.push_back(fmt::format("compare-{}.csv", k + 1));
    write_csv(folder / files.back(), table);
  }
  // Columns that never change have nothing to show, and velocities, accelerations and forces little beside places and
  // slip rates.
  std::vector<std::size_t> shown;
  for (std::size_t c = 0; c < comparison.column_names.size() && shown.size() < most_panels; ++c)
    if (comparison.column_names[c].find("velocity") == std::string::npos &&
        comparison.column_names[c].find("acceleration") == std::string::npos &&
        !comparison.column_names[c].starts_with("friction_force") &&
        std::ranges::any_of(comparison.series, [&](const auto& series) {
          return !series.columns[c].empty() &&
                 std::ranges::min(series.columns[c]) < std::ranges::max(series.columns[c]);
        }))
      shown.push_back(c);
  if (shown.empty()) shown.push_back(0);
  const int panels = static_cast<int>(shown.size());
  // Motions are told apart by their loops of friction over slip rate, which stand below.
  const auto named = [&](const char* name) {
    const auto found = std::ranges::find(comparison.column_names, name);
    return static_cast<std::size_t>(found - comparison.column_names.begin());
  };
  const auto rate = named("slip_rate"), friction = named("friction_coefficient"), none = comparison.column_names.size();
  const bool imposed =
      std::isinf(compare.members.front().scene.model.slider.stiffness);  // the slip rate: loops are one
  const bool loops = !imposed && comparison.x_name == "time" && rate < none && friction < none;
  const auto law_of = [&](std::size_t k) { return compare.members[k].scene.model.law->card().name; };
  std::vector<std::string> varied;  // the caption tells what members have in common
  for (std::size_t k = 1; k < compare.members.size() && varied.empty(); ++k)
    if (law_of(k) != law_of(0)) varied.emplace_back("law");
  constexpr int loop = 290, between = 85;  // pixels
  const Sheet sheet{
      "compare",
      "Members of a comparison, one over the other",
      {.panels = panels, .panel = panels == 1 ? 380.0 : run_panel, .below = 54.0 + (loops ? loop + between : 0)},
      scene.title,
      caption(scene, varied)};
  std::string script = "set grid\n";
  if (comparison.x_name == "slip_rate" || comparison.x_name == "frequency") script += axis_scale('x', true) + '\n';
  for (int panel = 0; panel < panels; ++panel) {
    const std::size_t c = shown[std::size_t(panel)];
    const auto &name = comparison.column_names[c], &unit = comparison.column_units[c];
    double largest = 0;
    for (const auto& series : comparison.series)
      for (const double value : series.columns[c]) largest = std::max(largest, std::abs(value));
    const auto [factor, prefixed] = scaled(unit, largest);
    const bool last = panel + 1 == panels;
    double low = infinity, high = -infinity;
    for (const auto& series : comparison.series)
      for (const double value : series.columns[c]) low = std::min(low, value), high = std::max(high, value);
    script += fmt::format("set ylabel {}\n", label(readable(name), prefixed));
    if (panels > 1) script += fmt::format("set ytics {:g}\n", tick_step(low * factor, high * factor));
    if (last)
      script += fmt::format("set xlabel {}\n", label(readable(comparison.x_name), comparison.x_unit));
    else
      script += "unset xlabel\n";
    if (!last) script += "set format x ''\n";
    if (last && panels > 1) script += "set format x '%g'\n";
    if (panel == 1) script += "unset key\n";
    script += "plot ";
    for (std::size_t k = 0; k < comparison.series.size(); ++k)
      script += fmt::format("{}'{}' using 1:(${}*{}) with lines linestyle {} title {}", k > 0 ? ", \\\n     " : "",
                            files[k], c + 2, factor, k + 1, single_quoted(compare.members[k].name));
    script += '\n';
  }
  if (loops) {
    double fastest = 0;
    for (const auto& series : comparison.series)
      for (const double v : series.columns[rate]) fastest = std::max(fastest, std::abs(v));
    const auto speed = scaled("m/s", fastest);
    script += fmt::format(
        "\nset lmargin at screen 85/wide\nset rmargin at screen 1-25/wide\nset bmargin at screen (below-{0})/high\n"
        "set tmargin at screen (below-{1})/high\nset xrange [*:*]\nset format x '%g'\nset ytics autofreq\nset xlabel "
        "{2}\nset ylabel {3}\nplot ",
        loop + between, between, label(readable("slip_rate"), speed.unit),
        label(readable("friction_coefficient"), "1"));
    for (std::size_t k = 0; k < comparison.series.size(); ++k)
      script += fmt::format("{}'{}' using (${}*{}):{} with lines linestyle {} notitle", k > 0 ? ", \\\n     " : "",
                            files[k], rate + 2, speed.factor, friction + 2, k + 1);
    script += '\n';
  }
  write_whole(folder / "compare.gp", sheet.with(std::move(script)));
  files.push_back("compare.gp");
  return files;
}

}  // namespace rosin::app::output
