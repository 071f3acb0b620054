/// The steady motion under a sine by Newton's method on its period, its harmonics, and Welch's method on what noise
/// leaves.
#include "analysis/response/frf_simulation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "analysis/motion/run.hpp"
#include "core/error.hpp"
#include "core/linear_solve.hpp"
#include "core/workers.hpp"
#include "oscillators/slider_system.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::response {

using Complex = std::complex<double>;

namespace {

/// The model without slider: the drive imposes the slip rate.
Model imposed(const Model& model) {
  Model alone = model;
  alone.slider = {.mass = 0, .stiffness = infinity, .damping = 0};
  alone.drive = {model.drive.speed.level(), model.drive.normal_load.level(), 0.0};
  return alone;
}

/// Rate at which transients of the contact fall, 1/s; infinite if it has none.
double slowest_decay(const Model& model) {
  double slowest = infinity;
  for (const auto& pole : FrictionResponse(model).poles()) slowest = std::min(slowest, -pole.value.real());
  if (!(slowest > 0))
    throw InputError(
        "the contact is unstable by itself, at an imposed slip rate: its spring is softer than friction weakens; no "
        "response can be simulated about steady sliding");
  return slowest;
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

/// The force over one period of the steady motion under a periodic drive, at evenly spaced times from 0: Newton's
/// method on the map over a period, with its derivative from the variational equations. No transient is waited for.
std::vector<double> periodic_force(const Model& model, double period, int samples, double tolerance) {
  const oscillators::SliderSystem system(model);
  const int n = system.size();
  std::vector<double> y = system.steady(0), force(std::size_t(samples), 0.0);
  const auto sample_time = [&](int i) { return i == samples ? period : period * i / samples; };
  if (n == 0) {  // friction follows at once
    for (int i = 0; i < samples; ++i) force[std::size_t(i)] = system.observe(sample_time(i), y.data()).friction_force;
    return force;
  }
  std::vector<double> mass(y.size()), scale(y.size()), S;
  system.mass(0, mass.data());
  std::vector<int> moving;  // unknowns with mass; the others follow from them
  for (int i = 0; i < n; ++i)
    if (mass[std::size_t(i)] > 0) moving.push_back(i);
  const auto m = Eigen::Index(moving.size());
  solvers::steps::Collocation solver(system, tolerance);
  constexpr int most = 20;
  double before = infinity;
  for (int iteration = 0; iteration < most; ++iteration) {
    S.assign(std::size_t(n * n), 0.0);
    for (int i = 0; i < n; ++i) S[std::size_t(i * n + i)] = 1;
    if (!solver.start(0, y)) throw InputError("the simulation of a response cannot begin");
    y = solver.state();
    for (int i = 0; i < samples; ++i) {
      force[std::size_t(i)] = system.observe(solver.time(), solver.state().data()).friction_force;
      while (solver.time() < sample_time(i + 1)) {
        if (const auto outcome = solver.step(sample_time(i + 1)); !outcome.complete())
          throw InputError("the simulation of a response ended early: " + outcome.detail);
        solver.propagate(S, n);
      }
    }
    Eigen::MatrixXd matrix(m, m);
    Eigen::VectorXd defect(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const int row = moving[std::size_t(i)];
      defect[i] = solver.state()[std::size_t(row)] - y[std::size_t(row)];
      for (Eigen::Index k = 0; k < m; ++k)
        matrix(i, k) = (i == k ? 1 : 0) - S[std::size_t(row * n + moving[std::size_t(k)])];
    }
    const Eigen::VectorXd change = solve_linear(matrix, defect);
    system.scale(y.data(), scale.data());
    double size = 0;
    for (Eigen::Index i = 0; i < m; ++i) {
      const auto row = std::size_t(moving[std::size_t(i)]);
      y[row] += change[i];
      size = std::max(size, std::abs(change[i]) / scale[row]);
    }
    // Closed to rounding: the next correction would be of the size of this one's square, or no smaller at all.
    if (size < 1e-14 || (size < 1e-10 && size >= 0.1 * before)) return force;
    if (!std::isfinite(size)) break;
    before = size;
  }
  throw InputError("no steady motion was found under the sine; lower frf.simulate.amplitude");
}

Harmonics harmonics(const Model& still, Input input, double frequency, double amplitude, double tolerance) {
  constexpr int count = 32;
  const double omega = 2 * std::numbers::pi * frequency;
  Model model = still;
  Signal& moved = input == Input::slip_rate ? model.drive.speed : model.drive.normal_load;
  moved = Signal(Signal::Harmonics{moved.level(), {{amplitude, omega, 0}}});
  const auto coarse = periodic_force(model, 1 / frequency, count, tolerance);
  const auto F = periodic_force(model, 1 / frequency, count, 0.01 * tolerance);
  // A whole period, evenly sampled: harmonics are orthogonal.
  Complex sums[4] = {};
  double squares = 0, mean = 0, difference = 0;
  for (const double f : F) mean += f / count;
  for (std::size_t i = 0; i < count; ++i) {
    const double left = F[i] - mean;
    squares += left * left / count;
    difference = std::max(difference, std::abs(F[i] - coarse[i]));
    for (int k = 1; k <= 3; ++k)
      sums[k] += 2.0 / count * left * std::polar(1.0, -2 * std::numbers::pi * k * double(i) / count);
  }
  // Friction that does not answer at all leaves rounding.
  const double rounding = 1e-14 * std::abs(mean);
  for (auto& sum : sums)
    if (std::abs(sum) <= rounding) sum = 0;
  const double coherence = squares > rounding * rounding ? 0.5 * std::norm(sums[1]) / squares : 1;
  return {sums[1], sums[2], sums[3], 2 * difference + rounding, coherence};
}

/// The force's answer to one input: two amplitudes, of which what grows as the square is extrapolated away.
struct Answer {
  Complex at_amplitude, linear;
  double error, second_harmonic, third_harmonic, coherence;
};

Answer answer(const Model& still, Input input, double frequency, const SweepOptions& options) {
  const Signal& moved = input == Input::slip_rate ? still.drive.speed : still.drive.normal_load;
  const double amplitude = options.amplitude * std::abs(moved.level());
  const auto full = harmonics(still, input, frequency, amplitude, options.tolerance);
  const auto half = harmonics(still, input, frequency, amplitude / 2, options.tolerance);
  const Complex H = full.first / amplitude, H_half = half.first / (amplitude / 2);
  const double change = std::abs(H_half - H);
  const auto over = [](double part, const Complex& whole) { return part > 0 ? part / std::abs(whole) : 0; };
  return {.at_amplitude = H,
          .linear = H_half + (H_half - H) / 3.0,
          .error = (full.error + 8 * half.error) / (3 * amplitude) + 4 * change * over(change, H_half),
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
  slowest_decay(still);  // a steady motion that is unstable would be found too
  const auto count = options.frequencies.size();
  SweptFrf result;
  for (auto* list : {&result.tangential, &result.at_amplitude}) list->resize(count);
  for (auto* list : {&result.error, &result.second_harmonic, &result.third_harmonic, &result.coherence})
    list->resize(count);
  for (auto* list : {&result.matrix, &result.matrix_error}) list->resize(options.rig.matrix ? count : 0);
  const auto simulate = [&](std::size_t k) {
    const double f = options.frequencies[k];
    const Complex s(0, 2 * std::numbers::pi * f);
    const auto by_slip_rate = answer(still, Input::slip_rate, f, options);
    result.at_amplitude[k] = by_slip_rate.at_amplitude + options.rig.sensor_mass * s;
    result.tangential[k] = by_slip_rate.linear + options.rig.sensor_mass * s;
    result.error[k] = by_slip_rate.error;
    result.second_harmonic[k] = by_slip_rate.second_harmonic;
    result.third_harmonic[k] = by_slip_rate.third_harmonic;
    result.coherence[k] = by_slip_rate.coherence;
    if (!options.rig.matrix) return;
    const auto by_load = answer(still, Input::normal_load, f, options);
    result.matrix[k] = response_matrix(s, result.tangential[k], by_load.linear, options.rig.normal);
    result.matrix_error[k] = matrix_error(s, by_slip_rate.error, by_load.error, options.rig.normal);
  };
  in_parallel(options.threads, count, simulate);
  warn(result, options);
  return result;
}

namespace {

motion::Run record(const Model& model, const std::vector<double>& times, double tolerance) {
  motion::RunOptions options;
  options.duration = times.back();
  options.times = times;
  options.tolerance = tolerance;
  options.most_steps = 50'000'000;
  auto run = analysis::motion::run(model, options);
  end_if_stopped();
  if (!run.outcome.complete()) throw InputError("the simulation of a response ended early: " + run.outcome.detail);
  return run;
}

std::size_t column(const motion::Run& run, const char* name) {
  return std::size_t(std::ranges::find(run.column_names, name) - run.column_names.begin());
}

}  // namespace

NoisePlan plan_noise(const Model& model, const NoiseOptions& options) {
  NoisePlan plan{.model = imposed(model), .times = {}, .sample_rate = 0, .margin = 0, .welch = options.welch};
  auto& drive = plan.model.drive;
  const double settle = -std::log(1e-6) / slowest_decay(plan.model);
  const auto noise = [&](double mean, std::uint64_t seed) {
    return Signal(Signal::Noise{mean, {options.amplitude * std::abs(mean), options.low, options.high, seed}});
  };
  drive.speed = noise(drive.speed.level(), options.seed);
  if (options.rig.matrix) drive.normal_load = noise(drive.normal_load.level(), ~options.seed);
  constexpr double rate_over_band = 4;  // half of the sample rate is twice the band: second harmonics are seen
  constexpr double reach = 3;           // of the window, in bins
  plan.sample_rate = rate_over_band * options.high;
  plan.welch.segment = segment_for(options.resolution, plan.sample_rate);
  plan.margin = reach * plan.sample_rate / plan.welch.segment;
  const double hops = plan.welch.segment * (1 - plan.welch.overlap);
  const auto count = std::size_t(std::ceil(plan.welch.segment + hops * (options.averages - 1))) + 1;
  if (count > 20'000'000)
    throw InputError(
        fmt::format("the simulated record would have {} samples; ask for a coarser resolution or a lower "
                    "band",
                    count));
  for (std::size_t i = 0; i < count; ++i) plan.times.push_back(settle + double(i) / plan.sample_rate);
  return plan;
}

NoiseFrf simulate_noise(const Model& model, const NoiseOptions& options) {
  const auto plan = plan_noise(model, options);
  NoiseFrf result;
  result.sample_rate = plan.sample_rate;
  result.time = plan.times;
  auto run = record(plan.model, plan.times, options.tolerance);
  result.slip_rate = std::move(run.columns[column(run, "slip_rate")]);
  result.force = std::move(run.columns[column(run, "friction_force")]);
  for (std::size_t i = 0; options.rig.sensor_mass > 0 && i < result.time.size(); ++i)
    result.force[i] += options.rig.sensor_mass * plan.model.drive.speed.rate(result.time[i]);
  std::vector<std::span<const double>> block = {result.slip_rate, result.force};
  Channels channels;
  if (options.rig.matrix) {
    for (const double t : result.time) result.normal_load.push_back(plan.model.drive.normal_load.value(t));
    block.emplace_back(result.normal_load);
    channels.second = Channels::Second::normal_load;
  }
  CrossSpectra spectra(channels.count(), plan.welch);
  spectra.add(block);
  auto& measured = result.measured;
  measured = extract_frf(spectra, channels, result.sample_rate,
                         {.from = options.low + plan.margin, .to = options.high - plan.margin, .estimator = "h1"});
  for (std::size_t k = 0; options.rig.normal && k < measured.frequency.size(); ++k) {
    const Complex s(0, 2 * std::numbers::pi * measured.frequency[k]);
    auto &H = measured.matrix[k], &error = measured.matrix_error[k];
    H = response_matrix(s, H.tt, H.tn, options.rig.normal);
    error = matrix_error(s, error.tt.real(), error.tn.real(), options.rig.normal);
  }
  return result;
}

}  // namespace rosin::analysis::response
