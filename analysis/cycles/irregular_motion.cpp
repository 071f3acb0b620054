/// Samples at equal intervals, their moments by blocks, and their spectrum by segments.
#include "analysis/cycles/irregular_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "analysis/cycles/lyapunov.hpp"
#include "analysis/cycles/motion_range.hpp"
#include "analysis/cycles/period_record.hpp"
#include "analysis/cycles/section_map.hpp"
#include "core/fourier.hpp"

namespace rosin::analysis::cycles {

using motion::Channel, motion::Follower;
using oscillators::StructureSystem;

namespace {

constexpr long transient_returns = 1000, averaged_returns = 10'000;
/// Samples in a return: incommensurate with a drive, so that all of its phases are seen.
constexpr double samples_in_return = 16 * 1.618033988749895;
constexpr int block = 26, segment = 1664, shown = 1024;  ///< samples: a return, 64 and 40 of them

/// A motion that can be followed time and again.
struct Source {
  std::vector<Channel> channels;  ///< coordinates first
  int coordinates = 0;
  double mean_return = 0;  ///< s
  using Sample = std::function<void(std::size_t number, const double* row)>;
  /// \param from_start  or from where the transient has ended
  /// \param finer  by steps whose errors are small beside those of the others
  std::function<Outcome(bool from_start, bool finer, double interval, std::size_t samples, const Sample&)> follow;
  long steps = 0;
};

class Averages {
 public:
  Averages(const Source& source, double interval)
      : source_(source),
        interval_(interval),
        window_(window_values("hann", segment)),
        transform_(segment),
        sums_(source.channels.size()),
        first_(source.channels.size()),
        second_(source.channels.size()),
        held_(source.channels.size()),
        density_(source.channels.size(), std::vector<double>(std::size_t(transform_.bins()), 0.0)) {
    result_.coordinate_max.assign(std::size_t(source.coordinates), -infinity);
    result_.coordinate_min.assign(std::size_t(source.coordinates), infinity);
    for (const auto& channel : source.channels)
      if (channel.kind == Channel::Kind::value)
        result_.names.push_back(channel.name), result_.units.push_back(channel.unit);
    result_.columns.resize(result_.names.size());
  }

  void add(const double* row) {
    for (std::size_t c = 0; c < sums_.size(); ++c) {
      sums_[c].first += row[c], sums_[c].second += row[c] * row[c];
      if (is_value(c)) held_[c].push_back(row[c]);
    }
    for (std::size_t i = 0; i < result_.coordinate_max.size(); ++i) {
      result_.coordinate_max[i] = std::max(result_.coordinate_max[i], row[i]);
      result_.coordinate_min[i] = std::min(result_.coordinate_min[i], row[i]);
    }
    if (samples_ < shown) {
      result_.time.push_back(double(samples_) * interval_);
      for (std::size_t c = 0, kept = 0; c < sums_.size(); ++c)
        if (is_value(c)) result_.columns[kept++].push_back(row[c]);
    }
    if (++samples_ % block == 0) end_block();
    if (held_.front().size() == segment) end_segment();
  }

  IrregularMotion result() {
    for (std::size_t c = 0; c < first_.size(); ++c) state(c);
    result_.duration = double(samples_) * interval_;
    result_.returns = std::lround(result_.duration / source_.mean_return);
    if (segments_ == 0) return std::move(result_);
    const double spacing = 1 / (interval_ * segment);
    for (int k = 0; k < transform_.bins(); ++k) result_.frequency.push_back(k * spacing);
    for (std::size_t c = 0; c < density_.size(); ++c) {
      if (!is_value(c)) continue;
      const auto& unit = source_.channels[c].unit;
      const bool is_one_factor = unit.find_first_of("/ ^") == std::string::npos;
      result_.density_units.push_back(unit == "1"     ? "1/Hz"
                                      : is_one_factor ? unit + "^2/Hz"
                                                      : fmt::format("({})^2/Hz", unit));
      auto& density = result_.density.emplace_back();
      if (std::isfinite(density_[c].front()))
        for (const double sum : density_[c]) density.push_back(sum / segments_);
    }
    result_.density_error = std::sqrt(11.0 / (9.0 * segments_));  // Welch 1967
    return std::move(result_);
  }

 private:
  bool is_value(std::size_t c) const { return source_.channels[c].kind == Channel::Kind::value; }

  void end_block() {
    for (std::size_t c = 0; c < sums_.size(); ++c) {
      first_[c].push_back(sums_[c].first / block), second_[c].push_back(sums_[c].second / block);
      sums_[c] = {};
    }
  }

  void end_segment() {
    double squares = 0;
    for (const double w : window_) squares += w * w;
    for (std::size_t c = 0; c < held_.size(); ++c) {
      if (!is_value(c)) continue;
      auto& held = held_[c];
      const double mean = std::accumulate(held.begin(), held.end(), 0.0) / segment;
      const auto record = transform_.record();
      for (int i = 0; i < segment; ++i)
        record[std::size_t(i)] = (held[std::size_t(i)] - mean) * window_[std::size_t(i)];
      const auto bins = transform_();
      for (std::size_t k = 0; k < bins.size(); ++k)
        density_[c][k] += (k == 0 || k + 1 == bins.size() ? 1 : 2) * std::norm(bins[k]) * interval_ / squares;
      held.erase(held.begin(), held.begin() + segment / 2);
    }
    ++segments_;
  }

  /// Mean and root mean square of a channel, with errors by blocks.
  void state(std::size_t c) {
    const auto& channel = source_.channels[c];
    const auto mean_of = [](const std::vector<double>& series) {
      return std::accumulate(series.begin(), series.end(), 0.0) / double(series.size());
    };
    const double mean = mean_of(first_[c]);
    if (!std::isfinite(mean)) return;
    const auto add = [&](const std::string& name, double value, double error, const std::string& unit,
                         const std::string& meaning) {
      result_.averages[name] = {value, error, unit, meaning};
    };
    const double error = blocked_error(first_[c]).value;
    std::string words = channel.name;
    std::ranges::replace(words, '_', ' ');
    if (channel.kind == Channel::Kind::part) return add(channel.name, mean, error, channel.unit, "mean " + words);
    if (channel.kind == Channel::Kind::rate) {
      const std::string unit = channel.unit == "J" ? "W" : channel.unit + "/s";
      return add(channel.name + "_rate", mean, error, unit, "mean rate of " + words);
    }
    const auto name = metric_name(channel.name);
    add(name + "_mean", mean, error, channel.unit, "mean " + words);
    std::vector<double> deviations;  // squared, from the mean
    for (std::size_t i = 0; i < first_[c].size(); ++i)
      deviations.push_back(second_[c][i] - 2 * mean * first_[c][i] + mean * mean);
    const double rms = std::sqrt(std::max(mean_of(deviations), 0.0));
    add(name + "_rms", rms, rms > 0 ? blocked_error(deviations).value / (2 * rms) : 0, channel.unit,
        "root mean square about the mean of " + words);
  }

  const Source& source_;
  double interval_;
  std::vector<double> window_;
  RealTransform transform_;
  std::vector<std::pair<double, double>> sums_;      ///< of the present block
  std::vector<std::vector<double>> first_, second_;  ///< [channel][block], mean and mean square
  std::vector<std::vector<double>> held_, density_;  ///< [channel]: the present segment, sums over segments
  std::size_t samples_ = 0;
  int segments_ = 0;
  IrregularMotion result_;
};

/// Until when two passes from the start agree.
double known_until(Source& source, double interval, double exponent) {
  constexpr double lost = 1e-2, error_at_first = 1e-16;
  const double longest = std::min(-std::log(error_at_first) / exponent, transient_returns * source.mean_return);
  const auto samples = std::size_t(longest / interval);
  const auto n = std::size_t(source.coordinates);
  std::vector<double> reference, range(n, 0);
  source.follow(true, true, interval, samples,
                [&](std::size_t, const double* row) { reference.insert(reference.end(), row, row + n); });
  const std::size_t known = reference.size() / n;
  for (std::size_t i = 0; i < n; ++i) {
    double low = infinity, high = -infinity;
    for (std::size_t k = 0; k < known; ++k)
      low = std::min(low, reference[k * n + i]), high = std::max(high, reference[k * n + i]);
    range[i] = high - low;
  }
  // One that hardly moves counts by the others.
  constexpr double least = 1e-3;
  const double widest = *std::ranges::max_element(range);
  for (double& own : range) own = std::max(own, least * widest);
  double until = infinity;
  source.follow(true, false, interval, known, [&](std::size_t k, const double* row) {
    if (k >= known || std::isfinite(until)) return;
    for (std::size_t i = 0; i < n; ++i)
      if (std::abs(row[i] - reference[k * n + i]) > lost * range[i]) until = double(k) * interval;
  });
  return until;
}

IrregularMotion follow_averages(Source& source, const Exponent& exponent) {
  const auto regime = regime_of(exponent, source.mean_return);
  if (regime.empty()) return {};
  const double interval = source.mean_return / samples_in_return;
  const double until = exponent.is_zero() ? infinity : known_until(source, interval, exponent.value);
  Averages averages(source, interval);
  const auto outcome = source.follow(false, false, interval, std::size_t(averaged_returns * samples_in_return),
                                     [&](std::size_t, const double* row) { averages.add(row); });
  auto result = averages.result();
  result.outcome = outcome, result.regime = regime, result.known_until = until, result.steps = source.steps;
  return result;
}

/// The motion of a structure: its transient, and then samples of its columns, of stick and of the heat of friction.
class StructureSource : public Source {
 public:
  StructureSource(const motion::StructureModel& model, double tolerance, double stick_threshold)
      : model_(model), tolerance_(tolerance), stick_threshold_(stick_threshold) {
    const StructureSystem system(model.structure);
    const motion::StructureRecord record(system);
    coordinates = system.coordinates();
    for (std::size_t c = 0; c < record.names.size(); ++c) channels.push_back({record.names[c], record.units[c]});
    for (int j = 0; j < system.friction_contacts(); ++j)
      if (!model.structure.contacts[std::size_t(j)].frictionless())
        channels.push_back({motion::numbered(system, "stick_fraction", j), "1", Channel::Kind::part});
    channels.push_back({"friction_work", "J", Channel::Kind::rate});
    settle();
    follow = [this](bool from_start, bool finer, double interval, std::size_t samples, const Sample& sample) {
      return follow_samples(from_start, finer, interval, samples, sample);
    };
  }

 private:
  void settle() {
    constexpr double tolerance = 1e-7, of_patience = 0.02;
    SectionMap map(model_.structure);
    const auto start = motion::starting_point(map.system(), model_.start);
    if (!map.driven()) {
      MotionRange range(map.system());
      range.begin(start);
      Follower follower(map.system(), tolerance);
      follower.observe = [&](Follower::Step& step, std::span<const Follower::Event>) { range.add(step.state()); };
      auto ahead = start;
      follower.follow(0, ahead, of_patience * map.patience());
      map.watch(range.widest());
    }
    map.follow_crossings(start, tolerance, [&](int crossing, double t, const std::vector<double>& there) {
      mean_return = t / crossing, settled_ = there;
      return crossing >= transient_returns;
    });
    steps += map.count.steps;
  }

  Outcome follow_samples(bool from_start, bool finer, double interval, std::size_t samples, const Sample& sample) {
    constexpr double coarse = 0.1, fine = 1.0 / 300;
    StructureSystem system(model_.structure);
    motion::StructureRecord record(system);
    auto start = model_.start;
    if (!from_start) start.unknowns = settled_;
    auto y = motion::starting_point(system, start);
    std::vector<double> z(y.size()), row;
    Follower follower(system, tolerance_ * (finer ? fine : coarse));
    std::size_t k = 0;
    follower.observe = [&](Follower::Step& step, std::span<const Follower::Event>) {
      for (; k < samples && double(k) * interval <= step.time(); ++k) {
        const double t = double(k) * interval;
        step.interpolate(std::clamp((t - step.time_before()) / step.length(), 0.0, 1.0), z.data());
        record.observe(t, z.data(), row);
        add_friction(system, t, z.data(), row);
        sample(k, row.data());
      }
    };
    const auto outcome = follower.follow(0, y, double(samples) * interval);
    steps += follower.count().steps;
    return outcome;
  }

  /// Whether each contact sticks, and the power that becomes heat.
  void add_friction(StructureSystem& system, double t, const double* y, std::vector<double>& row) {
    force_.resize(std::size_t(system.friction_contacts()));
    system.friction_forces(t, y, force_.data());
    double power = 0;
    for (int j = 0; j < system.friction_contacts(); ++j) {
      const auto& contact = model_.structure.contacts[std::size_t(j)];
      if (contact.frictionless()) continue;
      const double slip_rate = system.slip_rate(j, t, y);
      bool sticks = std::abs(slip_rate) <= stick_threshold_ * std::abs(contact.speed.level());
      for (int c = 0; c < system.contacts(); ++c)
        if (system.friction_contact(c) == j) sticks = system.mode(c) == ContactMode::stick;
      row.push_back(sticks ? 1 : 0);
      power += force_[std::size_t(j)] * slip_rate;
    }
    row.push_back(power);
  }

  const motion::StructureModel& model_;
  double tolerance_, stick_threshold_;
  std::vector<double> settled_, force_;
};

}  // namespace

std::string regime_of(const Exponent& exponent, double mean_return) {
  constexpr double slow = 1e-2;
  if (exponent.value > 0 && !exponent.is_zero()) return "chaotic";
  return exponent.is_zero() && 5 * exponent.error * mean_return < slow ? "quasi-periodic" : "";
}

IrregularMotion irregular_motion(const motion::StructureModel& model, const Exponent& exponent, double tolerance,
                                 double stick_threshold) {
  StructureSource source(model, tolerance, stick_threshold);
  return follow_averages(source, exponent);
}

IrregularMotion irregular_motion(const motion::SteppedOscillator& oscillator, const SteppedCycle& searched,
                                 double tolerance) {
  Source source{.channels = oscillator.channels,
                .coordinates = oscillator.coordinates,
                .mean_return = oscillator.driven() ? oscillator.drive_period : oscillator.natural_period,
                .follow = {}};
  source.follow = [&](bool from_start, bool finer, double interval, std::size_t samples,
                      const Source::Sample& sample) -> Outcome {
    const auto motion = oscillator.motion(tolerance, finer);
    const double begin = from_start ? 0 : searched.start_time;
    motion->start(begin, from_start ? oscillator.start : searched.start);
    std::vector<double> row(oscillator.channels.size());
    for (std::size_t k = 0; k < samples;) {
      if (const auto outcome = motion->advance(infinity); !outcome.complete()) return outcome;
      ++source.steps;
      for (; k < samples && begin + double(k) * interval <= motion->time(); ++k) {
        motion->observe(std::max(begin + double(k) * interval, motion->time_before()), true, row.data());
        sample(k, row.data());
      }
    }
    return {};
  };
  return follow_averages(source, searched.exponent.value());
}

}  // namespace rosin::analysis::cycles
