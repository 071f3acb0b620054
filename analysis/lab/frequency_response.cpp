/// The frequency response rig: slip rate is shaken by noise about steady sliding, and friction's answer is taken from
/// what was measured.
///
/// Cabboi, Putelat & Woodhouse (2016). The excitation, the extraction and their errors are those of
/// analysis/response/frf_simulation.hpp and analysis/response/extraction.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/lab/tools.hpp"
#include "analysis/response/frf_simulation.hpp"

namespace rosin::analysis::lab {

namespace {

/// The band asked for, or a decade around the slowest decay of the contact at the imposed slip rate.
std::pair<double, double> band_of(const Task& task, const response::FrictionResponse& response) {
  double slowest = infinity;
  for (const auto& pole : response.poles()) slowest = std::min(slowest, std::abs(pole.value));
  const double turns = std::isfinite(slowest) ? slowest / (2 * std::numbers::pi) : 1;
  const double from = task.settings.number_or("from", 0.2 * turns), to = task.settings.number_or("to", 5 * turns);
  if (!(from < to)) throw InputError(fmt::format("lab.from = {} Hz must be below lab.to = {} Hz", from, to));
  return {from, to};
}

response::MeasuredFrf extract(const Record& seen, double resolution, double from, double to) {
  const double rate = double(seen.time.size() - 1) / (seen.time.back() - seen.time.front());
  response::CrossSpectra spectra(2, {.segment = response::segment_for(resolution, rate)});
  const std::vector<std::span<const double>> block = {seen.column("slip_rate"), seen.column("friction_force")};
  spectra.add(block);
  return response::extract_frf(spectra, {}, rate, {.from = from, .to = std::min(to, 0.45 * rate), .estimator = "h1"});
}

/// Where the real part passes zero from below: slower, friction weakens with speed. NaN if it does not, or if that is
/// noise.
double crossing(const response::MeasuredFrf& m) {
  for (std::size_t k = 1; k < m.frequency.size(); ++k) {
    const double a = m.tangential[k - 1].real(), b = m.tangential[k].real();
    if (a < 0 && b >= 0 && std::min(m.coherence[k - 1], m.coherence[k]) > 0.5)
      return std::lerp(m.frequency[k - 1], m.frequency[k], a / (a - b));
  }
  return std::nan("");
}

Result perform_frequency_response(const Task& task) {
  const auto& settings = task.settings;
  const response::FrictionResponse response(task.model);
  const auto [from, to] = band_of(task, response);
  response::NoiseOptions options;
  options.amplitude = settings.number("amplitude");
  options.low = from, options.high = to;
  options.resolution = settings.number_or("resolution", 0.5 * from);
  options.averages = settings.count("averages");
  options.seed = std::uint64_t(settings.count("seed"));
  const auto plan = response::plan_noise(task.model, options);

  Result result;
  Task run = task;
  run.tolerance = std::max(task.tolerance, options.tolerance);
  record_run(result, run, motion_of(plan.model), motion::Start{}, plan.times);
  // Bins within the window's reach of the band's ends are driven by leakage only.
  const double margin = plan.margin, low = from + margin, high = to - margin;
  const auto measured_in = [&](const Record& seen) { return extract(seen, options.resolution, low, high); };
  read_off(result, task.sensor, [&](const Record& seen) -> std::vector<Reading> {
    const auto m = measured_in(seen);
    return {
        {"lowest_real", "N s/m", "real part of the response at the lower end of the band", m.tangential.front().real(),
         m.standard_error.front()},
        {"highest_real", "N s/m", "real part at the upper end", m.tangential.back().real(), m.standard_error.back()},
        {"crossing_frequency", "Hz", "where the real part passes zero: slower, friction weakens with speed",
         crossing(m), m.resolution},
        {"least_coherence", "1", "least coherence in the band", std::ranges::min(m.coherence)}};
  });
  const auto measured = measured_in(result.record);
  result.warnings.insert(result.warnings.end(), measured.warnings.begin(), measured.warnings.end());

  Table table{
      "response",
      {"frequency", "real", "imaginary", "standard_error", "coherence", "predicted_real", "predicted_imaginary"},
      {"Hz", "N s/m", "N s/m", "N s/m", "1", "N s/m", "N s/m"},
      std::vector<std::vector<double>>(7)};
  const auto panel = [](std::string label, std::string unit) {
    return Panel{.x_label = "frequency",
                 .x_unit = "Hz",
                 .y_label = std::move(label),
                 .y_unit = std::move(unit),
                 .x_decades = true,
                 .curves = {{"measured", {}, {}, true}, {"predicted", {}, {}}}};
  };
  Panel magnitude = panel("magnitude of Z", "N s/m"), phase = panel("phase of Z", "degree");
  const auto add = [](Panel::Curve& curve, double x, double y) { curve.x.push_back(x), curve.y.push_back(y); };
  for (std::size_t k = 0; k < measured.frequency.size(); ++k) {
    const double f = measured.frequency[k];
    const auto Z = measured.tangential[k], predicted = response.tangential({0, 2 * std::numbers::pi * f});
    const double row[] = {
        f, Z.real(), Z.imag(), measured.standard_error[k], measured.coherence[k], predicted.real(), predicted.imag()};
    for (std::size_t c = 0; c < std::size(row); ++c) table.values[c].push_back(row[c]);
    const double degree = 180 / std::numbers::pi;
    add(magnitude.curves[0], f, std::abs(Z)), add(magnitude.curves[1], f, std::abs(predicted));
    add(phase.curves[0], f, degree * std::arg(Z)), add(phase.curves[1], f, degree * std::arg(predicted));
  }
  result.tables.push_back(std::move(table));
  result.panels = {std::move(magnitude), std::move(phase)};
  return result;
}

}  // namespace

Experiment frequency_response() {
  return {.name = "frequency-response",
          .title = "Frequency response rig",
          .settings =
              {{.quantity = {"from", "Hz", {1e-12, 1e12}, "lower end of the band; else around the contact's decay"}},
               {.quantity = {"to", "Hz", {1e-12, 1e12}, "upper end of the band"}},
               {.quantity = {"resolution", "Hz", {1e-12, 1e12}, "width of a bin; else half of the lower end"}},
               {.quantity = {"amplitude", "1", {1e-6, 0.2}, "rms of slip rate over its mean"}, .value = 0.01},
               {.quantity = {"averages", "1", {8, 1e5}, "segments of the record"}, .value = 64.0, .whole = true},
               {.quantity = {"seed", "1", {0, 1e9}, "of the excitation"}, .value = 1.0, .whole = true}},
          .slider = {.mass = 0, .stiffness = infinity, .damping = 0},
          .drive = {.speed = 1e-4, .normal_load = 1.0, .force = 0.0},
          .extra_columns = {},
          .prescribed = {"drive.force", "oscillator.mass", "oscillator.stiffness", "oscillator.damping"},
          .only_slider =
              "the rig imposes the slip rate, so that no machine answers back; of a structure that does, 'rosin frf' "
              "gives the receptance",
          .protocol = perform_frequency_response};
}

}  // namespace rosin::analysis::lab
