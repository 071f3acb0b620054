/// Runs at an imposed slip rate, least squares on harmonics, and Welch's method on what noise leaves.
#include "analysis/frf_simulation.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

#include "analysis/run.hpp"
#include "core/error.hpp"

namespace rosin::analysis {

using Complex = std::complex<double>;

namespace {

/// The model without slider: the drive imposes the slip rate.
Model imposed(const Model& model) {
  if (model.law->set_valued())
    throw InputError(
        fmt::format("law '{}' sticks exactly: its response in steady slip is the predicted one, and is not "
                    "simulated",
                    model.law->card().name));
  Model alone = model;
  alone.slider = {.mass = 0, .stiffness = infinity, .damping = 0};
  alone.drive = {model.drive.speed.level(), model.drive.normal_load.level(), 0.0};
  return alone;
}

/// The time in which transients of the contact fall to `remainder`.
double settling(const Model& model, double remainder) {
  double slowest = infinity;
  for (const auto& pole : FrictionResponse(model).poles()) slowest = std::min(slowest, -pole.value.real());
  if (!(slowest > 0))
    throw InputError(
        "the contact is unstable by itself, at an imposed slip rate: its spring is softer than friction weakens; no "
        "response can be simulated about steady sliding");
  return std::isinf(slowest) ? 0 : -std::log(remainder) / slowest;
}

struct Harmonics {
  Complex first, second, third;
  double error, coherence;
};

Run record(const Model& model, std::vector<double> times, double tolerance) {
  RunOptions options;
  options.duration = times.back();
  options.times = std::move(times);
  options.tolerance = tolerance;
  options.most_steps = 50'000'000;
  auto run = analysis::run(model, options);
  if (!run.outcome.complete()) throw InputError("the simulation of a response ended early: " + run.outcome.detail);
  return run;
}

std::size_t column(const Run& run, const char* name) {
  return std::size_t(std::ranges::find(run.column_names, name) - run.column_names.begin());
}

Harmonics harmonics(const Model& still, double frequency, double amplitude, double settle, double tolerance) {
  constexpr int cycles = 4, per_cycle = 32;
  const double omega = 2 * std::numbers::pi * frequency, V = still.drive.speed.level();
  Model model = still;
  model.drive.speed = Signal(Signal::Harmonics{V, {{amplitude, omega, 0}}});
  const double begin = std::ceil(settle * frequency) / frequency;
  std::vector<double> times;
  for (int i = 0; i <= cycles * per_cycle; ++i) times.push_back(begin + double(i) / per_cycle / frequency);
  const auto run = record(model, times, tolerance);
  const auto force = column(run, "friction_force");
  const auto& F = run.columns[force];
  // Whole cycles, evenly sampled: harmonics are orthogonal.
  Complex sums[4] = {};
  double squares = 0, mean = 0;
  constexpr int count = cycles * per_cycle;
  for (int i = 0; i < count; ++i) mean += F[std::size_t(i)] / count;
  for (int i = 0; i < count; ++i) {
    const double left = F[std::size_t(i)] - mean;
    squares += left * left / count;
    for (int k = 1; k <= 3; ++k)
      sums[k] += 2.0 / count * left * std::polar(1.0, -k * omega * (times[std::size_t(i)] - begin));
  }
  // What has not settled shows as a change from the first cycle to the last.
  const double unsettled = std::abs(F[count] - F[0]);
  const double solution = force < run.column_error.size() ? run.column_error[force] : 0;
  return {sums[1], sums[2], sums[3], unsettled + solution, squares > 0 ? 0.5 * std::norm(sums[1]) / squares : 0};
}

}  // namespace

SweptFrf simulate_sweep(const Model& model, const SweepOptions& options) {
  const Model still = imposed(model);
  const double V = still.drive.speed.level(), settle = settling(still, 1e-11);
  const double amplitude = options.amplitude * std::abs(V);
  const auto count = options.frequencies.size();
  SweptFrf result;
  for (auto* list : {&result.tangential, &result.at_amplitude}) list->resize(count);
  for (auto* list : {&result.error, &result.second_harmonic, &result.third_harmonic, &result.coherence})
    list->resize(count);
  const auto simulate = [&](std::size_t k) {
    const double f = options.frequencies[k];
    const auto full = harmonics(still, f, amplitude, settle, options.tolerance);
    const auto half = harmonics(still, f, amplitude / 2, settle, options.tolerance);
    const Complex Z = full.first / amplitude, Z_half = half.first / (amplitude / 2);
    result.at_amplitude[k] = Z;
    result.tangential[k] = Z_half + (Z_half - Z) / 3.0;  // odd in ε: the change is ε²
    const double change = std::abs(Z_half - Z);
    result.error[k] = (full.error + 8 * half.error) / (3 * amplitude) + change * change / std::abs(Z_half);
    result.second_harmonic[k] = std::abs(full.second) / std::abs(full.first);
    result.third_harmonic[k] = std::abs(full.third) / std::abs(full.first);
    result.coherence[k] = full.coherence;
  };
  std::atomic<std::size_t> next = 0;
  std::exception_ptr problem;
  std::atomic<bool> failed = false;
  {
    std::vector<std::jthread> workers;
    for (int t = 0; t < options.threads; ++t)
      workers.emplace_back([&] {
        try {
          for (std::size_t k; !failed && (k = next++) < count;) simulate(k);
        } catch (...) {
          if (!failed.exchange(true)) problem = std::current_exception();
        }
      });
  }
  if (problem) std::rethrow_exception(problem);
  return result;
}

NoiseFrf simulate_noise(const Model& model, const NoiseOptions& options) {
  Model moved = imposed(model);
  const double V = moved.drive.speed.level(), settle = settling(moved, 1e-6);
  moved.drive.speed =
      Signal(Signal::Noise{V, {options.amplitude * std::abs(V), options.low, options.high, options.seed}});
  constexpr double rate_over_band = 4;  // half of the sample rate is twice the band: second harmonics are seen
  NoiseFrf result;
  result.sample_rate = rate_over_band * options.high;
  auto welch = options.welch;
  welch.segment = segment_for(options.resolution, result.sample_rate);
  const double hops = welch.segment * (1 - welch.overlap);
  const auto count = std::size_t(std::ceil(welch.segment + hops * (options.averages - 1))) + 1;
  if (count > 20'000'000)
    throw InputError(
        fmt::format("the simulated record would have {} samples; ask for a coarser resolution or a lower "
                    "band",
                    count));
  for (std::size_t i = 0; i < count; ++i) result.time.push_back(settle + double(i) / result.sample_rate);
  auto run = record(moved, result.time, options.tolerance);
  result.slip_rate = std::move(run.columns[column(run, "slip_rate")]);
  result.force = std::move(run.columns[column(run, "friction_force")]);
  CrossSpectra spectra(2, welch);
  const std::vector<std::span<const double>> block = {result.slip_rate, result.force};
  spectra.add(block);
  // A bin within the window's reach of the band's end is driven by leakage only.
  constexpr double reach = 3;
  const double margin = reach * result.sample_rate / welch.segment;
  result.measured = extract_frf(spectra, {}, result.sample_rate,
                                {.from = options.low + margin, .to = options.high - margin, .estimator = "h1"});
  return result;
}

}  // namespace rosin::analysis
