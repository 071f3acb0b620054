/// Records, times, readings and errors common to experiments.
#include "analysis/lab/tools.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/steady/curve.hpp"
#include "core/random.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::lab {

namespace {

constexpr double rounding = 4e-16;  ///< of a number, relative
constexpr int repeats = 24;         ///< measurements with other noise, for the error of a reading
constexpr int patterns = 8;         ///< in which the errors of columns may add up in a reading

/// The samples that `kept` says, the first, the last and all breaks among them.
template <class Kept>
Record part_of(const Record& record, Kept kept) {
  Record part = record;
  part.time.clear();
  for (auto& column : part.columns) column.clear();
  for (std::size_t i = 0; i < record.time.size(); ++i) {
    const bool needed =
        i == 0 || i + 1 == record.time.size() || std::ranges::binary_search(record.breaks, record.time[i]);
    if (!kept(i) && !needed) continue;
    part.time.push_back(record.time[i]);
    for (std::size_t c = 0; c < record.columns.size(); ++c) part.columns[c].push_back(record.columns[c][i]);
  }
  return part;
}

/// The record with its columns moved by as much as their errors, this way or that in each of a few pieces between
/// breaks, because errors of integration change slowly.
Record moved(const Record& record, std::uint64_t pattern) {
  constexpr std::size_t pieces = 4;
  Record other = record;
  const auto& t = record.time;
  std::size_t first = 0;
  while (first < t.size()) {
    const auto next = std::ranges::upper_bound(record.breaks, t[first]);
    const auto last =
        next == record.breaks.end() ? t.size() : std::size_t(std::ranges::lower_bound(t, *next) - t.begin());
    const std::size_t length = std::max<std::size_t>(1, (last - first + pieces - 1) / pieces);
    for (std::size_t i = first; i < last; i += length)
      for (std::size_t c = 0; c < other.columns.size(); ++c) {
        const double error = (splitmix(pattern += splitmix_step) & 1u) != 0 ? record.errors[c] : -record.errors[c];
        for (std::size_t j = i; j < std::min(i + length, last); ++j) other.columns[c][j] += error;
      }
    first = std::max(last, first + 1);
  }
  return other;
}

/// Samples closer to the extremes that are sought, evenly between the neighbours of each.
std::vector<double> closer_times(const Record& record, const std::vector<Sought>& extremes) {
  constexpr int parts = 64;
  const auto &t = record.time, &mu = record.column("friction_coefficient");
  std::vector<double> times;
  for (const auto& sought : extremes) {
    const auto [first, last] = between(t, sought.begin, sought.end);
    if (first == last) continue;
    const auto begin = mu.begin() + std::ptrdiff_t(first), end = mu.begin() + std::ptrdiff_t(last);
    const auto at =
        std::size_t((sought.maximum ? std::max_element(begin, end) : std::min_element(begin, end)) - mu.begin());
    if (at == first || at + 1 == last) continue;  // where the protocol jumps, it is a sample
    const double low = t[at - 1], high = t[at + 1];
    for (int i = 1; i < parts; ++i) times.push_back(std::lerp(low, high, double(i) / parts));
  }
  return times;
}

}  // namespace

Motion motion_of(Model model) {
  const bool may_jump = model.law->set_valued();
  return {[model = std::move(model)](const motion::RunOptions& options) { return motion::run(model, options); },
          may_jump};
}

Motion motion_of(const Machine& machine, Signal speed) {
  return {
      [&machine, speed = std::move(speed)](const motion::RunOptions& options) { return machine.run(speed, options); },
      machine.friction_may_jump()};
}

void record_run(Result& result, const Task& task, const Motion& motion, const motion::Start& start,
                const std::vector<double>& times, const std::vector<Sought>& extremes) {
  motion::RunOptions options;
  options.times = times;
  options.duration = times.back();
  options.start = start;
  options.tolerance = task.tolerance;
  const auto record = [&] {
    auto run = motion.run(options);
    end_if_stopped();  // a part of a protocol has no readings
    result.outcome = run.outcome;
    result.events = std::move(run.events);
    result.record = {std::move(run.time),
                     std::move(run.column_names),
                     std::move(run.column_units),
                     std::move(run.columns),
                     {},
                     std::move(run.column_error)};
    result.record.errors.resize(result.record.columns.size(), infinity);
    if (motion.friction_may_jump)
      for (const auto& event : result.events) result.record.breaks.push_back(event.time);
    result.plan.push_back(fmt::format("solver {}, {} steps; {}", run.solver, run.cost.steps, run.why));
  };
  record();
  if (result.record.time.size() < 2) throw NothingRecorded{std::move(result)};
  const bool all = result.record.time.size() == times.size();
  const bool seeks = all && task.sensor.ideal() && !extremes.empty();
  const auto closer = seeks ? closer_times(result.record, extremes) : std::vector<double>();
  if (!closer.empty()) {
    options.times.insert(options.times.end(), closer.begin(), closer.end());
    std::ranges::sort(options.times);
    options.times.erase(std::unique(options.times.begin(), options.times.end()), options.times.end());
    record();
  }
  const auto& errors = result.record.errors;
  const bool known = std::ranges::all_of(errors, [](double e) { return std::isfinite(e); });
  if (result.outcome.ending == Ending::tolerance_not_met && known &&
      result.record.time.size() == options.times.size()) {
    result.warnings.push_back("the record misses the tolerance, which the errors of readings count: " +
                              result.outcome.detail);
    result.outcome = {};
  }
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
                   {},
                   {}};
  for (const auto& column : result.record.columns) {
    double size = 0;
    for (const double x : column) size = std::max(size, std::abs(x));
    result.record.errors.push_back(rounding * size);
  }
  for (const auto& state : law.states()) {
    result.record.names.push_back(state.name);
    result.record.units.push_back(state.unit);
  }
  result.plan.push_back("friction without memory follows the imposed slip rate: nothing is integrated");
}

bool memoryless(const Model& model) { return !model.law->has_states() || model.lambda == 0; }

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
  for (const auto& e : steady::steady_extrema(law, low, high, normal_load)) {
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
  std::ranges::sort(result.record.breaks);
  const Record truth = std::move(result.record);
  const auto ideal = reader(truth);
  auto readings = ideal;
  std::vector<double> integration(ideal.size()), sampling(ideal.size());
  const auto differs = [&](std::vector<double>& most, const Record& other) {
    const auto read = reader(other);
    for (std::size_t i = 0; i < ideal.size(); ++i)
      if (const double d = std::abs(read[i].value - ideal[i].value); !std::isnan(ideal[i].value))
        most[i] = std::isnan(d) ? infinity : std::max(most[i], d);
  };
  for (const std::size_t odd : {0, 1}) differs(sampling, part_of(truth, [&](std::size_t i) { return i % 2 == odd; }));
  for (int k = 1; k <= patterns; ++k) differs(integration, moved(truth, splitmix(std::uint64_t(k))));
  for (std::size_t i = 0; i < readings.size(); ++i) readings[i].error += sampling[i] + integration[i];
  if (sensor.ideal()) {
    result.record = truth;
  } else {
    result.record = measure(truth, sensor, result.warnings);
    const auto measured = reader(result.record);
    for (std::size_t i = 0; i < readings.size(); ++i) readings[i].value = measured[i].value;
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

double unsettled(const std::vector<double>& time, const std::vector<double>& x, double begin, double end,
                 double settling) {
  const auto [first, last] = between(time, end - 0.1 * (end - begin), end);
  if (first == last || settling == 0) return 0;
  const auto [low, high] = std::minmax_element(x.begin() + std::ptrdiff_t(first), x.begin() + std::ptrdiff_t(last));
  constexpr double few_samples = 2;  // show a part of what changes
  return (*high - *low) * (std::isfinite(settling) ? few_samples * settling / (0.1 * (end - begin)) : 1);
}

Extreme extreme(const Record& record, const std::vector<double>& x, const Sought& sought) {
  const auto& time = record.time;
  const auto [first, last] = between(time, sought.begin, sought.end);
  if (first >= last) return {std::nan(""), std::nan("")};
  const auto above = [&](std::size_t i, std::size_t j) { return sought.maximum ? x[i] > x[j] : x[i] < x[j]; };
  std::size_t best = first;
  for (std::size_t i = first; i < last; ++i)
    if (above(i, best)) best = i;
  if (best == first || best + 1 == last) return {time[best], x[best]};
  const auto jump = std::ranges::lower_bound(record.breaks, time[best - 1]);
  if (jump != record.breaks.end() && *jump <= time[best + 1]) {
    // On a straight line up to the jump, from the sample beside it on the same side.
    const bool ahead = *jump > time[best], behind = !ahead && *jump < time[best] && *jump > time[best - 1];
    const std::size_t beside = ahead ? best - 1 : best + 1;
    if (!ahead && !behind) return {time[best], x[best]};
    const double slope = (x[best] - x[beside]) / (time[best] - time[beside]), further = slope * (*jump - time[best]);
    return (further > 0) == sought.maximum ? Extreme{*jump, x[best] + further} : Extreme{time[best], x[best]};
  }
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
