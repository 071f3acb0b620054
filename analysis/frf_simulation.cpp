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

/// The errors of response_matrix() where those of its arguments are independent; the normal contact is exact.
ResponseMatrix matrix_error(Complex s, double by_slip_rate, double by_load,
                            const std::optional<NormalContact>& contact) {
  if (!contact) return {by_slip_rate, by_load, 0, 0};
  const auto factor = response_matrix(s, 0, by_load, contact);
  return {std::hypot(by_slip_rate, std::abs(factor.tt)), std::abs(factor.tn), 0, 0};
}

enum class Input { slip_rate, normal_load };

/// What a sine in one input leaves in the force.
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

Harmonics harmonics(const Model& still, Input input, double frequency, double amplitude, double settle,
                    double tolerance) {
  constexpr int cycles = 4, per_cycle = 32;
  const double omega = 2 * std::numbers::pi * frequency;
  Model model = still;
  Signal& moved = input == Input::slip_rate ? model.drive.speed : model.drive.normal_load;
  moved = Signal(Signal::Harmonics{moved.level(), {{amplitude, omega, 0}}});
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
  // Friction that does not answer at all leaves rounding.
  const double rounding = 1e-15 * count * std::abs(mean);
  for (auto& sum : sums)
    if (std::abs(sum) <= rounding) sum = 0;
  // What has not settled shows as a change from the first cycle to the last.
  const double unsettled = std::abs(F[count] - F[0]);
  const double solution = force < run.column_error.size() ? run.column_error[force] : 0;
  const double coherence = squares > rounding * rounding ? 0.5 * std::norm(sums[1]) / squares : 1;
  return {sums[1], sums[2], sums[3], unsettled + solution, coherence};
}

/// The force's answer to one input: two amplitudes, of which what grows as the square is extrapolated away.
struct Answer {
  Complex at_amplitude, linear;
  double error, second_harmonic, third_harmonic, coherence;
};

Answer answer(const Model& still, Input input, double frequency, const SweepOptions& options, double settle) {
  const Signal& moved = input == Input::slip_rate ? still.drive.speed : still.drive.normal_load;
  const double amplitude = options.amplitude * std::abs(moved.level());
  const auto full = harmonics(still, input, frequency, amplitude, settle, options.tolerance);
  const auto half = harmonics(still, input, frequency, amplitude / 2, settle, options.tolerance);
  const Complex H = full.first / amplitude, H_half = half.first / (amplitude / 2);
  const double change = std::abs(H_half - H);
  const auto over = [](double part, const Complex& whole) { return part > 0 ? part / std::abs(whole) : 0; };
  return {.at_amplitude = H,
          .linear = H_half + (H_half - H) / 3.0,
          .error = (full.error + 8 * half.error) / (3 * amplitude) + change * over(change, H_half),
          .second_harmonic = over(std::abs(full.second), full.first),
          .third_harmonic = over(std::abs(full.third), full.first),
          .coherence = full.coherence};
}

void warn(SweptFrf& result, const SweepOptions& options) {
  constexpr double much = 0.05;
  const auto worst = std::ranges::max_element(result.second_harmonic);
  if (*worst > much)
    result.warnings.push_back(fmt::format(
        "the second harmonic of the force reaches {:.2g} of the first, at {:.6g} Hz: the response at an amplitude of "
        "{:g} is not that of small changes, and the extrapolation to none is uncertain; lower frf.simulate.amplitude",
        *worst, options.frequencies[std::size_t(worst - result.second_harmonic.begin())], options.amplitude));
  if (const double least = std::ranges::min(result.coherence); least < 0.99)
    result.warnings.push_back(fmt::format("only {:.3g} of the force's variance follows the sine", least));
}

}  // namespace

SweptFrf simulate_sweep(const Model& model, const SweepOptions& options) {
  const Model still = imposed(model);
  const double settle = settling(still, 1e-11);
  const auto count = options.frequencies.size();
  SweptFrf result;
  for (auto* list : {&result.tangential, &result.at_amplitude}) list->resize(count);
  for (auto* list : {&result.error, &result.second_harmonic, &result.third_harmonic, &result.coherence})
    list->resize(count);
  for (auto* list : {&result.matrix, &result.matrix_error}) list->resize(options.rig.matrix ? count : 0);
  const auto simulate = [&](std::size_t k) {
    const double f = options.frequencies[k];
    const Complex s(0, 2 * std::numbers::pi * f);
    const auto by_slip_rate = answer(still, Input::slip_rate, f, options, settle);
    result.at_amplitude[k] = by_slip_rate.at_amplitude + options.rig.sensor_mass * s;
    result.tangential[k] = by_slip_rate.linear + options.rig.sensor_mass * s;
    result.error[k] = by_slip_rate.error;
    result.second_harmonic[k] = by_slip_rate.second_harmonic;
    result.third_harmonic[k] = by_slip_rate.third_harmonic;
    result.coherence[k] = by_slip_rate.coherence;
    if (!options.rig.matrix) return;
    const auto by_load = answer(still, Input::normal_load, f, options, settle);
    result.matrix[k] = response_matrix(s, result.tangential[k], by_load.linear, options.rig.normal);
    result.matrix_error[k] = matrix_error(s, by_slip_rate.error, by_load.error, options.rig.normal);
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
  warn(result, options);
  return result;
}

NoiseFrf simulate_noise(const Model& model, const NoiseOptions& options) {
  Model moved = imposed(model);
  const double V = moved.drive.speed.level(), settle = settling(moved, 1e-6);
  const auto noise = [&](double mean, std::uint64_t seed) {
    return Signal(Signal::Noise{mean, {options.amplitude * std::abs(mean), options.low, options.high, seed}});
  };
  moved.drive.speed = noise(V, options.seed);
  if (options.rig.matrix) moved.drive.normal_load = noise(moved.drive.normal_load.level(), ~options.seed);
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
  for (std::size_t i = 0; options.rig.sensor_mass > 0 && i < count; ++i)
    result.force[i] += options.rig.sensor_mass * moved.drive.speed.rate(result.time[i]);
  std::vector<std::span<const double>> block = {result.slip_rate, result.force};
  Channels channels;
  if (options.rig.matrix) {
    for (const double t : result.time) result.normal_load.push_back(moved.drive.normal_load.value(t));
    block.emplace_back(result.normal_load);
    channels.second = Channels::Second::normal_load;
  }
  CrossSpectra spectra(channels.count(), welch);
  spectra.add(block);
  // A bin within the window's reach of the band's end is driven by leakage only.
  constexpr double reach = 3;
  const double margin = reach * result.sample_rate / welch.segment;
  auto& measured = result.measured;
  measured = extract_frf(spectra, channels, result.sample_rate,
                         {.from = options.low + margin, .to = options.high - margin, .estimator = "h1"});
  for (std::size_t k = 0; options.rig.normal && k < measured.frequency.size(); ++k) {
    const Complex s(0, 2 * std::numbers::pi * measured.frequency[k]);
    auto &H = measured.matrix[k], &error = measured.matrix_error[k];
    H = response_matrix(s, H.tt, H.tn, options.rig.normal);
    error = matrix_error(s, error.tt.real(), error.tn.real(), options.rig.normal);
  }
  return result;
}

}  // namespace rosin::analysis
