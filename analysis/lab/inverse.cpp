/// Force reconstruction: friction from the recorded motion of a known oscillator, F = m ẍ + c ẋ + k x − f.
///
/// Ko & Brockley (1970) measured so. Derivatives come from local polynomials; at each instant the window is the longest
/// whose result agrees, within noise, with those of all shorter ones (intersection of confidence intervals:
/// Goldenshluger & Nemirovski 1997), so that slips stay sharp and stick becomes smooth.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lab/string_inverse.hpp"
#include "analysis/lab/tools.hpp"

namespace rosin::analysis::lab {

namespace {

constexpr int degree = 6;              ///< of the local polynomials
constexpr double agreement = 4.0;      ///< standard deviations within which windows agree
constexpr std::size_t shorter = 3;     ///< windows by which the longest in agreement is undercut: bias falls faster
                                       ///< (sixth power of the length) than noise grows (power −2.5)
constexpr std::size_t neighbours = 6;  ///< samples to either side
constexpr double band_width = 3.0;     ///< standard deviations of the band: 95 % with the bias that agreement may hide

/// Weights of samples −w … w for the value, first and second derivative (per sample²) of the least-squares polynomial
/// at its middle, by Gram polynomials: p_{j+1} = s p_j − β_j p_{j−1}.
std::array<std::vector<double>, 3> local_weights(int w) {
  const auto n = static_cast<std::size_t>(2 * w + 1);
  std::vector<double> before(n, 0.0), now(n, 1.0), next(n);
  std::array<double, 3> middle_before{0, 0, 0}, middle{1, 0, 0};  // p, p′, p″ at s = 0
  std::array<std::vector<double>, 3> weights{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
  double norm_before = 1;
  for (int j = 0; j <= degree; ++j) {
    double norm = 0;
    for (const double p : now) norm += p * p;
    for (std::size_t i = 0; i < n; ++i)
      for (int d = 0; d < 3; ++d) weights[d][i] += middle[d] * now[i] / norm;
    const double beta = j > 0 ? norm / norm_before : 0;
    for (std::size_t i = 0; i < n; ++i) next[i] = (double(i) - w) / w * now[i] - beta * before[i];
    const std::array<double, 3> middle_next{-beta * middle_before[0], middle[0] - beta * middle_before[1],
                                            2 * middle[1] - beta * middle_before[2]};
    before = std::exchange(now, next);
    middle_before = std::exchange(middle, middle_next);
    norm_before = norm;
  }
  for (double& x : weights[1]) x /= w;
  for (double& x : weights[2]) x /= double(w) * w;
  return weights;
}

/// The rms of white noise in samples of something smooth: the least over orders of differences, each by its median, so
/// that sharp slips do not count.
double noise_of(const std::vector<double>& x) {
  double least = infinity, size = 0;
  for (const double value : x) size = std::max(size, std::abs(value));
  auto difference = x;
  double gain = 1;  // of white noise: binomial(2d, d)
  for (int order = 1; order <= 10; ++order) {
    for (std::size_t i = 0; i + 1 < difference.size(); ++i) difference[i] = difference[i + 1] - difference[i];
    difference.pop_back();
    gain *= 2.0 * (2 * order - 1) / order;
    if (order < 2) continue;
    std::vector<double> magnitude;
    for (const double d : difference) magnitude.push_back(std::abs(d));
    const auto middle = magnitude.begin() + static_cast<std::ptrdiff_t>(magnitude.size() / 2);
    std::ranges::nth_element(magnitude, middle);
    constexpr double median_of_normal = 0.674489750196082;
    least = std::min(least, *middle / median_of_normal / std::sqrt(gain));
  }
  return std::max(least, 1e-16 * size);
}

struct Reconstruction {
  std::size_t first;  ///< sample of the record that the first value belongs to
  std::vector<double> velocity, force, band;
};

/// \throws InputError for records that are too short.
Reconstruction reconstruct(const std::vector<double>& x, double h, const oscillators::Slider& slider, double noise) {
  struct Window {
    int w;
    std::vector<double> velocity, force;
    double deviation;
  };
  std::vector<Window> windows;
  const int n = static_cast<int>(x.size());
  for (double wide = 4; wide < 0.2 * n && wide < 600; wide = std::max(wide + 1, 1.25 * wide)) {
    const int w = static_cast<int>(wide);
    auto [value, first, second] = local_weights(w);
    Window window{w, std::vector<double>(value.size()), std::vector<double>(value.size()), 0};
    for (std::size_t i = 0; i < value.size(); ++i) {
      window.velocity[i] = first[i] / h;
      window.force[i] = slider.mass * second[i] / (h * h) + slider.damping * first[i] / h + slider.stiffness * value[i];
      window.deviation += window.force[i] * window.force[i];
    }
    window.deviation = noise * std::sqrt(window.deviation);
    windows.push_back(std::move(window));
  }
  if (windows.size() < 3) throw InputError(fmt::format("a record of {} samples is too short; give it 64 or more", n));
  const int edge = windows.front().w;
  Reconstruction result{static_cast<std::size_t>(edge), {}, {}, {}};
  const auto applied = [&](const std::vector<double>& weights, int first) {
    double sum = 0;
    for (std::size_t j = 0; j < weights.size(); ++j) sum += weights[j] * x[static_cast<std::size_t>(first) + j];
    return sum;
  };
  // The longest window in agreement at each instant.
  const auto count = static_cast<std::size_t>(n - 2 * edge);
  std::vector<std::size_t> longest(count, 0);
  std::vector<double> sharper(count, 0.0);
  for (std::size_t at = 0; at < count; ++at) {
    const int i = edge + static_cast<int>(at);
    double low = -infinity, high = infinity, shortest = 0;
    for (std::size_t k = 0; k < windows.size(); ++k) {
      const auto& window = windows[k];
      if (window.w > i || window.w >= n - i) break;
      const double force = applied(window.force, i - window.w);
      if (k == 0) shortest = force;
      low = std::max(low, force - agreement * window.deviation);
      high = std::min(high, force + agreement * window.deviation);
      // Where not even the two shortest agree, the motion is sharper than they are: their difference is the band.
      if (low > high && k == 1) sharper[at] = std::abs(force - shortest);
      if (low > high) break;
      longest[at] = k;
    }
  }
  // Chance parts windows for a few samples, a jump for more: the median over neighbours tells them apart.
  std::vector<int> widths;
  for (std::size_t at = 0; at < count; ++at) {
    const int i = edge + static_cast<int>(at);
    const std::size_t first = at - std::min(at, neighbours), last = std::min(count, at + neighbours + 1);
    std::vector<std::size_t> around(longest.begin() + static_cast<std::ptrdiff_t>(first),
                                    longest.begin() + static_cast<std::ptrdiff_t>(last));
    std::ranges::sort(around);
    std::size_t chosen = around[around.size() / 2];
    widths.push_back(windows[chosen].w);
    chosen -= std::min(chosen, shorter);
    while (windows[chosen].w > i || windows[chosen].w >= n - i) --chosen;
    const auto& window = windows[chosen];
    result.force.push_back(applied(window.force, i - window.w));
    result.velocity.push_back(applied(window.velocity, i - window.w));
    result.band.push_back(std::max(band_width * window.deviation, chosen == 0 ? sharper[at] : 0));
  }
  // Beside the ends only short windows fit, which know little: what a usual window cannot reach is left out.
  const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
  std::ranges::nth_element(widths, middle);
  const auto cut = static_cast<std::ptrdiff_t>(std::min<std::size_t>(*middle - edge, result.force.size() / 4));
  for (auto* list : {&result.velocity, &result.force, &result.band}) {
    list->erase(list->end() - cut, list->end());
    list->erase(list->begin(), list->begin() + cut);
  }
  result.first += static_cast<std::size_t>(cut);
  return result;
}

double even_interval(const std::vector<double>& t) {
  const double h = (t.back() - t.front()) / double(t.size() - 1);
  for (std::size_t i = 1; i < t.size(); ++i)
    if (std::abs(t[i] - t[i - 1] - h) > 1e-3 * h)
      throw InputError(
          fmt::format("lab.record: times must be evenly spaced, but {} s follows {} s where the mean interval "
                      "is {:.6g} s",
                      t[i], t[i - 1], h));
  return h;
}

/// A motion of the model itself, to be taken for a measured one.
void simulate(Result& result, const Task& task) {
  const auto& settings = task.settings;
  double duration = settings.number_or("duration", 0), skip = settings.number_or("skip", 0);
  if (duration == 0 || !settings.given("skip")) {
    const auto cycle = cycles::find_cycle(task.model, {.tolerance = 1e-6, .multipliers = false});
    constexpr double cycles = 4;
    const double free_period = 2 * std::numbers::pi * std::sqrt(task.model.slider.mass / task.model.slider.stiffness);
    const double period = cycle.metrics.period > 0 ? cycle.metrics.period : 3 * free_period;
    if (duration == 0) duration = cycles * period;
    if (!settings.given("skip") && cycle.metrics.period > 0) skip = cycles * period;
  }
  std::vector<double> times;
  const int samples = settings.count("samples");
  for (int i = 0; i <= samples; ++i) times.push_back(skip + duration * i / samples);
  motion::Start rest;
  rest.kind = motion::Start::Kind::rest;
  Task fine{task};
  fine.tolerance = std::min(task.tolerance, 1e-10);  // second derivatives ask for more than a picture does
  record_run(result, fine, motion_of(task.model), rest, times);
  if (result.outcome.ending == Ending::tolerance_not_met && result.record.time.size() == times.size())
    result.outcome = {};  // the noise that is found says how good it is
}

Result perform_inverse(const Task& task) {
  if (task.string) return inverse_of_string(task);
  Result result;
  const Model& model = task.model;
  const auto& slider = model.slider;
  if (!(slider.mass > 0))
    throw InputError(
        "oscillator.mass = 0: force reconstruction needs the mass of the slider (kg), and the record its motion");
  const bool simulated = !task.motion;
  std::vector<double> truth;
  Record seen;
  if (simulated) {
    simulate(result, task);
    if (!result.outcome.complete()) return result;
    seen = measure(result.record, task.sensor, result.warnings);
    for (const double t : seen.time)
      truth.push_back(at_time(result.record.time, result.record.column("friction_force"), t));
  } else {
    seen = {task.motion->time, {"displacement"}, {"m"}, {task.motion->value}, {}, {}};
    if (seen.time.size() < 64)
      throw InputError(fmt::format("lab.record has {} samples; give it 64 or more", seen.time.size()));
  }
  const auto &t = seen.time, &x = seen.column("displacement");
  const double found = noise_of(x), noise = std::max(found, task.settings.number_or("noise", 0));
  auto rebuilt = reconstruct(x, even_interval(t), slider, noise);
  result.plan.push_back(
      fmt::format("derivatives by local polynomials of degree {} over windows that noise of {:.3g} m "
                  "decides, instant by instant",
                  degree, noise));

  Record& record = result.record;
  const auto count = rebuilt.force.size();
  const auto part = [&](const std::vector<double>& all) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(rebuilt.first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  record = {part(t), {}, {}, {}, {}, {}};
  std::vector<double> force = rebuilt.force, slip_rate, low, high;
  double size = 0;
  for (const double F : force) size = std::max(size, std::abs(F));
  constexpr double arithmetic = 1e-10;  // rounding, and to what a simulated motion is known
  for (double& band : rebuilt.band) band += arithmetic * size;
  for (std::size_t i = 0; i < count; ++i) {
    force[i] -= model.drive.force.value(record.time[i]);
    slip_rate.push_back(model.drive.speed.value(record.time[i]) - rebuilt.velocity[i]);
    low.push_back(force[i] - rebuilt.band[i]);
    high.push_back(force[i] + rebuilt.band[i]);
  }
  record.add("displacement", "m", part(x));
  record.add("velocity", "m/s", rebuilt.velocity);
  record.add("slip_rate", "m/s", slip_rate);
  record.add("friction_force", "N", force);
  record.add("band", "N", rebuilt.band);
  const auto rms = [](const std::vector<double>& list, auto f) {
    double sum = 0;
    for (std::size_t i = 0; i < list.size(); ++i) sum += f(i) * f(i);
    return std::sqrt(sum / double(list.size()));
  };
  std::size_t largest = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (std::abs(force[i]) > std::abs(force[largest])) largest = i;
  const double band = rms(rebuilt.band, [&](std::size_t i) { return rebuilt.band[i]; });
  constexpr double scatter = 3;  // of a median of correlated differences, over the root of their number
  result.readings = {{"noise", "m", "rms of the white noise found in the displacement", found,
                      scatter * found / std::sqrt(double(x.size()))},
                     {"force_max", "N", "largest friction force", std::abs(force[largest]), rebuilt.band[largest]},
                     {"band", "N", "rms of the half-width of the confidence band", band},
                     {"impulse", "N s", "integral of the reconstructed force", 0}};
  for (std::size_t i = 1; i < count; ++i)
    result.readings.back().value += 0.5 * (force[i] + force[i - 1]) * (record.time[i] - record.time[i - 1]);
  result.readings.back().error = band * (record.time.back() - record.time.front());

  Panel history{.x_label = "time",
                .x_unit = "s",
                .y_label = "friction force F",
                .y_unit = "N",
                .curves = {{.label = "reconstructed", .x = record.time, .y = force, .low = low, .high = high}}};
  if (simulated) {
    truth = part(truth);
    std::size_t covered = 0;
    for (std::size_t i = 0; i < count; ++i) covered += std::abs(force[i] - truth[i]) <= rebuilt.band[i];
    result.readings.push_back({"error_rms", "N", "rms of the difference to the true force",
                               rms(truth, [&](std::size_t i) { return force[i] - truth[i]; })});
    double worst = 0;
    for (std::size_t i = 0; i < count; ++i) worst = std::max(worst, std::abs(force[i] - truth[i]));
    result.readings.push_back({"error_max", "N", "largest difference to the true force", worst});
    result.readings.push_back({"coverage", "1", "part of the record in which the true force lies within the band",
                               double(covered) / double(count)});
    record.add("true_friction_force", "N", truth);
    history.curves.push_back({"true", record.time, truth});
  }
  result.panels = {std::move(history),
                   {.x_label = "slip rate v",
                    .x_unit = "m/s",
                    .y_label = "friction force F",
                    .y_unit = "N",
                    .curves = {{"", slip_rate, force}}}};
  return result;
}

}  // namespace

Experiment inverse() {
  return {
      .name = "inverse",
      .title = "Force reconstruction from motion",
      .settings =
          {{.quantity = {"duration",
                         "s",
                         {1e-12, 1e12},
                         "length of the simulated motion; else four periods, of a string what is forgotten and ten"}},
           {.quantity = {"skip", "s", {0, 1e12}, "time before the record begins; else four periods, of a string 0"}},
           {.quantity = {"samples", "1", {64, 1e7}, "samples of the simulated motion"}, .value = 8000.0, .whole = true},
           {.quantity = {"noise",
                         "m",
                         {0, 1e3},
                         "rms noise of the displacement if it is known to be larger than "
                         "what the record shows"}}},
      .slider = {.mass = 1, .stiffness = 100, .damping = 0},
      .drive = {.speed = 1e-3, .normal_load = 1.0, .force = 0.0},
      .extra_columns = {},
      .prescribed = {},
      .takes_motion = true,
      .takes_string = true,
      .only_slider =
          "friction follows from the motion of one mass whose spring and damper are known; of a structure 'rosin fit' "
          "takes the recorded motion, type = \"motion\"",
      .protocol = perform_inverse};
}

}  // namespace rosin::analysis::lab
