/// Records, times, readings and errors common to experiments.
#include "analysis/lab/tools.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/curve.hpp"
#include "analysis/stability.hpp"

namespace rosin::analysis::lab {

namespace {

constexpr int repeats = 24;  ///< measurements with other noise, for the error of a reading

/// Every second sample, and all breaks.
Record thinned(const Record& record) {
  Record thin{.time = {}, .names = record.names, .units = record.units, .columns = {}, .breaks = record.breaks};
  thin.columns.resize(record.columns.size());
  std::size_t since = 0;
  for (std::size_t i = 0; i < record.time.size(); ++i, ++since) {
    const bool kept = std::ranges::binary_search(record.breaks, record.time[i]);
    if (kept) since = 0;
    if (since % 2 != 0 && i + 1 < record.time.size()) continue;
    thin.time.push_back(record.time[i]);
    for (std::size_t c = 0; c < record.columns.size(); ++c) thin.columns[c].push_back(record.columns[c][i]);
  }
  return thin;
}

}  // namespace

void record_run(Result& result, const Task& task, const Model& model, const Start& start,
                const std::vector<double>& times) {
  RunOptions options;
  options.times = times;
  options.duration = times.back();
  options.start = start;
  options.tolerance = task.tolerance;
  auto run = analysis::run(model, options);
  result.outcome = run.outcome;
  result.events = std::move(run.events);
  result.record = {
      std::move(run.time), std::move(run.column_names), std::move(run.column_units), std::move(run.columns), {}};
  result.plan.push_back(fmt::format("solver {}, {} steps; {}", run.solver, run.cost.steps, run.why));
  if (result.record.time.size() < 2) throw NothingRecorded{std::move(result)};
}

void record_curve(Result& result, const Model& model, const std::vector<double>& times,
                  const std::vector<double>& slip_rates) {
  const auto& law = *model.law;
  std::vector<std::vector<double>> columns(5 + law.states().size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double N = model.drive.normal_load.value(times[i]), v = slip_rates[i];
    const double mu = v == 0 ? 0 : std::copysign(law.steady_friction({std::abs(v), N}).friction, v);
    const double seen[] = {0, 0, v, N * mu, mu};
    for (int c = 0; c < 5; ++c) columns[c].push_back(seen[c]);
    if (law.has_states()) {
      const auto state = law.steady({v, N});
      for (std::size_t s = 0; s < state.size(); ++s) columns[5 + s].push_back(state[s]);
    }
  }
  result.record = {times,
                   {"displacement", "velocity", "slip_rate", "friction_force", "friction_coefficient"},
                   {"m", "m/s", "m/s", "N", "1"},
                   std::move(columns),
                   {}};
  for (const auto& state : law.states()) {
    result.record.names.push_back(state.name);
    result.record.units.push_back(state.unit);
  }
  result.plan.push_back("friction without memory follows the imposed slip rate: nothing is integrated");
}

bool memoryless(const Model& model) { return !model.law->has_states() || model.lambda == 0; }

bool rigid_machine(const Model& model) {
  return model.slider.mass == 0 && std::isinf(model.slider.stiffness) && !model.contact_stiffness.present();
}

double settling_time(Model model, double V) {
  if (memoryless(model) && rigid_machine(model)) return 0;
  model.drive.speed = V;
  model.drive.force = 0.0;
  const auto found = stability(model);
  if (found.eigenvalues.empty()) return 0;
  return found.eigenvalues.front().real() < 0 ? -1 / found.eigenvalues.front().real() : infinity;
}

void append_times(std::vector<double>& times, double begin, double duration, int count) {
  constexpr double bend = 14;  // the first step is about e^−bend of the last
  const auto append = [&](double t) {
    if (t > times.back()) times.push_back(t);  // late in a record short intervals may lie below its resolution
  };
  for (int i = 1; i < count; ++i) append(begin + duration * std::expm1(bend * i / count) / std::expm1(bend));
  append(begin + duration * (1 - 1e-9));  // what has been reached before the protocol jumps
  append(begin + duration);
}

std::vector<double> driven_way(const std::vector<double>& time, const Signal& speed) {
  std::vector<double> way(time.size());
  for (std::size_t i = 1; i < time.size(); ++i)
    way[i] = way[i - 1] + speed.value(time[i - 1]) * (time[i] - time[i - 1]);
  return way;
}

SteadyRange steady_range(const FrictionLaw& law, double normal_load, double low, double high) {
  const auto at = [&](double v) { return law.steady_friction({v, normal_load}).friction; };
  SteadyRange range{std::min(at(low), at(high)), std::max(at(low), at(high)), std::nullopt, std::nullopt, 0};
  for (const auto& e : steady_extrema(law, low, high, normal_load)) {
    auto& inner = e.maximum ? range.maximum : range.minimum;
    const double mu = e.friction_coefficient;
    if (inner && (e.maximum ? mu <= *inner : mu >= *inner)) continue;
    inner = mu;
    if (e.maximum) range.maximum_at = e.slip_rate;
  }
  range.least = std::min(range.least, range.minimum.value_or(range.least));
  range.most = std::max(range.most, range.maximum.value_or(range.most));
  const bool flat = range.most - range.least < 1e-12 * range.most;
  if (flat) range.minimum = range.least;
  return range;
}

std::optional<double> static_limit(const FrictionLaw& law, double normal_load, std::span<const double> state) {
  if (!law.set_valued()) return std::nullopt;
  return law.static_limit(
      normal_load, state.empty() && law.has_states() ? law.rest(normal_load) : std::vector(state.begin(), state.end()));
}

void read_off(Result& result, const Sensor& sensor, const Reader& reader) {
  const Record truth = std::move(result.record);
  result.record = measure(truth, sensor, result.warnings);
  auto readings = reader(result.record);
  const auto ideal = reader(truth);
  if (sensor.ideal()) {
    const auto coarse = reader(thinned(truth));
    for (std::size_t i = 0; i < readings.size(); ++i)
      readings[i].error += std::abs(readings[i].value - coarse[i].value);
  } else {
    std::vector<double> squares(readings.size());
    for (int k = 1; k <= repeats; ++k) {
      Sensor again = sensor;
      again.seed = sensor.seed + 0x5DEECE66Du * static_cast<std::uint64_t>(k);
      std::vector<std::string> unheard;
      const auto repeated = reader(measure(truth, again, unheard));
      for (std::size_t i = 0; i < readings.size(); ++i)
        squares[i] += std::pow(repeated[i].value - ideal[i].value, 2) / repeats;
    }
    for (std::size_t i = 0; i < readings.size(); ++i) readings[i].error += std::sqrt(squares[i]);
  }
  result.readings.insert(result.readings.end(), readings.begin(), readings.end());
}

std::pair<std::size_t, std::size_t> between(const std::vector<double>& time, double begin, double end) {
  const auto first = std::ranges::lower_bound(time, begin), last = std::ranges::lower_bound(time, end);
  return {static_cast<std::size_t>(first - time.begin()), static_cast<std::size_t>(last - time.begin())};
}

double level(const std::vector<double>& time, const std::vector<double>& x, double begin, double end) {
  const auto [first, last] = between(time, end - 0.1 * (end - begin), end);
  if (first == last) return last > 0 ? x[last - 1] : std::nan("");
  double sum = 0;
  for (std::size_t i = first; i < last; ++i) sum += x[i];
  return sum / double(last - first);
}

Extreme extreme(const std::vector<double>& time, const std::vector<double>& x, std::size_t first, std::size_t last,
                bool maximum) {
  if (first >= last) return {std::nan(""), std::nan("")};
  const auto above = [&](std::size_t i, std::size_t j) { return maximum ? x[i] > x[j] : x[i] < x[j]; };
  std::size_t best = first;
  for (std::size_t i = first; i < last; ++i)
    if (above(i, best)) best = i;
  if (best == first || best + 1 == last) return {time[best], x[best]};
  const double a = time[best - 1] - time[best], b = time[best + 1] - time[best];
  const double fa = x[best - 1] - x[best], fb = x[best + 1] - x[best];
  const double curvature = (fa / a - fb / b) / (a - b), slope = fa / a - curvature * a;
  if (curvature == 0) return {time[best], x[best]};
  const double shift = std::clamp(-slope / (2 * curvature), a, b);
  return {time[best] + shift, x[best] + (slope + curvature * shift) * shift};
}

Line fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  const double n = double(x.size());
  if (x.size() < 2) return {std::nan(""), std::nan(""), std::nan("")};
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0, residual = 0;
  for (std::size_t i = 0; i < x.size(); ++i) mean_x += x[i] / n, mean_y += y[i] / n;
  for (std::size_t i = 0; i < x.size(); ++i)
    xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
  const double slope = xy / xx, offset = mean_y - slope * mean_x;
  for (std::size_t i = 0; i < x.size(); ++i) residual += std::pow(y[i] - offset - slope * x[i], 2);
  return {offset, slope, x.size() > 2 ? std::sqrt(residual / (n - 2) / xx) : infinity};
}

double at_time(const std::vector<double>& time, const std::vector<double>& x, double t) {
  const auto next = std::ranges::upper_bound(time, t);
  if (next == time.begin()) return x.front();
  if (next == time.end()) return x.back();
  const auto i = static_cast<std::size_t>(next - time.begin());
  return std::lerp(x[i - 1], x[i], (t - time[i - 1]) / (time[i] - time[i - 1]));
}

}  // namespace rosin::analysis::lab
