/// Writing for gnuplot, and running it.
#include "app/output/gnuplot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "app/output/files.hpp"
#include "core/files.hpp"
#include "core/process.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::output {

namespace fs = std::filesystem;

std::string single_quoted(std::string_view text) {
  std::string out = "'";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (static_cast<unsigned char>(c) < 0x20) continue;
    if (std::string_view("_^{}@&~\\").find(c) != std::string_view::npos) out += '\\';
    if (c == '>' && text.substr(0, i).ends_with("]]")) out += "\u2060";  // joins words, unseen: "]]>" would end the SVG
    // Gnuplot loses count of apostrophes that stand in a row, or in double quotes.
    out += c == '\'' ? std::string("'.\"\\047\".'") : std::string(1, c);
  }
  return out + '\'';
}

Scaled scaled(const std::string& unit, double largest) {
  struct Prefix {
    double size;
    const char* name;
  };
  const bool prefixable = unit == "m" || unit == "m/s" || unit == "s" || unit == "N" || unit == "rad";
  if (prefixable && largest < 1e5)
    for (const auto& [size, name] :
         {Prefix{1, ""}, Prefix{1e-3, "m"}, Prefix{1e-6, "µ"}, Prefix{1e-9, "n"}, Prefix{1e-12, "p"}})
      if (largest >= size) return {1 / size, name + unit};
  if (unit == "Pa")
    for (const auto& [size, name] : {Prefix{1e9, "G"}, Prefix{1e6, "M"}, Prefix{1e3, "k"}})
      if (largest >= size) return {1 / size, name + unit};
  return {1, unit};
}

DrawnRange drawn_range(const std::string& unit, double low, double high) {
  constexpr double hardly = 1e-3;
  const double range = high - low, largest = std::max(std::abs(low), std::abs(high));
  double off = 0;
  if (range > 0 && range < hardly * largest) {
    const double decade = std::pow(10, std::ceil(std::log10(range)));
    off = std::round(low / decade) * decade;
  }
  const auto [factor, prefixed] = scaled(unit, std::max(std::abs(low - off), std::abs(high - off)));
  const auto common = off == 0 ? "" : fmt::format(" − {:.10g}{}", off, unit == "1" ? "" : ' ' + unit);
  return {off, factor, prefixed, common, (low - off) * factor, (high - off) * factor};
}

namespace {

/// Gnuplot says nothing of a disk that filled up while it drew: a picture is whole if it ends as its format does.
bool is_whole(const fs::path& picture, std::string_view format) {
  const std::string_view end = format == "svg" ? "</svg>\n\n" : format == "pdf" ? "%%EOF\n" : "IEND\xae\x42\x60\x82";
  std::ifstream file(picture, std::ios::binary | std::ios::ate);
  const auto size = std::streamoff(file.tellg()), length = std::streamoff(end.size());
  if (!file || size < length) return false;
  std::string last(end.size(), ' ');
  file.seekg(size - length);
  return file.read(last.data(), length) && last == end;
}

/// Whether a script draws its picture for any width, as those of a sheet do.
bool lays_itself_out(const fs::path& script) {
  constexpr std::size_t most = 100'000'000;
  return read_found(script, most).find("exists(\"width\")") != std::string::npos;
}

}  // namespace

double tick_step(double low, double high) {
  const double step = (high - low) / 4;
  if (!(step > 0)) return 1;
  const double decade = std::pow(10, std::floor(std::log10(step)));
  return decade * (step < 1.5 * decade ? 1 : step < 3.5 * decade ? 2 : step < 7.5 * decade ? 5 : 10);
}

Drawn draw(const fs::path& folder, const std::vector<std::string>& scripts, const Formats& wanted) {
  Drawn drawn;
  if (scripts.empty()) return drawn;
  const auto gnuplot = find_program("gnuplot");  // before it enters the folder, which may hold a program of that name
  if (!gnuplot) {
    drawn.problems.push_back(
        "no pictures: gnuplot is not there (install the package gnuplot-nox); 'rosin plot' draws them later");
    return drawn;
  }
  std::vector<std::string> formats = {"svg", "png"};
  if (wanted.pdf) formats.emplace_back("pdf");
  for (const auto& script : scripts) {
    if (wanted.width > 0 && !lays_itself_out(folder / script)) {
      drawn.problems.push_back(fmt::format("{} knows no width: an older rosin wrote it; ask for the results again",
                                           (folder / script).string()));
      continue;
    }
    for (const auto& format : formats) {
      const auto picture = fs::path(script).replace_extension(format);
      try {
        write_whole(folder / picture, [&](const fs::path& temporary) {
          const auto output = temporary.parent_path().filename() / temporary.filename();
          const auto setting = fmt::format("format='{}'; output='{}'; width={}", format, output.string(), wanted.width);
          const auto ran = run_program({*gnuplot, {"-e", setting, script}, folder});
          if (!ran || ran->status != 0)
            throw std::runtime_error(fmt::format("gnuplot could not draw {}; run 'gnuplot {}' in {} to see why",
                                                 picture.string(), script, folder.string()));
          if (!is_whole(temporary, format))
            throw std::runtime_error(
                fmt::format("{}: gnuplot left it cut short; is the disk full?", (folder / picture).string()));
        });
        drawn.files.push_back(picture.string());
      } catch (const std::runtime_error& problem) {
        drawn.problems.emplace_back(problem.what());
      }
    }
  }
  return drawn;
}

}  // namespace rosin::app::output
