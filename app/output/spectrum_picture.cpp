/// Pictures of a motion's spectrum and spectrogram.
#include <algorithm>

#include "analysis/motion/spectrum.hpp"
#include "app/output/figure.hpp"
#include "app/output/pictures.hpp"
#include "app/output/scene_figure.hpp"

namespace rosin::app::output {

using namespace results;

namespace {

constexpr std::size_t most_spectra = 4;
constexpr double deepest = 1e-8;  ///< of the largest amplitude, that is drawn

/// From the largest amplitude away from 0 Hz down to the least that is drawn.
Extent span_of(std::span<const double> amplitude, std::size_t frequencies) {
  Extent span;
  for (std::size_t i = 0; i < amplitude.size(); ++i)
    if (i % frequencies != 0) span.include(amplitude[i]);
  if (!(span.high > 0)) span.high = 1;
  return {std::max(span.low, deepest * span.high), span.high};
}

}  // namespace

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::motion::MotionSpectrum& spectrum) {
  const std::size_t panels = std::min(spectrum.names.size(), most_spectra);
  auto figure = figure_of(scene, "spectrum", "Amplitudes of the columns of a motion over frequency");
  auto over_time = figure_of(scene, "spectrogram", "Amplitudes of the columns of a motion over frequency and time");
  figure.height = 180, over_time.height = 200;
  FigureTable table{"spectrum.csv", {{"frequency (Hz)", spectrum.frequency}}},
      parts{"spectrogram.csv", {{"time (s)", {}}, {"frequency (Hz)", {}}}};
  for (const double t : spectrum.part_time)
    for (const double f : spectrum.part_frequency)
      parts.columns[0].values.push_back(t), parts.columns[1].values.push_back(f);
  auto frequency = axis_of("frequency", "Hz");
  frequency.from = 0, frequency.to = spectrum.frequency.back();
  for (std::size_t c = 0; c < spectrum.names.size(); ++c) {
    const auto column = axis_of(spectrum.names[c], spectrum.units[c]);
    table.columns.push_back(column_of(spectrum.names[c], spectrum.units[c], spectrum.amplitude[c]));
    if (c < panels) {
      const auto [low, high] = span_of(spectrum.amplitude[c], spectrum.frequency.size());
      auto amplitude = column;
      amplitude.decades = true, amplitude.from = 0.5 * low, amplitude.to = 2 * high;
      figure.panels.push_back({.x = frequency,
                               .y = amplitude,
                               .lines = {{.table = table.file, .y = {.column = int(c) + 2, .least = low}}}});
    }
    if (spectrum.part_time.empty()) continue;
    parts.columns.push_back(column_of(spectrum.names[c], spectrum.units[c], spectrum.part_amplitude[c]));
    if (c < panels) {
      const auto [low, high] = span_of(spectrum.part_amplitude[c], spectrum.part_frequency.size());
      auto time = axis_of("time", "s"), along = frequency, amplitude = column;
      time.from = spectrum.part_time.front(), time.to = spectrum.part_time.back();
      along.to = spectrum.part_frequency.back();
      amplitude.decades = true, amplitude.from = low, amplitude.to = high;
      over_time.panels.push_back(
          {.x = time,
           .y = along,
           .lines = {{.table = parts.file, .how = How::image, .z = {.column = int(c) + 3, .least = low}}},
           .colours = ColourScale{amplitude}});
    }
  }
  figure.tables = {std::move(table)};
  auto files = write(folder, figure);
  if (spectrum.part_time.empty()) return files;
  over_time.tables = {std::move(parts)};
  for (auto& file : write(folder, over_time)) files.push_back(std::move(file));
  return files;
}

}  // namespace rosin::app::output
