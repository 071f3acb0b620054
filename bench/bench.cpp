/// The record of a bench: machine, date, rows, pictures.
#include "bench/bench.hpp"

#include <fmt/chrono.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <sstream>

#include "bench/rows.hpp"
#include "core/files.hpp"
#include "core/process.hpp"

namespace bench {
namespace {

namespace fs = std::filesystem;

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

/// Colours of Okabe & Ito by package, marks by variables; accelerated: the same mark, open and dashed. Curves can be
/// told apart without colour.
std::string style(const std::string& solver) {
  struct Look {
    const char *solver, *colour;
    int mark, open;
  };
  constexpr Look looks[] = {{"AUTO-07p, 4", "#0072B2", 5, 4},
                            {"AUTO-07p, 7", "#D55E00", 9, 8},
                            {"rosin, closed form", "#000000", 3, 3},
                            {"rosin, events", "#000000", 14, 14},
                            {"CVODE Adams", "#56B4E9", 13, 12},
                            {"CVODE BDF", "#0072B2", 5, 4},
                            {"meijaard", "#009E73", 15, 14},
                            {"cfm", "#999999", 1, 1},
                            {"o-fbfm", "#E69F00", 11, 10},
                            {"r-fbfm", "#D55E00", 9, 8},
                            {"aabg-sdfm", "#F0E442", 5, 5},
                            {"tr-sdfm", "#CC79A7", 7, 7},
                            {"rosin, whole", "#000000", 7, 7},
                            {"rosin, prediction", "#000000", 3, 3},
                            {"rosin, swept sine", "#000000", 7, 7},
                            {"rosin, explicit", "#000000", 3, 3},
                            {"rosin, collocation", "#000000", 14, 14},
                            {"rosin, average acceleration", "#000000", 1, 1},
                            {"rosin, generalised-alpha", "#000000", 14, 14},
                            {"rosin, friction curve", "#000000", 7, 7},
                            {"rosin, temperature", "#000000", 5, 4},
                            {"loop by hand, friction curve", "#0072B2", 7, 6},
                            {"loop by hand, temperature", "#D55E00", 5, 4},
                            {"rosin, transient", "#000000", 3, 3},
                            {"rosin", "#000000", 1, 1},
                            {"CVODE, good", "#56B4E9", 13, 12},
                            {"CVODE", "#0072B2", 5, 4},
                            {"ARKODE", "#009E73", 15, 14},
                            {"odeint rosenbrock4", "#D55E00", 9, 8},
                            {"odeint, good", "#E69F00", 11, 10},
                            {"odeint dopri5", "#D55E00", 10, 10},
                            {"SciPy Radau", "#CC79A7", 1, 1},
                            {"SciPy LSODA", "#CC79A7", 2, 2}};
  const bool accelerated = solver.ends_with("accelerated");
  for (const auto& look : looks)
    if (solver.starts_with(look.solver))
      return fmt::format("lc rgb '{}' pt {} dt {} lw {} ps 0.8", look.colour, accelerated ? look.open : look.mark,
                         accelerated ? 2 : 1, solver.starts_with("rosin") ? 2.6 : 1.5);
  return "";
}

struct Bench {
  std::string_view name;
  Record (*run)(const Settings&, const SciPy&, const fs::path& curves);
};
constexpr std::array benches{Bench{"block", bench_block},           Bench{"branch", bench_branch},
                             Bench{"chain", bench_chain},           Bench{"cycle", bench_cycle},
                             Bench{"history", bench_history},       Bench{"plane", bench_plane},
                             Bench{"response", bench_response},     Bench{"sections", bench_sections},
                             Bench{"stick-slip", bench_stick_slip}, Bench{"string", bench_string}};

/// A gnuplot script of its own, to be restyled at will, and its SVG and PNG.
bool draw(const fs::path& stem, const std::vector<Panel>& panels) {
  const auto base = stem.filename().string();
  const auto script = stem.string() + ".gp";
  std::ostringstream out;
  out << fmt::format("# Run time against true error: gnuplot {0}.gp, in this folder, writes {0}.svg and {0}.png.\n",
                     base);
  const int width = panels.size() > 1 ? 1500 : 900;
  out << "set encoding utf8\ndo for [format in \"svg png\"] {\n"
      << "  if (format eq \"svg\") {\n"
      << fmt::format("    set terminal svg size {},560 font 'sans-serif,13' background rgb 'white'\n", width)
      << "  } else {\n"
      << fmt::format("    set terminal pngcairo size {},1120 font 'sans,13' fontscale 1.5 pointscale 2 linewidth 2\n",
                     2 * width)
      << "  }\n"
      << fmt::format("  set output sprintf('{}.%s', format)\n", base)
      << "  set logscale xy\n  set format '10^{%T}'\n  set grid lc rgb '#dddddd' lw 0.6 dt 1\n  set border 3\n"
      << "  set tics nomirror out\n  set xrange [*:*] reverse\n  set key outside right top Left reverse samplen 3 "
         "font ',11'\n"
      << fmt::format("  set multiplot layout 1,{}\n", panels.size());
  for (const auto& panel : panels) {
    out << fmt::format("  set title '{}'\n  set xlabel '{}'\n  set ylabel '{}'\n", panel.title, panel.error,
                       panel.time);
    std::ifstream data(panel.curves);
    std::vector<std::string> curves;
    bool empty = true;
    std::string name;
    const auto close = [&] {
      if (!empty)
        curves.push_back(fmt::format("'{}' index \"{};\" using 1:2 with linespoints {} title '{}'",
                                     panel.curves.filename().string(), name, style(name), name));
    };
    for (std::string line; std::getline(data, line);) {
      if (line.rfind("# ", 0) == 0) {
        close();
        empty = true, name = line.substr(2, line.size() - 3);
      } else if (!line.empty()) {
        empty = false;
      }
    }
    close();
    out << fmt::format("  plot {}\n", fmt::join(curves, ", \\\n       "));
  }
  out << "  unset multiplot\n  unset output\n  reset\n}\n";
  rosin::write_whole(script, out.str());
  const auto gnuplot = rosin::find_program("gnuplot");
  const auto ran = gnuplot ? rosin::run_program({*gnuplot, {base + ".gp"}, stem.parent_path()}) : std::nullopt;
  return ran && ran->status == 0;
}

}  // namespace

const std::vector<std::string>& names() {
  static const auto list = [] {
    std::vector<std::string> list;
    for (const auto& bench : benches) list.emplace_back(bench.name);
    return list;
  }();
  return list;
}

bool run(const Settings& settings) {
  const SciPy scipy(settings);
  json document = {{"bench", settings.what},
                   {"date", fmt::format("{:%Y-%m-%d}", fmt::localtime(std::time(nullptr)))},
                   {"quick", settings.quick},
                   {"machine",
                    {{"processor", processor()},
                     {"compiler", "gcc " __VERSION__},
                     {"build", ROSIN_BUILD_FLAGS},
                     {"scipy", scipy.found() ? scipy.version() : "none"},
                     {"threads", 1}}}};
  say(settings, "{} · {} · gcc {} · {} · SciPy {}\n\n", document["date"].get<std::string>(), processor(), __VERSION__,
      ROSIN_BUILD_FLAGS, scipy.found() ? scipy.version() : "not found, left out");
  const fs::path folder = settings.folder;
  fs::create_directories(folder);
  fs::remove(rows_file(settings));
  const fs::path stem = folder / settings.what;
  fs::path curves = stem;
  curves.replace_extension(".dat");
  const auto record = std::find_if(benches.begin(), benches.end(), [&](const Bench& bench) {
                        return bench.name == settings.what;
                      })->run(settings, scipy, curves);
  document[settings.what] = record.content;
  document["findings"] = record.findings;
  for (const auto& finding : record.findings) rosin::tell("FINDING: {}\n", finding);
  rosin::write_whole(stem.string() + ".json", document.dump(1) + '\n');
  if (!draw(stem, record.panels)) rosin::tell("note: the picture could not be drawn\n");
  if (settings.json)
    rosin::print("{}\n", document.dump(1));
  else
    rosin::print("\nResults: {}\n", (folder / "").string());
  return record.findings.empty();
}

}  // namespace bench
