/// Recurrence by the returns of two motions, the second by finer steps.
#include "analysis/cycles/stepped_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "analysis/cycles/lyapunov.hpp"
#include "analysis/cycles/stepped_exponent.hpp"
#include "analysis/cycles/stepped_returns.hpp"

namespace rosin::analysis::cycles {

using motion::Channel, motion::SteppedOscillator;
using Measures = std::map<std::string, StructureCycle::Measure>;
using Values = std::map<std::string, double>;

namespace {

constexpr int most_returns_in_period = 32;
constexpr int periods_measured = 3;
constexpr long most_returns_averaged = 200;  ///< for the exponent of a motion without a period

/// One list of metrics: names with units and meanings, and their values in a period.
class PeriodMetrics {
 public:
  explicit PeriodMetrics(const SteppedOscillator& oscillator) : oscillator_(oscillator) {}

  Measures names() const {
    Measures metrics;
    metrics["period"] = {NAN, NAN, "s", "period of the motion"};
    for (const auto& [name, unit, kind] : oscillator_.channels) {
      std::string words = name;
      std::ranges::replace(words, '_', ' ');
      if (kind == Channel::Kind::part) metrics[name] = {NAN, NAN, unit, "mean " + words};
      if (kind == Channel::Kind::rate) metrics[name] = {NAN, NAN, unit, words + " in a period"};
      if (kind != Channel::Kind::value) continue;
      metrics[name + "_max"] = {NAN, NAN, unit, "largest " + words};
      metrics[name + "_min"] = {NAN, NAN, unit, "smallest " + words};
      metrics[name + "_mean"] = {NAN, NAN, unit, "mean " + words};
      metrics[name + "_amplitude"] = {NAN, NAN, unit, "half the range of " + words};
    }
    return metrics;
  }
  Values of(std::span<const SteppedReturn> returns) const {
    Values values;
    double duration = 0;
    for (const auto& one : returns) duration += one.duration;
    values["period"] = duration;
    for (std::size_t c = 0; c < oscillator_.channels.size(); ++c) {
      const auto& [name, unit, kind] = oscillator_.channels[c];
      double low = infinity, high = -infinity, integral = 0;
      for (const auto& one : returns)
        low = std::min(low, one.low[c]), high = std::max(high, one.high[c]), integral += one.integral[c];
      if (kind == Channel::Kind::part) values[name] = std::min(integral / duration, 1.0);
      if (kind == Channel::Kind::rate) values[name] = integral;
      if (kind != Channel::Kind::value) continue;
      values[name + "_max"] = high, values[name + "_min"] = low;
      values[name + "_mean"] = integral / duration, values[name + "_amplitude"] = (high - low) / 2;
    }
    return values;
  }

 private:
  const SteppedOscillator& oscillator_;
};

/// What the last periods of one motion show.
struct Periods {
  Outcome outcome;
  Settled settled = Settled::no;
  int returns = 0;                  ///< in a period; 0: none was found
  bool closes = false;              ///< the periods approach one; else they keep to each other's neighbourhood
  double apart = infinity;          ///< over the range: what is left between the motion and its period
  Values values, scatter;           ///< of the last period; of the last ones
  std::vector<SteppedReturn> last;  ///< of the last period
  std::vector<double> before;       ///< the channels at its beginning
  std::vector<double> end;          ///< state, and its time in the phase of the drive
  double time = 0, mean_return = 0;
  long crossings = 0, steps = 0;
};

class SteppedSearch {
 public:
  SteppedSearch(const SteppedOscillator& oscillator, const StructureCycleOptions& options, bool finer)
      : oscillator_(oscillator), options_(options), returns_(oscillator, options.tolerance, finer) {
    returns_.most_steps = options.most_steps;
  }
  void start(double t, const std::vector<double>& state) { returns_.start(t, state); }
  /// The section and the returns of a period that is known.
  void expect(int coordinate, int returns) {
    returns_.watch(coordinate), chosen_ = true;
    fewest_ = most_ = std::size_t(returns);
  }
  int watched() const { return returns_.watched(); }

  Periods search() {
    if (!oscillator_.driven() && oscillator_.watched < 0 && !chosen_) choose_section();
    const int most = std::min(options_.max_cycles, most_crossings);
    SteppedReturn one;
    const double begin = returns_.time();
    while (result_.outcome.complete() && result_.returns == 0) {
      const auto outcome = returns_.next(one);
      if (!one.row.empty()) include(one);
      if (result_.settled = settled(outcome); result_.settled != Settled::no) {
        constexpr const char* where[] = {"", "steady sliding is reached", "the motion comes to rest",
                                         "a coordinate is a million times as far as in its first returns"};
        result_.outcome = {result_.settled == Settled::escape ? Ending::unbounded : Ending::none_exists,
                           where[int(result_.settled)]};
      } else if (outcome.ending != Ending::event) {
        result_.outcome = outcome;
      } else if (++result_.crossings >= most) {
        result_.outcome = {Ending::budget_spent,
                           fmt::format("no period within {} returns: the motion is irregular, or settles slowly (the "
                                       "nearest return is {:.1e} of its range away)",
                                       result_.crossings, nearest_)};
      } else {
        look();
      }
    }
    result_.mean_return = (returns_.time() - begin) / double(std::max(result_.crossings, 1L));
    if (result_.returns > 0) measure();
    result_.end = returns_.state();
    result_.time = oscillator_.driven() ? returns_.behind() : 0;
    result_.steps = returns_.steps();
    return std::move(result_);
  }

 private:
  static constexpr int most_crossings = 500;
  static constexpr double alike = 1e-2;  ///< over the range: returns of periods that keep to each other's neighbourhood
  static constexpr double small = 1e-6;  ///< over the largest displacement: what counts as rest

  std::size_t compared() const { return 2 * std::size_t(oscillator_.coordinates); }

  /// The coordinate that moves most, over some natural periods.
  void choose_section() {
    constexpr int periods = 8;
    std::vector<double> low(compared(), infinity), high(compared(), -infinity);
    const auto ahead = oscillator_.motion(options_.tolerance, false);
    ahead->start(0, oscillator_.start);
    std::vector<double> row(oscillator_.channels.size());
    for (long steps = 0; ahead->time() < periods * oscillator_.natural_period && steps < returns_.most_steps; ++steps) {
      if (!ahead->advance(periods * oscillator_.natural_period).complete()) break;
      ahead->observe(ahead->time(), false, row.data());
      for (std::size_t c = 0; c < compared(); ++c)
        low[c] = std::min(low[c], row[c]), high[c] = std::max(high[c], row[c]);
    }
    int widest = 0;
    for (int i = 1; i < oscillator_.coordinates; ++i)
      if (high[i] - low[i] > high[widest] - low[widest]) widest = i;
    returns_.watch(widest);
  }

  void include(const SteppedReturn& one) {
    constexpr std::size_t ranges_of = 16;
    ranges_.push_back({one.low, one.high});
    if (ranges_.size() > ranges_of) ranges_.pop_front();
    past_.emplace_back(one.row.begin(), one.row.begin() + long(compared()));
    if (past_.size() > 2 * most_returns_in_period + 1) past_.pop_front();
    sticks_ = false;
    for (std::size_t c = 0; c < oscillator_.channels.size(); ++c)
      if (oscillator_.channels[c].name == "stick_fraction") sticks_ = one.low[c] >= 1 - small;
    size_.assign(compared(), 0.0);
    for (std::size_t c = 0; c < compared(); ++c) {
      double low = infinity, high = -infinity;
      for (const auto& [lowest, highest] : ranges_) low = std::min(low, lowest[c]), high = std::max(high, highest[c]);
      size_[c] = high - low;
      if (c < std::size_t(oscillator_.coordinates)) {
        farthest_ = std::max({farthest_, std::abs(one.low[c]), std::abs(one.high[c])});
        if (ranges_.size() <= 8) near_start_ = farthest_;
      }
    }
    double widest = 0;  // range of a coordinate in this return
    for (int i = 0; i < oscillator_.coordinates; ++i) widest = std::max(widest, one.high[i] - one.low[i]);
    widths_.push_back(widest);
    // A coordinate that hardly moves is compared by those that do, of its unit.
    const auto ranges = size_;
    constexpr double hardly = 1e-3;
    for (std::size_t c = 0; c < compared(); ++c)
      for (std::size_t other = 0; other < compared(); ++other)
        if (oscillator_.channels[c].unit == oscillator_.channels[other].unit)
          size_[c] = std::max(size_[c], hardly * ranges[other]);
  }

  Settled settled(const Outcome& outcome) const {
    constexpr double far_away = 1e6;
    if (!(farthest_ < far_away * std::max(near_start_, std::numeric_limits<double>::min()))) return Settled::escape;
    if (oscillator_.driven()) return Settled::no;
    const bool moves = std::any_of(size_.begin(), size_.begin() + oscillator_.coordinates,
                                   [this](double range) { return range > small * farthest_; });
    if (moves) return outcome.ending == Ending::none_exists && sticks_ ? Settled::rest : Settled::no;
    if (outcome.ending == Ending::event && ranges_.size() < 8) return Settled::no;
    return sticks_ ? Settled::rest : Settled::sliding;
  }

  double distance(std::size_t i, std::size_t j) const {
    double largest = 0;
    for (std::size_t c = 0; c < compared(); ++c)
      if (const double apart = std::abs(past_[i][c] - past_[j][c]); apart > 0)
        largest = std::max(largest, apart / size_[c]);
    return largest;
  }

  /// Has the motion come to its period, or does it stay about one?
  void look() {
    constexpr double of_tolerance = 0.1;
    const std::size_t last = past_.size() - 1;
    nearest_ = infinity;
    std::vector<double> away(most_returns_in_period + 1, infinity);
    for (std::size_t m = fewest_; m <= most_ && 2 * m <= last; ++m) {
      const double now = distance(last, last - m), before = distance(last - m, last - 2 * m);
      away[m] = now, nearest_ = std::min(nearest_, now);
      // Of a sequence that approaches by a factor at each period, so much is left.
      const double factor = std::min(before > 0 ? now / before : 0, 1.0),
                   left = factor < 1 ? now / (1 - factor) : infinity;
      if (now < alike && (now == 0 || left < of_tolerance * options_.tolerance) && result_.crossings > 3) {
        result_.closes = true, result_.apart = now == 0 ? 0 : left;
        result_.returns = int(shortest_within(m, away, result_.apart));
        return;
      }
    }
    away_.push_back(std::move(away));
    if (result_.crossings % 50 != 0 || result_.crossings < 150) return;
    if (creeps_to_rest()) {
      result_.settled = Settled::rest;
      result_.outcome = {Ending::none_exists, "the motion comes to rest, by slips that grow ever smaller"};
    } else {
      look_for_neighbourhood();
    }
  }

  /// What still swings about a period while it approaches may close over several of them first: the fewest returns, of
  /// which m are a multiple, that are apart by no more than twice what is left, which is what such a swing leaves.
  std::size_t shortest_within(std::size_t m, const std::vector<double>& away, double left) const {
    constexpr double swing = 2;
    for (std::size_t few = fewest_; few < m; ++few)
      if (m % few == 0 && away[few] <= swing * left) return few;
    return m;
  }

  /// Under a periodic drive slips may move a mass to where friction holds it, by less each time and by no factor.
  bool creeps_to_rest() const {
    constexpr double smaller = 0.7, beside_all = 0.1;
    const std::size_t n = widths_.size();
    return oscillator_.driven() && widths_[n - 1] < smaller * widths_[n / 2] &&
           widths_[n / 2] < smaller * widths_[n / 4] && widths_[n - 1] < beside_all * farthest_;
  }

  /// Periods that neither come nearer to each other nor leave: the largest distance over the last returns is what it
  /// was half the motion ago.
  void look_for_neighbourhood() {
    constexpr std::size_t over = 20;
    constexpr double as_before = 0.5;
    const auto largest = [&](std::size_t m, std::size_t end) {
      double most = 0;
      for (std::size_t i = end - over; i < end; ++i) most = std::max(most, away_[i][m]);
      return most;
    };
    std::size_t m = fewest_;
    while (m <= most_ && largest(m, away_.size()) > alike) ++m;
    if (m > most_) return;
    result_.apart = largest(m, away_.size());
    if (result_.apart > as_before * largest(m, away_.size() / 2)) result_.returns = int(m);
  }

  void measure() {
    const auto period = std::size_t(result_.returns);
    std::vector<SteppedReturn> all(periods_measured * period);
    std::vector<double> before;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i + period == all.size()) result_.before = i > 0 ? all[i - 1].row : std::vector<double>();
      if (const auto outcome = returns_.next(all[i], true); outcome.ending != Ending::event) {
        result_.outcome = outcome, result_.returns = 0;
        return;
      }
    }
    const PeriodMetrics metrics(oscillator_);
    for (int k = periods_measured; k-- > 0;) {
      const auto values = metrics.of(std::span(all).subspan(std::size_t(k) * period, period));
      if (k + 1 == periods_measured) result_.values = values;
      for (const auto& [name, value] : values)
        result_.scatter[name] = std::max(result_.scatter[name], std::abs(value - result_.values[name]));
    }
    result_.last.assign(all.end() - std::ptrdiff_t(period), all.end());
  }

  const SteppedOscillator& oscillator_;
  const StructureCycleOptions& options_;
  SteppedReturns returns_;
  bool chosen_ = false, sticks_ = false;
  std::size_t fewest_ = 1, most_ = most_returns_in_period;  ///< returns of the periods that are looked for
  std::deque<std::vector<double>> past_;                    ///< coordinates and velocities at returns
  struct Extremes {
    std::vector<double> low, high;
  };
  std::deque<Extremes> ranges_;
  std::vector<double> size_;
  std::vector<double> widths_;             ///< of each return, the range of the coordinate that moves most
  std::vector<std::vector<double>> away_;  ///< [return][m], from that m returns before
  double nearest_ = infinity, farthest_ = 0, near_start_ = 0;
  Periods result_;
};

/// The range of a coordinate, or of a wider one of its unit, by which it is known.
double range_of(const SteppedOscillator& oscillator, int coordinate, const Values& values) {
  double widest = 0;
  for (int i = 0; i < oscillator.coordinates; ++i)
    if (oscillator.channels[std::size_t(i)].unit == oscillator.channels[std::size_t(coordinate)].unit)
      widest = std::max(widest, 2 * values.at(oscillator.channels[std::size_t(i)].name + "_amplitude"));
  return widest;
}

/// The last period as columns over time.
void take_orbit(const SteppedOscillator& oscillator, const Periods& periods, SteppedCycle& cycle) {
  std::vector<std::size_t> kept;
  for (std::size_t c = 0; c < oscillator.channels.size(); ++c)
    if (oscillator.channels[c].kind == Channel::Kind::value) kept.push_back(c);
  for (const std::size_t c : kept)
    cycle.column_names.push_back(oscillator.channels[c].name),
        cycle.column_units.push_back(oscillator.channels[c].unit);
  cycle.columns.resize(kept.size());
  double begin = 0;
  for (const auto& one : periods.last) {
    for (std::size_t i = 0; i < one.time.size(); ++i) {
      cycle.time.push_back(begin + one.time[i]);
      for (std::size_t k = 0; k < kept.size(); ++k) cycle.columns[k].push_back(one.rows[i][kept[k]]);
    }
    begin += one.duration;
  }
}

}  // namespace

Measures cycle_metrics_of(const SteppedOscillator& oscillator) { return PeriodMetrics(oscillator).names(); }

SteppedCycle find_cycle(const SteppedOscillator& oscillator, const StructureCycleOptions& options, bool errors) {
  require(options.tolerance, {1e-11, 0.1}, "tolerance", "relative accuracy of a cycle", "1");
  SteppedCycle cycle;
  SteppedSearch search(oscillator, options, false);
  const auto coarse = search.search();
  cycle.outcome = coarse.outcome, cycle.settled = coarse.settled;
  cycle.cost = {coarse.steps, 0, coarse.crossings};
  cycle.start = coarse.end, cycle.start_time = coarse.time;
  if (coarse.returns == 0) {
    if (options.exponent && cycle.outcome.ending == Ending::budget_spent && coarse.crossings > 0) {
      cycle.exponent = largest_exponent(oscillator, options.tolerance, coarse.time, coarse.end, coarse.mean_return,
                                        std::min(coarse.crossings, most_returns_averaged));
      cycle.outcome = outcome_of(cycle.exponent, coarse.crossings, cycle.outcome);
    }
    return cycle;
  }
  Periods fine = coarse;
  if (errors) {
    SteppedSearch again(oscillator, options, true);
    again.start(coarse.time, coarse.end);
    again.expect(search.watched(), coarse.returns);
    fine = again.search();
    cycle.cost.steps += fine.steps, cycle.cost.cycles += fine.crossings;
  }
  cycle.returns = coarse.returns;
  cycle.metrics = PeriodMetrics(oscillator).names();
  const bool same = fine.returns == coarse.returns;
  const double left = coarse.apart + (same ? fine.apart : 0);
  // Of an error that falls with the step half is left at half the step.
  const auto of_steps = [&](const std::string& name) {
    return same ? 2 * std::abs(fine.values.at(name) - coarse.values.at(name)) : infinity;
  };
  for (auto& [name, measure] : cycle.metrics) {
    measure.value = coarse.values.at(name);
    measure.error = of_steps(name) + coarse.scatter.at(name) + (same ? fine.scatter.at(name) : 0);
    if (name != "period" || !oscillator.driven()) measure.error += left * std::abs(measure.value);
  }
  // Over the range of the coordinate: all that is unknown, and what the steps make of that.
  double worst = cycle.metrics.at("period").error / coarse.values.at("period"), by_steps = 0;
  for (int i = 0; i < oscillator.coordinates; ++i) {
    const auto& name = oscillator.channels[std::size_t(i)].name;
    const auto &high = cycle.metrics.at(name + "_max"), &low = cycle.metrics.at(name + "_min");
    cycle.coordinate_max.push_back(high.value), cycle.coordinate_min.push_back(low.value);
    const double range = range_of(oscillator, i, coarse.values);
    if (range == 0) continue;
    worst = std::max({worst, high.error / range, low.error / range});
    by_steps = std::max({by_steps, of_steps(name + "_max") / range, of_steps(name + "_min") / range});
  }
  take_orbit(oscillator, coarse, cycle);
  const bool closes = coarse.closes || (oscillator.fixed_steps && left <= by_steps);
  cycle.stable = closes;
  cycle.multipliers_left_out =
      "multipliers are not computed of a motion that is followed by steps: 'lyapunov' shows its exponent";
  if (!same)
    cycle.outcome = {Ending::tolerance_not_met, "by finer steps the motion comes to another one" +
                                                    (fine.outcome.complete() ? "" : ": " + fine.outcome.detail)};
  else if (!closes)
    cycle.outcome = {
        Ending::tolerance_not_met,
        fmt::format("the periods do not approach each other: their returns stay {:.1e} of the range apart, "
                    "as about a neutral cycle, or by rough steps; errors are their scatter",
                    left)};
  else if (!oscillator.fixed_steps && worst > options.tolerance)
    cycle.outcome = {Ending::tolerance_not_met, fmt::format("the period is known to {:.1e} only", worst)};
  return cycle;
}

}  // namespace rosin::analysis::cycles
