/// Events by hysteresis at each level of a pyramid of medians; their onset and size from the samples themselves.
#include "analysis/inference/slip_events.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "analysis/inference/noise.hpp"

namespace rosin::analysis::inference {

namespace {

/// Indices of the highest sample before a fall and of the lowest behind it.
struct Fall {
  std::size_t high, low;
};
/// Falls by more than `least`, between which force rises by as much. One that the record begins or ends with is left
/// out: its highest or lowest sample lies at the end.
std::vector<Fall> falls(const std::vector<double>& force, double least) {
  enum class Trend { unknown, rises, falls } trend = Trend::unknown;
  std::vector<Fall> found;
  std::size_t high = 0, low = 0;
  const auto end_fall = [&] {
    if (trend == Trend::falls && high > 0 && low + 1 < force.size()) found.push_back({high, low});
  };
  for (std::size_t i = 1; i < force.size(); ++i) {
    if (trend != Trend::falls && force[i] > force[high]) high = i;
    if (trend != Trend::rises && force[i] < force[low]) low = i;
    if (trend != Trend::falls && force[i] < force[high] - least) {
      trend = Trend::falls, low = i;
    } else if (trend != Trend::rises && force[i] > force[low] + least) {
      end_fall();
      trend = Trend::rises, high = i;
    }
  }
  end_fall();
  return found;
}

/// Each second number, as the median of the five about it.
std::vector<double> halved(const std::vector<double>& force) {
  std::vector<double> half;
  const auto last = std::ptrdiff_t(force.size()) - 1;
  for (std::ptrdiff_t i = 0; i <= last; i += 2) {
    std::array<double, 5> about{};
    for (std::ptrdiff_t k = -2; k <= 2; ++k)
      about[std::size_t(k + 2)] = force[std::size_t(std::clamp(i + k, {}, last))];
    std::ranges::nth_element(about, about.begin() + 2);
    half.push_back(about[2]);
  }
  return half;
}

constexpr std::size_t fewest = 3;  // events that repeat themselves

/// Numbers of events by threshold, at each level.
struct Counts {
  std::vector<double> thresholds;
  std::vector<std::vector<std::size_t>> at;  ///< by level, then by threshold

  /// The number that most places agree on, of those found at a threshold, or at any (nothing), between two levels.
  std::size_t agreed(std::optional<std::size_t> threshold, std::size_t first, std::size_t last) const {
    std::map<std::size_t, std::size_t> places;
    for (const auto& row : at)
      for (const auto number : row) ++places[number];
    std::size_t most = 0, best = 0;
    for (auto level = first; level <= last; ++level)
      for (std::size_t k = 0; k < thresholds.size(); ++k)
        if (const auto number = at[level][k]; number >= fewest && (!threshold || *threshold == k))
          if (places[number] > most) most = places[number], best = number;
    return best;
  }
  /// The longest row of thresholds that find this number at a level: its first and the one behind its last.
  std::pair<std::size_t, std::size_t> plateau(std::size_t level, std::size_t number) const {
    std::pair<std::size_t, std::size_t> longest{0, 0};
    for (std::size_t from = 0, to = 0; from < thresholds.size(); from = to) {
      to = from + 1;
      while (to < thresholds.size() && at[level][to] == at[level][from]) ++to;
      if (at[level][from] == number && to - from > longest.second - longest.first) longest = {from, to};
    }
    return longest;
  }
};

/// The value at `at` of the straight line through samples `from` … `to` that lie within `far` of the smooth force.
double line_at(const std::vector<double>& force, const std::vector<double>& smooth, double far, std::size_t from,
               std::size_t to, std::size_t at) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (auto i = from; i <= to; ++i) {
    if (far > 0 && std::abs(force[i] - smooth[i]) > far) continue;
    const double s = double(i) - double(at);
    n += 1, x += s, y += force[i], xx += s * s, xy += s * force[i];
  }
  const double determinant = n * xx - x * x;
  return n == 0 ? smooth[at] : determinant > 0 ? (xx * y - x * xy) / determinant : y / n;
}

double order_statistic(std::vector<double> values, double part) {
  const auto at = values.begin() + std::ptrdiff_t(part * double(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// A level at each sample, by straight lines.
std::vector<double> as_dense(const std::vector<double>& level, std::size_t number, std::size_t samples) {
  std::vector<double> dense;
  for (std::size_t i = 0; i < samples; ++i) {
    const auto at = std::min(i >> number, level.size() - 1), next = std::min(at + 1, level.size() - 1);
    const double part = double(i - (at << number)) / double(std::size_t(1) << number);
    dense.push_back(level[at] + part * (level[next] - level[at]));
  }
  return dense;
}

/// Onset and size of events that were seen at a level above the samples: each fall crosses half its height at a sample;
/// about that the median of all of them shows when a fall begins and ends.
std::vector<SlipEvent> measured(const std::vector<double>& time, const std::vector<double>& force,
                                const std::vector<double>& smooth, const std::vector<Fall>& seen, double noise,
                                std::size_t window) {
  std::vector<std::size_t> crossings;
  std::vector<double> lengths;  // of falls
  std::size_t apart = force.size();
  for (const auto& [high, low] : seen) {
    const double half = (smooth[high] + smooth[low]) / 2, most = (smooth[high] - smooth[low]) / 2;
    double sum = 0, largest = 0;
    auto crossing = high;
    for (auto i = high; i <= low; ++i) {
      sum += std::clamp(force[i] - half, -most, most);
      if (sum > largest) largest = sum, crossing = i;
    }
    if (!crossings.empty()) apart = std::min(apart, crossing - crossings.back());
    crossings.push_back(crossing);
    lengths.push_back(double(low - high));
  }
  // Where the fall begins and ends, seen from the crossing.
  const auto about =
      std::max<std::size_t>(1, std::min(apart / 2, std::size_t(order_statistic(lengths, 0.5)) + 2 * window));
  std::vector<double> typical;
  for (std::size_t j = 0; j <= 2 * about; ++j) {
    std::vector<double> there;
    for (const auto c : crossings)
      if (c >= about && c + about < force.size()) there.push_back(force[c - about + j]);
    if (there.empty()) return {};
    typical.push_back(order_statistic(std::move(there), 0.5));
  }
  // The times at which nine tenths and one tenth of its height are left are known better than those of its corners: a
  // straight fall goes on for 0.62 of what lies between them on each side of the middle, half a cosine for 0.85.
  const auto centre = typical.begin() + std::ptrdiff_t(about);
  const double top = order_statistic({typical.begin(), centre}, 0.9),
               bottom = order_statistic({centre, typical.end()}, 0.1);
  constexpr double left = 0.1, onward = 0.7;
  auto nine = centre, one = centre;
  while (nine != typical.begin() && *nine < top - left * (top - bottom)) --nine;
  while (one + 1 != typical.end() && *one > bottom + left * (top - bottom)) ++one;
  const double half_time = onward * double(one - nine), off_centre = double((one - centre) - (centre - nine)) / 2;
  const auto before = std::size_t(std::clamp(std::round(half_time - off_centre), 0.0, double(about))),
             behind = std::size_t(std::clamp(std::round(half_time + off_centre), 0.0, double(about)));
  constexpr double far = 6;
  std::vector<SlipEvent> events;
  for (const auto c : crossings) {
    const auto onset = c - std::min(before, c), end = std::min(c + behind, force.size() - 1);
    const auto length = std::min({window, onset, force.size() - 1 - end, apart / 2});
    const double high = line_at(force, smooth, far * noise, onset - length, onset, onset),
                 low = line_at(force, smooth, far * noise, end, end + length, end);
    events.push_back({time[onset], time[end] - time[onset], high - low});
  }
  return events;
}

}  // namespace

SlipEvents find_slip_events(const std::vector<double>& time, const std::vector<double>& force,
                            const EventLimits& limits) {
  SlipEvents found;
  if (force.size() < 2) return found;
  const auto [lowest, highest] = std::ranges::minmax(force);
  const double range = highest - lowest, spacing = (time.back() - time.front()) / double(time.size() - 1);
  if (!(range > 0)) return found;

  Counts counts;
  constexpr double ratio = 1.1;
  constexpr int steps = 96;  // four decades below the whole range
  for (int i = steps; i > 0; --i) counts.thresholds.push_back(range * std::pow(ratio, -i));
  if (limits.least_drop)
    counts.thresholds.insert(std::ranges::lower_bound(counts.thresholds, *limits.least_drop), *limits.least_drop);
  std::vector<std::vector<double>> levels = {force};
  constexpr std::size_t shortest = 32;
  while (levels.back().size() > shortest) levels.push_back(halved(levels.back()));
  for (const auto& level : levels) {
    counts.at.emplace_back();
    for (const double least : counts.thresholds) counts.at.back().push_back(falls(level, least).size());
  }
  const auto time_of = [&](std::size_t level) { return level == 0 ? 0 : spacing * double(1UL << level); };
  std::size_t first = 0, last = levels.size() - 1;
  if (limits.least_time) {
    while (first < last && time_of(first) < *limits.least_time) ++first;
    last = first;
  }
  found.least_drop = limits.least_drop.value_or(range / 2);
  found.least_time = time_of(first);
  std::optional<std::size_t> given;
  if (limits.least_drop)
    given = std::size_t(std::ranges::find(counts.thresholds, *limits.least_drop) - counts.thresholds.begin());
  const auto number = counts.agreed(given, first, last);
  if (number == 0) return found;
  // Events are measured at the finest level where nearly as many thresholds find them as at any.
  const auto length = [&](std::size_t level) {
    const auto [from, to] = counts.plateau(level, number);
    return to - from;
  };
  std::size_t widest = 0, level = first;
  for (auto k = first; k <= last; ++k) widest = std::max(widest, length(k));
  constexpr double nearly = 0.6;
  while (double(length(level)) < nearly * double(widest)) ++level;
  // Half of the largest threshold is half of the smallest event, about.
  auto [from, to] = counts.plateau(level, number);
  found.same_from = counts.thresholds[from], found.same_to = counts.thresholds[to - 1];
  const double half = counts.thresholds[to - 1] / 2;
  while (from + 1 < to && counts.thresholds[from] < half) ++from;
  found.least_drop = limits.least_drop.value_or(counts.thresholds[from]);
  found.least_time = time_of(level);

  auto seen = falls(levels[level], counts.thresholds[from]);
  if (level == 0) {
    found.noise = roughness(force);
    for (const auto& [high, low] : seen)
      found.events.push_back({time[high], time[low] - time[high], force[high] - force[low]});
    return found;
  }
  const auto smooth = as_dense(levels[level], level, force.size());
  std::vector<double> off;
  for (std::size_t i = 0; i < force.size(); ++i) off.push_back(std::abs(force[i] - smooth[i]));
  constexpr double part = 0.9;
  const double of_normal = gsl_cdf_ugaussian_Pinv(0.5 + part / 2);  // within so many standard deviations
  found.noise = order_statistic(off, part) / of_normal;
  const std::size_t stride = std::size_t(1) << level;
  for (auto& [high, low] : seen) {
    high *= stride, low = std::min(low * stride, force.size() - 1);
    const auto begin = high - std::min(high, stride), end = std::min(low + stride, force.size() - 1);
    std::fill(off.begin() + std::ptrdiff_t(begin), off.begin() + std::ptrdiff_t(end), 0.0);
  }
  constexpr double improbable = 8;
  found.spikes = std::ranges::count_if(off, [&](double d) { return d > improbable * found.noise; });
  found.events = measured(time, force, smooth, seen, found.noise, 2 * stride);
  return found;
}

}  // namespace rosin::analysis::inference
