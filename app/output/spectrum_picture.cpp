/// Pictures of a motion's spectrum and spectrogram.
#include <algorithm>

#include "analysis/cycles/irregular_motion.hpp"
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

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::cycles::IrregularMotion& irregular) {
  auto figure = figure_of(scene, "cycle", "A motion without a period: in time, in the phase plane, and its spectrum");
  figure.width = 940, figure.columns = 2, figure.height = 220;
  const std::size_t coordinates = irregular.coordinate_max.size();
  const auto range = [&](std::size_t c) {
    const auto extent = Extent::of(irregular.columns[c]);
    return extent.high - extent.low;
  };
  std::size_t widest = 0;
  for (std::size_t c = 1; c < coordinates; ++c)
    if (range(c) > range(widest)) widest = c;
  const auto axis = [&](std::size_t c) {
    return axis_of(irregular.names[c], irregular.units[c], Extent::of(irregular.columns[c]));
  };
  const std::size_t velocity = coordinates + widest;
  const int place = int(widest) + 2, speed = int(velocity) + 2;
  auto time = axis_of("time", "s", {0, irregular.time.back()});
  time.from = 0, time.to = irregular.time.back();
  figure.panels = {{.x = time, .y = axis(widest), .lines = {{.table = "cycle.csv", .y = {place}}}},
                   {.x = axis(widest),
                    .y = axis(velocity),
                    .lines = {{.table = "cycle.csv", .x = {place}, .y = {speed}, .look = {.width = 0.6}}}},
                   {.x = time, .y = axis(velocity), .lines = {{.table = "cycle.csv", .y = {speed}}}}};
  if (irregular.density[widest].empty()) return write(folder, figure);
  const auto [low, high] = span_of(irregular.density[widest], irregular.frequency.size());
  const int before = int(std::ranges::count_if(irregular.density.begin(), irregular.density.begin() + long(widest),
                                               [](const auto& density) { return !density.empty(); }));
  auto frequency = axis_of("frequency", "Hz");
  const auto& values = irregular.density[widest];
  const auto last = std::ranges::find_if(values.rbegin(), values.rend(), [low](double value) { return value > low; });
  frequency.from = 0, frequency.to = irregular.frequency[std::size_t(values.rend() - last) - 1];
  auto density = axis_of(irregular.names[widest], irregular.units[widest]);
  density.name = "spectral density", density.symbol = "S";
  density.unit = irregular.density_units[widest];
  density.decades = true, density.from = 0.5 * low, density.to = 2 * high;
  figure.panels.push_back({.x = frequency,
                           .y = density,
                           .lines = {{.table = "cycle-spectrum.csv", .y = {.column = before + 2, .least = low}}}});
  return write(folder, figure);
}

}  // namespace rosin::app::output
