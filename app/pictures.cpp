/// Writing gnuplot scripts and running gnuplot.
#include "app/pictures.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>

#include "app/files.hpp"
#include "app/gnuplot.hpp"

extern char** environ;

namespace rosin::app {

namespace fs = std::filesystem;

std::string single_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20) continue;
    if (std::string_view("_^{}@&~\\").find(c) != std::string_view::npos) out += '\\';
    if (c == '\'') out += '\'';
    out += c;
  }
  return out + '\'';
}

std::string preamble(const std::string& name, std::string_view what, int width, int height) {
  return fmt::format(R"(# {what}. Redraw with: gnuplot {name}.gp   or   gnuplot -e "format='png'" {name}.gp
if (!exists("format")) format = 'svg'
if (!exists("output")) output = '{name}.'.format
if (format eq 'png') {{ set terminal pngcairo size {width},{height} font 'sans,11' background 'white'
}} else {{ set terminal svg size {width},{height} font 'sans,13' background 'white' }}
set output output
set datafile separator ','
set datafile missing 'nan'
set encoding utf8
set border linewidth 0.8
set tics nomirror out
set key samplen 2.5 spacing 1.1
# Lines differ in dash as well as in colour: readable in grey and by the colour-blind.
set style line 1 linecolor '#00336F' linewidth 1.8 dashtype solid
set style line 2 linecolor '#B0560F' linewidth 1.6 dashtype (8,4)
set style line 3 linecolor '#555555' linewidth 1.2 dashtype (2,3)
set style line 4 linecolor '#3A8F5C' linewidth 1.6 dashtype (12,3,2,3)
set style line 5 linecolor '#8A4FA3' linewidth 1.6 dashtype (4,2)
)",
                     fmt::arg("what", what), fmt::arg("name", name), fmt::arg("width", width),
                     fmt::arg("height", height));
}

namespace {

/// "normal load (N)"; what follows a semicolon in a meaning explains more than an axis has room for.
std::string label(std::string_view meaning, std::string_view unit) {
  return single_quoted(column_header(meaning.substr(0, meaning.find(';')), unit));
}

std::string label(const Quantity& quantity) { return label(quantity.meaning, quantity.unit); }

/// A unit with the prefix that suits the largest value: ticks read 20, 40 µm/s instead of 2e-05, 4e-05 m/s.
struct Scaled {
  double factor;  ///< multiplies SI values
  std::string unit;
};
Scaled scaled(const std::string& unit, double largest) {
  struct Prefix {
    double size;
    const char* name;
  };
  const bool prefixable = unit == "m" || unit == "m/s" || unit == "s" || unit == "N";
  if (prefixable && largest < 1e5)
    for (const auto& [size, name] : {Prefix{1, ""}, Prefix{1e-3, "m"}, Prefix{1e-6, "µ"}, Prefix{1e-9, "n"}})
      if (largest >= size) return {1 / size, name + unit};
  return {1, unit};
}

/// "slip_rate" as it is read on an axis.
std::string readable(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

bool spans_decades(double low, double high) { return low > 0 && high / low > 50; }

/// Makes an axis logarithmic, with decades as ticks, or linear.
std::string axis_scale(char axis, bool decades) {
  return fmt::format("{0} logscale {1}\nset format {1} '{2}'", decades ? "set" : "unset", axis,
                     decades ? "10^{%T}" : "%g");
}

// ---------------------------------------------------------------- maps

constexpr const char* palette = R"(# cividis: even steps of lightness, the same for the colour-blind and in grey
set palette defined (0 '#00204D', 1 '#00336F', 2 '#39486B', 3 '#575C6D', 4 '#707173', \
                     5 '#8A8779', 6 '#A69D75', 7 '#C4B56C', 8 '#E4CF5B', 9 '#FFEA46')
set style fill solid 1 noborder
unset key
set cblabel offset 1,0
)";

/// An axis as it is drawn: decades along a logarithmic scale; values outside the scale stand below it, after a gap.
class DrawnAxis {
 public:
  explicit DrawnAxis(const analysis::Axis& axis) : axis_(axis) {
    const auto regular = static_cast<std::size_t>(axis.regular);
    for (std::size_t i = 0; i < regular; ++i) centre_.push_back(coordinate(axis.values[i]));
    cell_ = (centre_.back() - centre_.front()) / double(regular - 1);
    const auto [low, high] = std::minmax(centre_.front(), centre_.back());
    low_ = low, high_ = high;
    for (std::size_t i = regular; i < axis.values.size(); ++i)
      centre_.push_back(low - (2.5 + 1.5 * double(axis.values.size() - 1 - i)) * thickness());
  }
  double coordinate(double value) const { return axis_.logarithmic ? std::log10(value) : value; }
  double centre(std::size_t i) const { return centre_[i]; }
  double half_width(std::size_t i) const { return outside(i) ? thickness() / 2 : std::abs(cell_) / 2; }
  bool outside(std::size_t i) const { return i >= static_cast<std::size_t>(axis_.regular); }
  /// Lowest and highest coordinate of a cell's border.
  std::pair<double, double> ends() const {
    const double margin = std::abs(cell_) / 2;
    double low = low_ - margin;
    for (std::size_t i = 0; i < centre_.size(); ++i) low = std::min(low, centre_[i] - half_width(i));
    return {low, high_ + margin};
  }
  /// Ticks as gnuplot takes them: whole decades, and the values outside the scale by themselves.
  std::string ticks() const {
    std::vector<std::string> list;
    if (axis_.logarithmic) {
      const int first = static_cast<int>(std::ceil(low_ - 1e-9)), last = static_cast<int>(std::floor(high_ + 1e-9));
      const int every = std::max(1, (last - first + 7) / 8);
      for (int decade = first; decade <= last; ++decade) {
        const bool labelled = (decade - first) % every == 0;
        list.push_back(labelled ? fmt::format("'10^{{{}}}' {}", decade, decade) : fmt::format("'' {} 1", decade));
      }
      if (last - first < 1)  // less than two decades: label the ends themselves
        for (const double end : {low_, high_}) list.push_back(fmt::format("'{:.3g}' {}", std::pow(10, end), end));
    } else {
      constexpr int intervals = 5;
      for (int i = 0; i <= intervals; ++i) {
        const double at = low_ + (high_ - low_) * i / intervals;
        list.push_back(fmt::format("'{:.4g}' {}", at, at));
      }
    }
    for (std::size_t i = 0; i < centre_.size(); ++i)
      if (outside(i)) list.push_back(fmt::format("'{:g}' {}", axis_.values[i], centre_[i]));
    return fmt::format("({})", fmt::join(list, ", "));
  }

 private:
  double thickness() const { return std::max(std::abs(cell_), (high_ - low_) / 40); }
  analysis::Axis axis_;
  std::vector<double> centre_;
  double cell_ = 0, low_ = 0, high_ = 0;
};

void write_cells(const fs::path& path, const Scene& scene, const analysis::Map& map, const DrawnAxis& x,
                 const DrawnAxis& y) {
  const auto width = map.x.values.size();
  std::vector<std::vector<double>> columns(9 + scene.map.metrics.size(), std::vector<double>(map.points.size()));
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const auto ix = i % width, iy = i / width;
    const double cell[] = {double(ix),
                           double(iy),
                           double(map.points[i].regime),
                           x.centre(ix),
                           y.centre(iy),
                           x.centre(ix) - x.half_width(ix),
                           x.centre(ix) + x.half_width(ix),
                           y.centre(iy) - y.half_width(iy),
                           y.centre(iy) + y.half_width(iy)};
    for (std::size_t c = 0; c < std::size(cell); ++c) columns[c][i] = cell[c];
    for (std::size_t m = 0; m < scene.map.metrics.size(); ++m)
      columns[std::size(cell) + m][i] = map.points[i].metrics.*analysis::find_metric(scene.map.metrics[m]).member;
  }
  std::vector<Column> table;
  std::vector<std::string> names = {"ix", "iy", "regime", "x", "y", "x_low", "x_high", "y_low", "y_high"};
  names.insert(names.end(), scene.map.metrics.begin(), scene.map.metrics.end());
  for (std::size_t c = 0; c < columns.size(); ++c) table.push_back({names[c], columns[c]});
  write_csv(path, table);
}

void write_line(const fs::path& path, const analysis::Polyline& line, const DrawnAxis& x, const DrawnAxis& y) {
  std::string text = "x,y\n";
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (std::isnan(line.x[i]))
      text += '\n';
    else
      text += fmt::format("{},{}\n", x.coordinate(line.x[i]), y.coordinate(line.y[i]));
  }
  write_whole(path, text);
}

// ---------------------------------------------------------------- gnuplot

/// Runs gnuplot in the folder. \returns its exit status, or nothing if it cannot be started.
std::optional<int> run_gnuplot(const fs::path& folder, const std::string& setting, const std::string& script) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  for (const int stream : {1, 2}) posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);  // the command blocks signals, gnuplot must not
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  std::string arguments[] = {"gnuplot", "-e", setting, script};
  char* argv[] = {arguments[0].data(), arguments[1].data(), arguments[2].data(), arguments[3].data(), nullptr};
  pid_t child;
  const int problem = posix_spawnp(&child, "gnuplot", &actions, &attributes, argv, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) return std::nullopt;
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return std::nullopt;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace

std::vector<std::string> write_picture(const fs::path& folder, const Scene& scene, const Curve& curve) {
  std::string script = preamble("curve", "The steady friction curve with its extrema", 720, 480);
  script += fmt::format("set title {}\n", single_quoted(scene.title));
  script += "set logscale x\nset format x '10^{%T}'\nset xlabel 'slip rate (m/s)'\n";
  script += "set ylabel 'steady friction coefficient'\nset grid linecolor '#CCCCCC' linewidth 0.6\n";
  std::string marks;
  for (const auto& e : curve.extrema)
    marks += fmt::format("{},{},{},{:.3g} m/s\n", e.slip_rate, e.friction_coefficient, e.maximum ? 1 : 2, e.slip_rate);
  if (!marks.empty()) script += "$extrema << EOD\n" + marks + "EOD\n";
  script += "set offsets graph 0, 0, 0.12, 0.12\nplot 'curve.csv' using 1:2 with lines linestyle 1 notitle";
  // Only kinds that occur: gnuplot 5.4 crashes on labels without a point.
  for (const bool maximum : {true, false}) {
    const auto is_kind = [&](const analysis::Extremum& e) { return e.maximum == maximum; };
    if (std::none_of(curve.extrema.begin(), curve.extrema.end(), is_kind)) continue;
    const auto chosen = fmt::format("$extrema using 1:($3=={} ? $2 : NaN)", maximum ? 1 : 2);
    script += fmt::format(", \\\n     {} with points pointtype {} pointsize 1.4 linecolor '#B0560F' title '{}'", chosen,
                          maximum ? 9 : 11, maximum ? "maximum" : "minimum");
    script += fmt::format(", \\\n     {}:4 with labels offset 0,{} notitle", chosen, maximum ? 1.1 : -1.2);
  }
  script += '\n';
  write_whole(folder / "curve.gp", script);
  return {"curve.gp"};
}

constexpr int run_panel = 170, run_margin = 110;  // pixels: height of a panel, and of the texts around them all

/// A step between ticks that leaves about four: 1, 2 or 5 times a power of ten.
double tick_step(double low, double high) {
  const double step = (high - low) / 4;
  if (!(step > 0)) return 1;
  const double decade = std::pow(10, std::floor(std::log10(step)));
  return decade * (step < 1.5 * decade ? 1 : step < 3.5 * decade ? 2 : step < 7.5 * decade ? 5 : 10);
}

std::vector<std::string> write_picture(const fs::path& folder, const Scene& scene, const analysis::Run& run) {
  std::vector<std::size_t> shown;
  for (std::size_t c = 0; c < run.columns.size(); ++c)
    if (run.column_names[c] != "velocity" && run.column_names[c] != "friction_force") shown.push_back(c);
  std::string events;
  for (const auto& event : run.events) events += fmt::format("{},{}\n", event.time, event.kind);
  write_whole(folder / "run-events.csv", "time (s),kind\n" + events);

  const bool strip = run.metrics.contains("stick_time") && run.time.size() > 1;
  if (strip) {  // stick or slip over time; what the motion began with follows from its first event
    std::string steps = "time (s),stick\n";
    const auto first = std::ranges::find_if(run.events, [](const auto& event) { return event.kind != "reversal"; });
    const double stuck = run.metrics.at("stick_time");
    bool stick = first == run.events.end() ? stuck > 0 : first->kind == "slip";
    steps += fmt::format("{},{}\n", run.time.front(), stick ? 1 : 0);
    for (const auto& event : run.events)
      if (event.kind != "reversal") {
        stick = event.kind == "stick";
        steps += fmt::format("{},{}\n", event.time, stick ? 1 : 0);
      }
    steps += fmt::format("{},{}\n", run.time.back(), stick ? 1 : 0);
    write_whole(folder / "run-strip.csv", steps);
  }
  const int panels = static_cast<int>(shown.size()) + (strip ? 1 : 0);
  std::string script =
      preamble("run", "Every column of a run against time, with its events", 820, run_margin + run_panel * panels);
  const int height = run_margin + run_panel * panels;
  script += fmt::format("set multiplot layout {},1 title {} margins 0.13,0.97,{:.4f},{:.4f} spacing 0,0.03\n", panels,
                        single_quoted(scene.title), 65.0 / height, 1 - 45.0 / height);
  script += "set grid x linecolor '#CCCCCC' linewidth 0.6\nset key outside top right horizontal\n";
  if (run.time.size() > 1) script += fmt::format("set xrange [{}:{}]\n", run.time.front(), run.time.back());
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
  for (const auto c : shown) {
    const auto [low, high] = std::ranges::minmax(run.columns[c]);
    const bool decades = spans_decades(low, high);
    const auto [factor, unit] =
        decades ? Scaled{1, run.column_units[c]} : scaled(run.column_units[c], std::max(std::abs(low), std::abs(high)));
    script +=
        fmt::format("\n{}\nset ylabel {}\n", axis_scale('y', decades), label(readable(run.column_names[c]), unit));
    script +=
        decades ? "set ytics autofreq\n" : fmt::format("set ytics {:g}\n", tick_step(low * factor, high * factor));
    script += c == shown.back() && !strip ? "set xlabel 'time (s)'\nset format x '%g'\n" : "set format x ''\n";
    script += fmt::format("plot 'run.csv' using 1:(${}*{}) with lines linestyle 1 notitle", c + 2, factor);
    for (const auto& kind : kinds)  // a line over the height of the curve
      script += fmt::format(
          ", \\\n     'run-events.csv' using 1:(strcol(2) eq '{}' ? {} : NaN):(0):({}) with vectors nohead "
          "linecolor '{}' linewidth 0.8 dashtype {} {}",
          kind.name, low * factor, (high - low) * factor, kind.colour, kind.dash,
          c == shown.front() ? fmt::format("title '{}'", kind.name) : "notitle");
    script += '\n';
  }
  if (strip)
    script +=
        "\nunset logscale y\nset ylabel ''\nset yrange [-0.2:1.2]\nset ytics ('slip' 0, 'stick' 1)\n"
        "set xlabel 'time (s)'\nset format x '%g'\n"
        "plot 'run-strip.csv' using 1:2 with steps linestyle 1 notitle\n";
  write_whole(folder / "run.gp", script + "unset multiplot\n");
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
    std::string path = preamble("run-path", "The path in the plane, with its stops", 640, 600);
    path += fmt::format(
        "set title {}\nset grid linecolor '#CCCCCC' linewidth 0.6\nset xlabel 'x ({})'\nset ylabel 'y ({})'\n",
        single_quoted(scene.title), unit, unit);
    path += fmt::format(
        "plot 'run.csv' using ($2*{0}):($3*{0}) with lines linestyle 1 notitle, \\\n     'run-stops.csv' "
        "using ($1*{0}):($2*{0}) with points linestyle 2 pointtype 7 pointsize 0.8 title 'stick'\n",
        factor);
    write_whole(folder / "run-path.gp", path);
    files.insert(files.end(), {"run-path.gp", "run-stops.csv"});
  }
  if (strip) files.emplace_back("run-strip.csv");
  return files;
}

std::vector<std::string> write_picture(const fs::path& folder, const Scene& scene, const analysis::Cycle& cycle) {
  const double low = cycle.metrics.slip_rate_min, high = cycle.metrics.slip_rate_max, period = cycle.metrics.period;
  const double speed = scene.model.drive.speed.level(), load = scene.model.drive.normal_load.level();
  // the steady curve over the slip rates of the cycle, for comparison
  constexpr int points = 400;
  const double sign = speed < 0 ? -1 : 1, fastest = sign > 0 ? high : -low;
  const double slowest = std::max(sign > 0 ? low : -high, 1e-6 * fastest);
  std::vector<double> rates(points), steady(points);
  for (int i = 0; i < points; ++i)
    rates[static_cast<std::size_t>(i)] = slowest * std::pow(fastest / slowest, double(i) / (points - 1));
  scene.model.law->steady_friction(rates, load, steady);
  for (auto& v : rates) v *= sign;
  for (auto& mu : steady) mu *= sign;
  write_csv(folder / "cycle-steady.csv", {{"slip_rate (m/s)", rates}, {"friction_coefficient", steady}});

  double farthest = 0;
  for (const auto& point : cycle.orbit) farthest = std::max(farthest, std::abs(point.displacement));
  const auto time = scaled("s", 2 * period), way = scaled("m", farthest);
  const auto rate = scaled("m/s", std::max(std::abs(low), std::abs(high)));
  // a logarithmic axis keeps SI units
  const bool decades = spans_decades(low, high);
  const auto decade_rate = decades ? Scaled{1, "m/s"} : rate;

  // A law with memory moves in three dimensions: a panel more.
  const bool space = scene.model.law->has_states() && scene.model.lambda > 0;
  std::string script = preamble("cycle", "One periodic motion: in time, against slip rate, and in the phase plane",
                                space ? 1400 : 940, 760);
  script += fmt::format("period = {}\nspeed = {}\n# from SI to the units of the axes\nT = {}\nX = {}\n", period, speed,
                        time.factor, way.factor);
  script += fmt::format("set multiplot layout 2,2 title {} margins {},{},0.09,0.90 spacing {},0.16\n",
                        single_quoted(scene.title), space ? 0.067 : 0.10, space ? 0.65 : 0.97, space ? 0.09 : 0.13);
  script += "set grid linecolor '#CCCCCC' linewidth 0.5\nset key at graph 1,1.02 right bottom horizontal\n";

  script += fmt::format("\nset xlabel 'time ({})'\nset ylabel 'slip rate ({})'\n", time.unit, decade_rate.unit);
  script += fmt::format("V = {}\n{}\n", decade_rate.factor, axis_scale('y', decades));
  script += R"(set xrange [0:2*period*T]
plot 'cycle.csv' using ($1*T):($3*V) with lines linestyle 1 notitle, \
     'cycle.csv' using (($1+period)*T):($3*V) with lines linestyle 1 notitle, \
     speed*V with lines linestyle 3 title 'drive'
set autoscale x
)";
  script += fmt::format("\nset xlabel 'slip rate ({})'\nV = {}\n{}\n", rate.unit, rate.factor, axis_scale('y', false));
  script += R"(set ylabel 'friction coefficient'
plot 'cycle.csv' using ($3*V):4 with lines linestyle 1 title 'cycle', \
     'cycle-steady.csv' using ($1*V):2 with lines linestyle 2 title 'steady sliding'
)";
  const std::string plane = fmt::format("\nset xlabel 'displacement ({})'\nset ylabel 'slip rate ({})'\nV = {}\n{}\n",
                                        way.unit, decade_rate.unit, decade_rate.factor, axis_scale('y', decades));
  script += plane;
  script += R"(plot 'cycle.csv' using ($2*X):($3*V) with lines linestyle 1 title 'cycle', \
     speed*V with lines linestyle 3 title 'drive'
)";
  script += fmt::format("\n{}\n{}\n", axis_scale('y', false), axis_scale('x', true));
  script += R"(set xlabel '|slip rate| (m/s)'
set ylabel 'friction coefficient'
plot 'cycle.csv' using (abs($3)):4 with lines linestyle 1 title 'cycle', \
     'cycle-steady.csv' using (abs($1)):2 with lines linestyle 2 title 'steady sliding'
)";
  if (space) {
    const auto& state = scene.model.law->states().front();
    script += fmt::format("\n{}", axis_scale('x', false)) + plane;
    script += fmt::format("set zlabel '{} ({})' rotate by 90 offset -2,0\n", state.name, readable_unit(state.unit));
    script += R"(set origin 0.655,0.12
set size 0.345,0.78
set lmargin 8
set rmargin 3
set tmargin 0
set bmargin 3
set view 62,35
set xyplane 0
set xtics offset -1,-0.5
set xlabel offset -1,-1.5
set ylabel offset 2,-1.5
unset key
splot 'cycle.csv' using ($2*X):($3*V):5 with lines linestyle 1
)";
  }
  script += "unset multiplot\n";
  write_whole(folder / "cycle.gp", script);
  return {"cycle-steady.csv", "cycle.gp"};
}

std::vector<std::string> write_picture(const fs::path& folder, const Scene& scene,
                                       const std::vector<analysis::lab::Panel>& panels) {
  const int count = static_cast<int>(panels.size());
  const auto title = scene.title.empty() ? std::string(scene.experiment->title) : scene.title;
  std::string script =
      preamble("lab", "What an experiment shows, a panel each", count == 1 ? 720 : 60 + 520 * count, 480);
  script += fmt::format("set multiplot layout 1,{} title {} margins {},0.97,0.14,0.86 spacing {},0.1\n", count,
                        single_quoted(title), 0.13 / count + 0.01, 0.2 / count);
  script += "set grid linecolor '#CCCCCC' linewidth 0.5\n";
  std::vector<std::string> files;
  for (const auto& panel : panels) {
    double far = 0, high = 0;
    for (const auto& curve : panel.curves)
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (std::isfinite(curve.x[i])) far = std::max(far, std::abs(curve.x[i]));
        if (std::isfinite(curve.y[i])) high = std::max(high, std::abs(curve.y[i]));
      }
    const auto x = panel.x_decades ? Scaled{1, panel.x_unit} : scaled(panel.x_unit, far);
    const auto y = panel.y_decades ? Scaled{1, panel.y_unit} : scaled(panel.y_unit, high);
    script += fmt::format("\n{}\n{}\nset xlabel {}\nset ylabel {}\n", axis_scale('x', panel.x_decades),
                          axis_scale('y', panel.y_decades), label(panel.x_label, x.unit), label(panel.y_label, y.unit));
    script += panel.y_decades ? "unset offsets\n" : "set offsets 0, 0, graph 0.06, graph 0.06\n";
    script += panel.curves.size() > 3 ? "set key inside top right vertical\n"
                                      : "set key at graph 1,1.02 right bottom horizontal\n";
    std::vector<std::string> curves;
    for (const auto& curve : panel.curves) {
      const auto file =
          fmt::format("lab-panel-{}-{}.csv", &panel - panels.data() + 1, &curve - panel.curves.data() + 1);
      std::vector<Column> table = {{column_header(panel.x_label, panel.x_unit), curve.x},
                                   {column_header(panel.y_label, panel.y_unit), curve.y}};
      if (!curve.low.empty()) {
        table.push_back({"low", curve.low});
        table.push_back({"high", curve.high});
        curves.push_back(fmt::format("'{}' using ($1*{}):($3*{}):($4*{}) with filledcurves linecolor '#B8CBE0' notitle",
                                     file, x.factor, y.factor, y.factor));
      }
      write_csv(folder / file, table);
      files.push_back(file);
      const auto title = curve.label.empty() ? std::string("notitle") : "title " + single_quoted(curve.label);
      const int style = static_cast<int>(&curve - panel.curves.data()) % 3 + 1;
      curves.push_back(fmt::format("'{}' using ($1*{}):($2*{}) with {} {} {}", file, x.factor, y.factor,
                                   curve.points ? "points pointtype 7 pointsize 0.9 linecolor" : "lines linestyle",
                                   curve.points ? "'#00336F'" : fmt::format("{}", style), title));
    }
    script += fmt::format("plot {}\n", fmt::join(curves, ", \\\n     "));
  }
  write_whole(folder / "lab.gp", script + "unset multiplot\n");
  files.push_back("lab.gp");
  return files;
}

namespace {

/// The colour scale of a metric: from zero for fractions, decades where the values span some.
std::string colour_scale(const analysis::Map& map, const analysis::MetricName& metric) {
  const bool fraction = std::string_view(metric.unit) == "1";
  double low = infinity, high = -infinity;
  for (const auto& point : map.points)
    if (const double value = point.metrics.*metric.member; std::isfinite(value))
      low = std::min(low, value), high = std::max(high, value);
  const bool decades = !fraction && spans_decades(low, high);
  const char* range = !std::isfinite(low) ? "[0:1]" : fraction && low >= 0 ? "[0:*]" : "[*:*]";
  return fmt::format("set cblabel {}\n{} logscale cb\nset format cb '{}'\nset cbrange {}\n",
                     label(readable(metric.name), metric.unit), decades ? "set" : "unset", decades ? "10^{%T}" : "%g",
                     range);
}

/// Marks of the points of each regime and the threshold: further curves of each panel, and one key for all panels,
/// at a height of the picture.
struct Marks {
  std::string curves, key;
};
Marks marks(const analysis::Map& map, double key_height) {
  struct Mark {
    analysis::Regime regime;
    const char *condition, *style, *title;
  };
  using analysis::Regime;
  // black on white, so that marks and lines show on every colour
  const Mark list[] = {
      {Regime::cycle, " && thin($1,$2)", "pointtype 1 pointsize 0.65 linewidth 2.6 linecolor '#FFFFFF'", ""},
      {Regime::cycle, " && thin($1,$2)", "pointtype 1 pointsize 0.6 linewidth 0.9 linecolor '#000000'", "cycle"},
      {Regime::bistable, "", "pointtype 7 pointsize 0.55 linecolor '#FFFFFF'", ""},
      {Regime::bistable, "", "pointtype 6 pointsize 0.55 linewidth 1.2 linecolor '#000000'", "bistable"},
      {Regime::failed, "", "pointtype 2 pointsize 0.7 linewidth 1.8 linecolor '#D01C00'", "failed"}};
  Marks result;
  double at = 0.05;  // of the key's entries, across the picture
  for (const auto& mark : list) {
    if (std::ranges::none_of(map.points, [&](const auto& point) { return point.regime == mark.regime; })) continue;
    result.curves += fmt::format(", \\\n     'map-cells.csv' using 4:($3=={}{} ? $5 : NaN) with points {} notitle",
                                 int(mark.regime), mark.condition, mark.style);
    if (std::string_view(mark.title).empty()) continue;
    result.key += fmt::format("set label '{}' at screen {:.3f},{:.4f} left offset 1.2,0 point {}\n", mark.title, at,
                              key_height, mark.style);
    at += 0.13;
  }
  const auto line = [&](const char* file, const char* dash, const char* title, double length) {
    for (const auto& [width, colour] : {std::pair{5, "#FFFFFF"}, {2, "#000000"}})
      result.curves +=
          fmt::format(", \\\n     '{}' using 1:2 with lines linewidth {} dashtype {} linecolor '{}' notitle", file,
                      width, width == 5 ? "solid" : dash, colour);
    result.key +=
        fmt::format("set arrow from screen {0:.3f},{1:.4f} to screen {2:.3f},{1:.4f} nohead linewidth 2 dashtype {3}\n",
                    at, key_height, at + 0.04, dash);
    result.key += fmt::format("set label '{}' at screen {:.3f},{:.4f} left\n", title, at + 0.05, key_height);
    at += length;
  };
  if (!map.threshold.x.empty()) {
    line("map-threshold.csv", "solid", "threshold of steady sliding", 0.3);
    if (!map.fold.x.empty()) line("map-fold.csv", "(6,4)", "fold of cycles", 0.2);
  } else if (result.curves.empty()) {
    result.key = fmt::format("set label 'steady sliding is stable everywhere here' at screen {:.3f},{:.4f} left\n", at,
                             key_height);
  }
  return result;
}

/// The beginning of a script that draws planes side by side, two across: axes, palette, and the size of it all.
struct PlanePanels {
  PlanePanels(const std::string& name, std::string_view what, const Scene& scene, const analysis::Axis& x_axis,
              const analysis::Axis& y_axis, int count, double below, double above, double between)
      : height(90 + 440 * ((count + 1) / 2)) {
    const DrawnAxis x(x_axis), y(y_axis);
    const int across = std::min(count, 2), down = (count + 1) / 2;
    script = preamble(name, what, 60 + 540 * across, height);
    script += fmt::format("set multiplot layout {},{} title {} margins {},{},{:.4f},{:.4f} spacing 0.19,{:.4f}\n", down,
                          across, single_quoted(scene.title), across == 1 ? 0.14 : 0.075, across == 1 ? 0.82 : 0.91,
                          below / height, 1 - above / height, between / height);
    const auto [x_low, x_high] = x.ends();
    const auto [y_low, y_high] = y.ends();
    script += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x_low, x_high, y_low, y_high);
    script += fmt::format("set xtics {}\nset ytics {}\n", x.ticks(), y.ticks());
    script += fmt::format("set xlabel {}\nset ylabel {}\n", label(scene.model.describe(x_axis.parameter)),
                          label(scene.model.describe(y_axis.parameter)));
    script += palette;
  }
  int height;  ///< pixels
  std::string script;
};

}  // namespace

std::vector<std::string> write_picture(const fs::path& folder, const Scene& scene, const analysis::Map& map) {
  const DrawnAxis x(map.x), y(map.y);
  write_cells(folder / "map-cells.csv", scene, map, x, y);
  write_line(folder / "map-threshold.csv", map.threshold, x, y);
  write_line(folder / "map-fold.csv", map.fold, x, y);
  const int count = static_cast<int>(scene.map.metrics.size());
  auto [height, script] = PlanePanels("map", "Metrics over a parameter plane", scene, map.x, map.y, count, 105, 50, 80);
  const auto [x_low, x_high] = x.ends();
  const auto [y_low, y_high] = y.ends();
  // marks at most 24 a side: more would cover the colours
  const auto every = [](std::size_t n) { return (n + 23) / 24; };
  script += fmt::format("thin(ix, iy) = (int(ix) % {} == 0 && int(iy) % {} == 0)\n", every(map.x.values.size()),
                        every(map.y.values.size()));
  script += fmt::format("# cells overlap by a trifle, so that no seams show\nover_x = {:g}\nover_y = {:g}\n",
                        0.002 * (x_high - x_low), 0.002 * (y_high - y_low));
  const auto [curves, key] = marks(map, 24.0 / height);
  script += key;
  for (int m = 0; m < count; ++m) {
    script += '\n' + colour_scale(map, analysis::find_metric(scene.map.metrics[static_cast<std::size_t>(m)]));
    script += fmt::format(
        "plot 'map-cells.csv' using 4:5:6:($7+over_x):8:($9+over_y):{} with boxxyerror linecolor palette notitle",
        10 + m);
    script += curves + "\nunset label\nunset arrow\n";
  }
  write_whole(folder / "map.gp", script + "unset multiplot\n");
  return {"map-cells.csv", "map-threshold.csv", "map-fold.csv", "map.gp"};
}

std::vector<std::string> write_picture(const fs::path& folder, const Scene& scene, const Comparison& comparison) {
  std::vector<std::string> files;
  for (std::size_t k = 0; k < comparison.series.size(); ++k) {
    const auto& series = comparison.series[k];
    std::vector<Column> table{{column_header(comparison.x_name, comparison.x_unit), series.x}};
    for (std::size_t c = 0; c < series.columns.size(); ++c)
      table.push_back({column_header(comparison.column_names[c], comparison.column_units[c]), series.columns[c]});
    files.push_back(fmt::format("compare-{}.csv", k + 1));
    write_csv(folder / files.back(), table);
  }
  // Columns that never change have nothing to show.
  std::vector<std::size_t> shown;
  for (std::size_t c = 0; c < comparison.column_names.size(); ++c)
    if (std::ranges::any_of(comparison.series, [&](const auto& series) {
          return !series.columns[c].empty() &&
                 std::ranges::min(series.columns[c]) < std::ranges::max(series.columns[c]);
        }))
      shown.push_back(c);
  if (shown.empty()) shown.push_back(0);
  const int panels = static_cast<int>(shown.size());
  const int height = run_margin + (panels == 1 ? 380 : run_panel * panels);
  std::string script = preamble("compare", "Members of a comparison, one over the other", 820, height);
  script += fmt::format("set multiplot layout {},1 title {} margins 0.13,0.97,{:.4f},{:.4f} spacing 0,0.03\n", panels,
                        single_quoted(scene.title), 65.0 / height, 1 - 75.0 / height);
  script += "set grid linecolor '#CCCCCC' linewidth 0.6\n";
  script += fmt::format("set key at screen 0.97,{:.4f} right top horizontal\n", 1 - 35.0 / height);
  if (comparison.x_name == "slip_rate") script += axis_scale('x', true) + '\n';
  for (int panel = 0; panel < panels; ++panel) {
    const std::size_t c = shown[std::size_t(panel)];
    const auto &name = comparison.column_names[c], &unit = comparison.column_units[c];
    double largest = 0;
    for (const auto& series : comparison.series)
      for (const double value : series.columns[c]) largest = std::max(largest, std::abs(value));
    const auto [factor, prefixed] = scaled(unit, largest);
    const bool last = panel + 1 == panels;
    script += fmt::format("set ylabel {}\n", label(readable(name), prefixed));
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
                            files[k], c + 2, factor, k + 1, single_quoted(scene.compare.members[k].name));
    script += '\n';
  }
  write_whole(folder / "compare.gp", script + "unset multiplot\n");
  files.push_back("compare.gp");
  return files;
}

std::vector<std::string> write_picture(const fs::path& folder, const Scene& scene, const analysis::Design& design) {
  const DrawnAxis x(design.x), y(design.y);
  const auto width = design.x.values.size();
  const bool alone = design.by_metric.size() == 1;
  std::vector<const std::vector<double>*> planes{&design.information};
  std::vector<std::string> titles{"all metrics together"};
  for (std::size_t m = 0; !alone && m < design.by_metric.size(); ++m) {
    planes.push_back(&design.by_metric[m]);
    titles.push_back(readable(scene.compare.noise[m].metric) + " alone");
  }
  std::vector<std::vector<double>> columns(6 + planes.size());
  std::vector<std::string> names = {"x", "y", "x_low", "x_high", "y_low", "y_high"};
  double most = 0;
  for (std::size_t i = 0; i < design.information.size(); ++i) {
    const auto ix = i % width, iy = i / width;
    const double cell[] = {x.centre(ix),
                           y.centre(iy),
                           x.centre(ix) - x.half_width(ix),
                           x.centre(ix) + x.half_width(ix),
                           y.centre(iy) - y.half_width(iy),
                           y.centre(iy) + y.half_width(iy)};
    for (std::size_t c = 0; c < std::size(cell); ++c) columns[c].push_back(cell[c]);
    for (std::size_t p = 0; p < planes.size(); ++p) {
      columns[6 + p].push_back((*planes[p])[i]);
      if (std::isfinite((*planes[p])[i])) most = std::max(most, (*planes[p])[i]);
    }
  }
  names.insert(names.end(), titles.begin(), titles.end());
  std::vector<Column> table;
  for (std::size_t c = 0; c < columns.size(); ++c) table.push_back({names[c], columns[c]});
  write_csv(folder / "design-cells.csv", table);
  std::vector<std::string> files{"design-cells.csv"};
  for (std::size_t k = 0; k < design.maps.size(); ++k) {
    files.push_back(fmt::format("design-threshold-{}.csv", k + 1));
    write_line(folder / files.back(), design.maps[k].threshold, x, y);
  }

  const int count = static_cast<int>(planes.size());
  std::string script =
      PlanePanels("design", "Where measurements tell the members apart", scene, design.x, design.y, count, 80, 75, 110)
          .script;
  // Five decades below the most; white where less, or nothing, is to be learned.
  script += fmt::format(
      "set logscale cb\nset format cb '10^{{%T}}'\nset cbrange [{0}:{1}]\nset cblabel {2}\n",
      most > 0 ? most * 1e-5 : 1e-5, most > 0 ? most : 1.0,
      single_quoted(scene.compare.parameter.empty() ? std::string("log-likelihood ratio of one measurement")
                                                    : fmt::format("information on ln {}", scene.compare.parameter)));
  const double least = most > 0 ? most * 1e-5 : 1e-5;
  for (int p = 0; p < count; ++p) {
    script += fmt::format("\nset title {}\n", single_quoted(titles[std::size_t(p)]));
    script += fmt::format(
        "plot 'design-cells.csv' using 1:2:3:4:5:6:(${0} > {1} ? ${0} : NaN) with boxxyerror linecolor palette notitle",
        7 + p, least);
    for (std::size_t k = 0; k < design.maps.size(); ++k)
      if (!design.maps[k].threshold.x.empty())
        script += fmt::format(
            ", \\\n     '{0}' using 1:2 with lines linewidth 3 linecolor '#FFFFFF' notitle, "
            "'{0}' using 1:2 with lines linewidth 1.6 dashtype {1} linecolor '#000000' notitle",
            files[1 + k],
            k == 0   ? "solid"
            : k == 1 ? "(8,4)"
                     : "(2,3)");
    script += '\n';
  }
  write_whole(folder / "design.gp", script + "unset multiplot\n");
  files.push_back("design.gp");
  return files;
}

Drawn draw(const fs::path& folder, const std::string& script) {
  Drawn drawn;
  std::vector<std::string> scripts;
  if (!script.empty())
    scripts.push_back(script);
  else
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".gp") scripts.push_back(entry.path().filename().string());
  std::ranges::sort(scripts);
  for (const auto& name : scripts)
    for (const std::string format : {"svg", "png"}) {
      const auto picture = fs::path(name).replace_extension(format);
      std::optional<int> status;
      try {
        write_whole(folder / picture, [&](const fs::path& temporary) {
          status =
              run_gnuplot(folder, fmt::format("format='{}'; output='{}'", format, temporary.filename().string()), name);
          if (status != 0) throw std::runtime_error("gnuplot failed");
        });
        drawn.files.push_back(picture.string());
      } catch (const std::exception&) {
        if (!status) {
          drawn.problems.push_back(
              "no pictures: gnuplot is not there (install the package gnuplot-nox); "
              "'rosin plot' draws them later");
          return drawn;
        }
        drawn.problems.push_back(fmt::format("gnuplot could not draw {}; run 'gnuplot {}' in {} to see why",
                                             picture.string(), name, folder.string()));
      }
    }
  return drawn;
}

}  // namespace rosin::app
