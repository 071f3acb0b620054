/// Writing for gnuplot, and running it.
#include "app/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "app/files.hpp"

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

std::string label(std::string_view meaning, std::string_view unit) {
  return single_quoted(column_header(meaning.substr(0, meaning.find(';')), unit));
}

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

std::string readable(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

bool spans_decades(double low, double high) { return low > 0 && high / low > 50; }

std::string axis_scale(char axis, bool decades) {
  return fmt::format("{0} logscale {1}\nset format {1} '{2}'", decades ? "set" : "unset", axis,
                     decades ? "10^{%T}" : "%g");
}

namespace {

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
