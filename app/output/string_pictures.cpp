/// Pictures of bowed strings: velocity, friction, temperature and bridge force over time, friction against slip rate,
/// and planes of transients with the limits that theory has for them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/planes/map.hpp"
#include "analysis/strings/strings.hpp"
#include "app/output/caption.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/family.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/bowing.hpp"

namespace rosin::app::output {

namespace {

using analysis::strings::Pixel;
using analysis::strings::StringRecord;

constexpr const char *position = "oscillator.bow_position", *load = "drive.normal_load",
                     *acceleration = "drive.speed.ramp.rate";

constexpr const char* axes_of_runs = "set grid x\nset format x ''\n";

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

/// "speed of the bow (m/s)", of a ramp its rate.
std::string label_of(char axis, const scene::Scene& scene, const std::string& parameter) {
  if (parameter == acceleration) return single_quoted("acceleration of the bow (m/s²)");
  const auto quantity = scene.describe(parameter);
  return axis_label(axis, parameter, quantity.meaning, quantity.unit);
}

/// The scale of an axis, with 1, 2 and 5 as ticks of a logarithmic one that spans few decades.
std::string scale_of(char axis, const analysis::planes::Axis& values) {
  auto script = axis_scale(axis, values.logarithmic) + '\n';
  const double low = values.values.front(), high = values.values.back();
  if (!values.logarithmic || high > 500 * low) return script;
  std::vector<double> ticks;
  for (double decade = std::pow(10, std::floor(std::log10(low))); decade <= high; decade *= 10)
    for (const double digit : {1., 2., 5.})
      if (const double tick = digit * decade; tick >= 0.99 * low && tick <= 1.01 * high) ticks.push_back(tick);
  return script + fmt::format("set format {0} '%g'\nset {0}tics ({1:g})\n", axis, fmt::join(ticks, ", "));
}

/// Columns of a table of all strings of a plane, row by row: where each stands, and the ends of its cell.
struct Cells {
  std::array<std::vector<double>, 6> places;
  std::array<std::string, 6> headers;
  std::vector<Column> columns() const {
    std::vector<Column> list;
    for (std::size_t c = 0; c < places.size(); ++c) list.push_back({headers[c], places[c]});
    return list;
  }
  /// Frame and labels of a picture of them.
  std::string frame;
};
Cells cells_of(const scene::Scene& scene) {
  const auto &x = scene.string->x, &y = scene.string->y;
  const auto of_x = borders(x), of_y = borders(y);
  Cells cells{{},
              {column_header(x.parameter, scene.describe(x.parameter).unit),
               column_header(y.parameter, scene.describe(y.parameter).unit), "x_low", "x_high", "y_low", "y_high"},
              {}};
  for (std::size_t j = 0; j < y.values.size(); ++j)
    for (std::size_t i = 0; i < x.values.size(); ++i) {
      const double place[] = {x.values[i], y.values[j], of_x[i], of_x[i + 1], of_y[j], of_y[j + 1]};
      for (std::size_t c = 0; c < cells.places.size(); ++c) cells.places[c].push_back(place[c]);
    }
  cells.frame = fmt::format("set xlabel {}\nset ylabel {}\n", label_of('x', scene, x.parameter),
                            label_of('y', scene, y.parameter)) +
                scale_of('x', x) + scale_of('y', y) +
                fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\nset style fill solid 1 border\n", of_x.front(),
                            of_x.back(), of_y.front(), of_y.back());
  return cells;
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
  const auto states = oscillators::BowContacts::state_names(*task.model.law);
  const bool warms = !states.empty() && states.front().name == "temperature_rise";
  const int panels = warms ? 4 : 3;
  const auto from = std::size_t(std::ranges::lower_bound(record.time, first) - record.time.begin()),
             to = std::size_t(std::ranges::upper_bound(record.time, last) - record.time.begin());
  const auto ends = [&](const std::vector<double>& list) {
    return std::ranges::minmax(std::span(list).subspan(from, std::max<std::size_t>(to - from, 1)));
  };
  const Sheet sheet{"run",
                    "A bowed string: what happens under the bow and at the bridge",
                    {.width = 900, .panels = panels, .panel = 140},
                    scene.title,
                    caption(scene)};
  std::string script = axes_of_runs;
  script += fmt::format("set xrange [{}:{}]\n", first * 1e3, last * 1e3);
  // Slip is shaded in each panel: merged slips that count as one.
  int object = 0;
  std::string shades;
  for (const auto& slip : transient.slips)
    if (const double on = double(slip.on) * step, off = double(slip.off) * step; off >= first && on <= last)
      shades += fmt::format(
          "set object {} rectangle from {},graph 0 to {},graph 1 fillcolor '#E3E8EE' fillstyle solid noborder behind\n",
          ++object, std::max(on, first) * 1e3, std::min(off, last) * 1e3);
  script += shades;
  const auto curve = [](const std::string& y, int style, const char* title) {
    return fmt::format("'run.csv' using ($1*1e3):{} with lines linestyle {} {}", y, style,
                       *title ? fmt::format("title '{}'", title) : "notitle");
  };
  const auto [lowest, fastest] = ends(record.velocity);
  const double span = std::max(std::abs(lowest), std::abs(fastest));
  script += fmt::format("set ylabel 'velocity (m/s)'\nset yrange [{}:{}]\nset ytics {:g}\nplot {}, \\\n     {}\n",
                        lowest - 0.06 * span, fastest + 0.06 * span, tick_step(lowest, fastest),
                        curve("3", 1, "string"), curve("2", 2, "bow"));
  script += fmt::format("set ylabel 'friction over load'\nset autoscale y\nset ytics 0.5\nplot {}\n",
                        curve("($5/$6)", 1, ""));
  if (warms) {
    const auto [cold, hot] = ends(record.states.front());
    script +=
        fmt::format("set ylabel 'temperature rise (K)'\nset yrange [0:*]\nset ytics {:g}\nplot {}\nset autoscale y\n",
                    tick_step(cold, hot), curve("9", 1, ""));
  }
  const auto [pull, push] = ends(record.bridge_force);
  script += fmt::format(
      "set format x '%g'\nset xlabel 'time (ms); slip is shaded'\nset ylabel 'bridge force (N)'\nset ytics {:g}\nplot "
      "{}\n",
      tick_step(pull, push), curve("7", 1, ""));
  write_whole(folder / "run.gp", sheet.with(std::move(script)));

  // Friction against slip rate over the last periods, and the steady curve.
  constexpr double orbit = 8;
  const double begin = record.time.back() - orbit * period;
  double slipping = 1e-3;
  for (std::size_t i = 0; i < record.time.size(); ++i)
    if (record.time[i] >= begin) slipping = std::max(slipping, std::abs(record.slip_rate[i]));
  std::vector<double> rates, steady;
  constexpr int points = 200;
  const double N = std::max(record.normal_load.back(), 1e-9);
  for (int i = 0; i <= points; ++i) {
    rates.push_back(std::max(1e-4, slipping * i / points));
    steady.push_back(task.model.law->steady_friction({rates.back(), N}).friction);
  }
  write_csv(folder / "run-steady.csv", {{"slip_rate (m/s)", rates}, {"friction_coefficient", steady}});
  const Sheet plane{"run-friction",
                    "Friction against slip rate under the bow",
                    {.width = 640, .panel = 380},
                    scene.title,
                    caption(scene)};
  std::string locus = fmt::format(
      "set grid\nset xlabel 'slip rate v (m/s)'\nset ylabel 'friction over load μ'\n"
      "set yrange [0:*]\n"
      "set offsets 0,0,graph 0.12,0\n"
      "plot 'run-steady.csv' using 1:2 with lines linestyle 2 title 'steady sliding', \\\n"
      "     'run.csv' using ($1>={}&&$8<0.5?$4:NaN):($5/$6) with linespoints pointtype 7 pointsize 0.25 linewidth 0.7 "
      "linecolor '#00336F' "
      "title 'in slip, last {:g} periods'\n",
      begin, orbit);
  write_whole(folder / "run-friction.gp", plane.with(std::move(locus)));
  return {"run-steady.csv", "run.gp", "run-friction.gp"};
}

std::vector<std::string> write_string_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                              std::span<const Pixel> pixels) {
  const auto& task = *scene.string;
  const auto cells = cells_of(scene);
  std::vector<double> lengths, regimes, reproducible;
  for (const auto& pixel : pixels) {
    lengths.push_back(pixel.bowing.transient.length);
    regimes.push_back(double(pixel.bowing.transient.regime));
    reproducible.push_back(pixel.reproducible ? 1.0 : 0.0);
  }
  auto table = cells.columns();
  table.push_back({"transient_length", lengths});
  table.push_back({"regime", regimes});
  table.push_back({"reproducible", reproducible});
  write_csv(folder / "map.csv", table);
  const auto limits = limits_of(scene);
  std::string lines = "x,y\n";
  for (const auto& limit : limits) {
    for (std::size_t i = 0; i < limit.x.size(); ++i) lines += fmt::format("{},{}\n", limit.x[i], limit.y[i]);
    lines += "\n\n";
  }
  write_whole(folder / "map-limits.csv", lines);

  const auto sheet = [&](const std::string& name, const char* what) {
    return Sheet{name,
                 what,
                 {.width = 760, .panel = 400, .right = 120, .key = Layout::Key::below},
                 scene.title,
                 caption(scene, {task.x.parameter, task.y.parameter})};
  };
  std::vector<std::string> theory;
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const auto data = fmt::format("'map-limits.csv' using 1:2 index {} with lines", k);
    theory.push_back(data + " linewidth 4 linecolor '#FFFFFF' notitle");
    theory.push_back(fmt::format("{} linewidth 1.8 linecolor '{}' dashtype {} title {}", data,
                                 k == 0 ? "#0072B2" : "#D55E00", k == 0 ? "solid" : "(8,4)",
                                 single_quoted(limits[k].title)));
  }
  constexpr std::size_t most_marks = 4000;
  const auto of_lengths = sheet("map", "Length of the transient of a bowed string");
  std::string transients = cells.frame;
  transients += fmt::format(
      "set palette defined (0 '#FFFFFF', 1 '#111111')\nset cbrange [0:{}]\nset cblabel 'transient (periods); black: "
      "none within {}'\n",
      task.options.transient.most, task.options.transient.most);
  std::vector<std::string> plots = {"'map.csv' using 1:2:3:4:5:6:7 with boxxyerror linecolor palette notitle"};
  const bool checked = !task.plane.finer.empty();
  if (checked && pixels.size() <= most_marks)
    plots.push_back(
        "'map.csv' using ($9<0.5?$1:NaN):2 with points pointtype 2 pointsize 0.45 linewidth 1.5 linecolor '#E69F00' "
        "title 'other at a finer sample rate'");
  plots.insert(plots.end(), theory.begin(), theory.end());
  transients += fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
  write_whole(folder / "map.gp", of_lengths.with(std::move(transients)));

  const auto of_regimes = sheet("map-regime", "Motion that a bowed string ends in");
  std::string motions = cells.frame;
  constexpr std::array<std::pair<const char*, const char*>, 6> colours = {{{"no slip", "#FFFFFF"},
                                                                           {"Helmholtz", "#F0E442"},
                                                                           {"two slips a period", "#56B4E9"},
                                                                           {"irregular", "#CC79A7"},
                                                                           {"raucous", "#555555"},
                                                                           {"sliding", "#009E73"}}};
  plots.clear();
  for (std::size_t k = 0; k < colours.size(); ++k) {
    const auto is = [&](const Pixel& pixel) { return std::size_t(pixel.bowing.transient.regime) == k; };
    if (std::ranges::none_of(pixels, is)) continue;
    plots.push_back(fmt::format("'map.csv' using 1:($8=={}?$2:NaN):3:4:5:6 with boxxyerror linecolor '{}' notitle", k,
                                colours[k].second));
    plots.push_back(fmt::format("NaN with boxes fillcolor '{}' fillstyle solid 1 border linecolor '#777777' title '{}'",
                                colours[k].second, colours[k].first));
  }
  plots.insert(plots.end(), theory.begin(), theory.end());
  motions += fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
  write_whole(folder / "map-regime.gp", of_regimes.with(std::move(motions)));
  return {"map.csv", "map-limits.csv", "map.gp", "map-regime.gp"};
}

std::vector<std::string> write_string_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                              const std::vector<std::vector<Pixel>>& planes,
                                              const std::vector<double>& separation) {
  const auto& task = *scene.string;
  const auto cells = cells_of(scene);
  auto table = cells.columns();
  std::vector<std::vector<double>> lengths(planes.size());
  for (std::size_t k = 0; k < planes.size(); ++k) {
    for (const auto& pixel : planes[k]) lengths[k].push_back(pixel.reproducible ? pixel.bowing.transient.length : NAN);
    table.push_back({"transient_length of " + task.members[k].name, lengths[k]});
  }
  table.push_back({"separation", separation});
  write_csv(folder / "compare.csv", table);

  const int panels = int(planes.size()) + 1;
  std::vector<std::string> varied = {task.x.parameter, task.y.parameter};
  if (std::ranges::any_of(task.members, [&](const auto& member) { return member.family != task.members[0].family; }))
    varied.emplace_back("law");
  const Sheet sheet{"compare",
                    "Transients of bowed strings side by side",
                    {.width = 340 * panels + 40,
                     .panels = panels,
                     .columns = panels,
                     .panel = 270,
                     .right = 110,
                     .above = 32,
                     .between_columns = 125,
                     .between_rows = 90},
                    scene.title,
                    caption(scene, varied)};
  std::string script = cells.frame + fmt::format("set cbrange [0:{}]\n", task.options.transient.most);
  // What hangs on the sample rate shows the ground.
  script += "set object 1 rectangle from graph 0,0 to graph 1,1 fillcolor '#E69F00' fillstyle solid noborder behind\n";
  script += "set palette defined (0 '#FFFFFF', 1 '#111111')\nunset colorbox\nunset key\n";
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (k + 1 == planes.size()) script += "set colorbox\n";
    script += fmt::format("set title {}\nplot 'compare.csv' using 1:2:3:4:5:6:{} with boxxyerror linecolor palette\n",
                          single_quoted(task.members[k].name + ", transient (periods)"), 7 + k);
    if (k == 0) script += fmt::format("if (columns == {}) {{ unset ylabel; set format y '' }}\n", panels);
  }
  script += fmt::format(
      "set palette defined (0 '#FFFFFF', 1 '#00336F')\nset cbrange [0:*]\nset cblabel 'difference (periods)'\nset "
      "title 'least "
      "difference; "
      "orange: not reproducible'\nplot 'compare.csv' using 1:2:3:4:5:6:{} with boxxyerror linecolor palette\n",
      7 + planes.size());
  write_whole(folder / "compare.gp", sheet.with(std::move(script)));
  return {"compare.csv", "compare.gp"};
}

}  // namespace rosin::app::output
