/// Pictures of a motion's spectrum and spectrogram.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/motion/spectrum.hpp"
#include "app/output/caption.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "core/files.hpp"

namespace rosin::app::output {

namespace {

constexpr std::size_t most_spectra = 4;
constexpr double deepest = 1e-8;  ///< of the largest amplitude, that is drawn

/// From the largest amplitude away from 0 Hz down to the least that is drawn.
std::pair<double, double> span_of(std::span<const double> amplitude, std::size_t frequencies) {
  double largest = 0, least = infinity;
  for (std::size_t i = 0; i < amplitude.size(); ++i)
    if (i % frequencies != 0) largest = std::max(largest, amplitude[i]), least = std::min(least, amplitude[i]);
  if (!(largest > 0)) largest = 1;
  return {std::max(least, deepest * largest), largest};
}

}  // namespace

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::motion::MotionSpectrum& spectrum) {
  std::vector<Column> table{{"frequency (Hz)", spectrum.frequency}};
  for (std::size_t c = 0; c < spectrum.names.size(); ++c)
    table.push_back({column_header(spectrum.names[c], spectrum.units[c]), spectrum.amplitude[c]});
  write_csv(folder / "spectrum.csv", table);
  const std::size_t panels = std::min(spectrum.names.size(), most_spectra);
  const Sheet sheet{"spectrum",
                    "Amplitudes of the columns of a motion over frequency",
                    {.panels = int(panels), .panel = 180},
                    scene.title,
                    caption(scene)};
  std::string script =
      fmt::format("set grid\nset logscale y\nset format y '10^{{%T}}'\nset xrange [0:{}]\nset format x ''\n",
                  spectrum.frequency.back());
  for (std::size_t c = 0; c < panels; ++c) {
    if (c + 1 == panels) script += "set format x '%g'\nset xlabel 'frequency (Hz)'\n";
    const auto [low, high] = span_of(spectrum.amplitude[c], spectrum.frequency.size());
    script += fmt::format("set yrange [{}:{}]\nset ylabel {}\n", 0.5 * low, 2 * high,
                          label(readable(spectrum.names[c]), spectrum.units[c]));
    script += fmt::format("plot 'spectrum.csv' using 1:(${0} > {1} ? ${0} : {1}) with lines linestyle 1 notitle\n",
                          c + 2, low);
  }
  write_whole(folder / "spectrum.gp", sheet.with(std::move(script)));
  std::vector<std::string> files = {"spectrum.csv", "spectrum.gp"};
  if (spectrum.part_time.empty()) return files;

  const std::size_t frequencies = spectrum.part_frequency.size();
  std::vector<double> time, frequency;
  for (const double t : spectrum.part_time)
    for (const double f : spectrum.part_frequency) time.push_back(t), frequency.push_back(f);
  table = {{"time (s)", time}, {"frequency (Hz)", frequency}};
  for (std::size_t c = 0; c < spectrum.names.size(); ++c)
    table.push_back({column_header(spectrum.names[c], spectrum.units[c]), spectrum.part_amplitude[c]});
  write_csv(folder / "spectrogram.csv", table);
  const Sheet over_time{"spectrogram",
                        "Amplitudes of the columns of a motion over frequency and time",
                        {.panels = int(panels), .panel = 200, .right = 120},
                        scene.title,
                        caption(scene)};
  script =
      "set palette defined (0 '#00204D', 1 '#00336F', 2 '#39486B', 3 '#575C6D', 4 '#707173', 5 '#8A8779', 6 '#A69D75', "
      "7 '#C4B56C', 8 '#E4CF5B', 9 '#FFEA46')\nset logscale cb\nset format cb '10^{%T}'\nset ylabel 'frequency "
      "(Hz)'\nset format x ''\n";
  script += fmt::format("set yrange [0:{}]\nset xrange [{}:{}]\n", spectrum.part_frequency.back(),
                        spectrum.part_time.front(), spectrum.part_time.back());
  for (std::size_t c = 0; c < panels; ++c) {
    if (c + 1 == panels) script += "set format x '%g'\nset xlabel 'time t (s)'\n";
    const auto [low, high] = span_of(spectrum.part_amplitude[c], frequencies);
    script += fmt::format("set cbrange [{}:{}]\nset cblabel {}\n", low, high,
                          label(readable(spectrum.names[c]), spectrum.units[c]));
    script += fmt::format("plot 'spectrogram.csv' using 1:2:(${0} > {1} ? ${0} : {1}) skip 1 with image notitle\n",
                          c + 3, low);
  }
  write_whole(folder / "spectrogram.gp", over_time.with(std::move(script)));
  files.insert(files.end(), {"spectrogram.csv", "spectrogram.gp"});
  return files;
}

}  // namespace rosin::app::output
