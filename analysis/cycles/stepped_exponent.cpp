/// Neighbouring motions, renormalised.
#include "analysis/cycles/stepped_exponent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/stop.hpp"

namespace rosin::analysis::cycles {

using motion::SteppedMotion, motion::SteppedOscillator;

namespace {

constexpr int parts_of_period = 8;  ///< pieces in a period of the drive, or in the longest natural one

double piece_of(const SteppedOscillator& oscillator) {
  return (oscillator.driven() ? oscillator.drive_period : oscillator.natural_period) / parts_of_period;
}

/// Two motions, piece after piece.
class Neighbours {
 public:
  Neighbours(const SteppedOscillator& oscillator, double tolerance, bool finer)
      : oscillator_(oscillator),
        one_(oscillator.motion(tolerance, finer)),
        other_(oscillator.motion(tolerance, finer)) {}

  /// From a state: the other motion beside it, farther by a part of the range of a state.
  void start(double t, std::vector<double> state, double distance, const std::vector<double>& direction) {
    distance_ = distance, begin_ = t, pieces_ = 0;
    one_->start(t, state);
    const double length = norm(direction);
    for (std::size_t i = 0; i < state.size(); ++i) state[i] += distance / length * direction[i];
    other_->start(t, state);
  }
  /// One piece. \returns ln of what the difference has grown by; −∞: it is forgotten
  Outcome follow(double piece, double& growth) {
    end_if_stopped();
    const double until = begin_ + double(++pieces_) * piece;
    for (auto* motion : {one_.get(), other_.get()}) {
      constexpr double rounding = 1e-12;
      while (motion->time() < until - rounding * piece) {
        ++steps;
        if (const auto outcome = motion->advance(until); !outcome.complete()) return outcome;
      }
    }
    const auto state = one_->state();
    auto difference = other_->state();
    for (std::size_t i = 0; i < state.size(); ++i) difference[i] -= state[i];
    const double length = norm(difference);
    if (!std::isfinite(length)) return {Ending::not_finite, fmt::format("at t = {:.9g} s", one_->time())};
    constexpr double forgotten = 1e-5;  // below it the accuracy of steps is seen
    growth = length > forgotten * distance_ ? std::log(length / distance_) : -infinity;
    if (std::isinf(growth)) return {};
    direction_ = std::move(difference);
    const double t = one_->time();
    auto beside = state;
    for (std::size_t i = 0; i < beside.size(); ++i) beside[i] += distance_ / length * direction_[i];
    other_->start(t, beside);
    return {};
  }
  double norm(const std::vector<double>& state) const {
    double sum = 0;
    for (std::size_t i = 0; i < state.size(); ++i)
      sum += state[i] / oscillator_.size[i] * (state[i] / oscillator_.size[i]);
    return std::sqrt(sum);
  }
  double time() const { return one_->time(); }
  std::vector<double> state() const { return one_->state(); }
  const std::vector<double>& direction() const { return direction_; }

  long steps = 0;

 private:
  const SteppedOscillator& oscillator_;
  std::unique_ptr<SteppedMotion> one_, other_;
  double distance_ = 0, begin_ = 0;
  long pieces_ = 0;
  std::vector<double> direction_;
};

/// A direction in which no entry of the state stays away.
std::vector<double> mixed_direction(const SteppedOscillator& oscillator) {
  std::vector<double> direction;
  for (std::size_t i = 0; i < oscillator.size.size(); ++i)
    direction.push_back(std::isfinite(oscillator.size[i]) ? std::cos(double(i)) * oscillator.size[i] : 0);
  return direction;
}

struct GrowthAverage {
  Outcome outcome;
  std::vector<double> series, course, time;  ///< growth of each piece, its mean so far, and when
  double value = NAN, error = infinity;      ///< 1/s
  bool levelled = true, forgotten = false, moves = false;
  long steps = 0;
  double t = 0;
  std::vector<double> state, direction;
};

/// \param relaxing  pieces before the average, of which the first half is followed alone
GrowthAverage average_growth(const SteppedOscillator& oscillator, double tolerance, bool finer, double t,
                             std::vector<double> state, std::vector<double> direction, double distance, long relaxing,
                             long wanted, const std::function<void(double)>& progress) {
  GrowthAverage result;
  const double piece = piece_of(oscillator);
  Neighbours pair(oscillator, tolerance, finer);
  pair.start(t, state, distance, direction);
  result.state = state, result.direction = std::move(direction), result.t = t;
  double sum = 0;
  for (long k = 0; k < relaxing + wanted && !result.forgotten; ++k) {
    double growth = 0;
    result.outcome = pair.follow(piece, growth);
    if (!result.outcome.complete()) break;
    result.forgotten = std::isinf(growth);
    auto now = pair.state();
    for (std::size_t i = 0; i < now.size(); ++i)
      result.moves |= std::abs(now[i] - result.state[i]) > 1e-6 * oscillator.size[i];
    result.state = std::move(now), result.t = pair.time();
    if (k < relaxing || result.forgotten) continue;
    sum += growth;
    result.series.push_back(growth);
    const double count = double(result.series.size());
    result.time.push_back(count * piece), result.course.push_back(sum / (count * piece));
    if (progress) progress(double(k + 1) / double(relaxing + wanted));
  }
  result.steps = pair.steps;
  if (!pair.direction().empty()) result.direction = pair.direction();
  if (result.forgotten) {
    result.value = -infinity, result.error = 0;
  } else if (!result.series.empty()) {
    // By whole periods: within one the growth is not that of the next part.
    std::vector<double> periods;
    for (std::size_t i = 0; i + parts_of_period <= result.series.size(); i += parts_of_period)
      periods.push_back(
          std::accumulate(result.series.begin() + long(i), result.series.begin() + long(i) + parts_of_period, 0.0));
    const auto error = blocked_error(periods);
    result.value = sum / (double(result.series.size()) * piece);
    // Of a few periods the mean so far shows how well the mean is known.
    double moved = 0;
    for (std::size_t i = result.course.size() / 2; i < result.course.size(); ++i)
      moved = std::max(moved, std::abs(result.course[i] - result.value));
    result.error = std::isfinite(error.value) ? error.value / (piece * parts_of_period) : moved;
    result.levelled = error.levelled;
  }
  return result;
}

/// Of the range of a motion: small beside it, and large beside what steps leave unknown.
constexpr double at_first = 1e-6, then = 3e-7;

Exponent exponent_of(const GrowthAverage& first, const GrowthAverage& second) {
  if (first.forgotten || second.forgotten) return {-infinity, 0};
  return {(first.value + second.value) / 2,
          std::max({first.error, second.error, std::abs(first.value - second.value) / 2})};
}

}  // namespace

LyapunovSpectrum lyapunov_spectrum(const SteppedOscillator& oscillator, const LyapunovOptions& options) {
  if (options.duration <= 0)
    throw InputError(
        "lyapunov.duration (s) is needed: the exponent of a motion by steps is an average over it, of two neighbouring "
        "motions");
  const double piece = piece_of(oscillator);
  LyapunovSpectrum spectrum;
  spectrum.from = "average", spectrum.clocks = oscillator.driven() ? 1 : 0;
  spectrum.sum = spectrum.divergence = NAN;  // of all exponents, of which one is computed
  constexpr double part = 0.1;
  const double transient = options.transient >= 0 ? options.transient : part * options.duration;
  const long relaxing = std::max(2L, std::lround(transient / piece)),
             half = std::max(2L, std::lround(options.duration / piece / 2));
  if (double(relaxing + 2 * half) * parts_of_period > double(options.most_steps))
    throw InputError(fmt::format("lyapunov.duration = {} s is {:.3g} periods of {:.4g} s; take it shorter",
                                 options.duration, options.duration / piece / parts_of_period,
                                 piece * parts_of_period));
  const auto tell = [&](double from, double to) {
    return [&, from, to](double done) {
      if (options.progress) options.progress(std::lerp(from, to, done));
    };
  };
  GrowthAverage first, second;
  try {
    first = average_growth(oscillator, options.accuracy, false, 0, oscillator.start, mixed_direction(oscillator),
                           at_first, relaxing, half, tell(0, 0.5));
    spectrum.outcome = first.outcome;
    if (first.outcome.complete() && !first.forgotten) {
      second = average_growth(oscillator, options.accuracy, true, first.t, first.state, first.direction, then, 0, half,
                              tell(0.5, 1));
      spectrum.outcome = second.outcome;
    }
  } catch (const Stopped&) {
    spectrum.outcome = {Ending::interrupted, "the average is not done"};
    return spectrum;
  }
  spectrum.cost.steps = first.steps + second.steps;
  spectrum.transient = double(relaxing) * piece;
  spectrum.duration = double(first.series.size() + second.series.size()) * piece;
  spectrum.levelled = first.levelled && second.levelled;
  if (!spectrum.outcome.complete()) return spectrum;
  auto exponent = exponent_of(first, second);
  exponent.trivial = !oscillator.driven() && first.moves && exponent.is_zero();
  spectrum.exponents = {exponent};
  if (std::isfinite(exponent.value)) {
    spectrum.time = first.time, spectrum.course = {first.course};
    for (std::size_t i = 0; i < second.time.size(); ++i) {
      spectrum.time.push_back(first.time.back() + second.time[i]);
      const double all = first.time.back() + second.time[i];
      spectrum.course[0].push_back((first.value * first.time.back() + second.course[i] * second.time[i]) / all);
    }
  }
  if (options.tolerance > 0 && exponent.error > options.tolerance)
    spectrum.outcome = {Ending::tolerance_not_met, fmt::format("after {:.9g} s the largest exponent is known to {:.2g} "
                                                               "1/s; give lyapunov.duration more",
                                                               spectrum.duration, exponent.error)};
  return spectrum;
}

std::optional<Exponent> largest_exponent(const SteppedOscillator& oscillator, double tolerance, double t,
                                         const std::vector<double>& state, double mean_return, long most_returns) {
  constexpr long relaxing = 30;
  const long wanted = std::max(2L, std::lround(double(most_returns) * mean_return / piece_of(oscillator) / 2));
  const auto first = average_growth(oscillator, tolerance, false, t, state, mixed_direction(oscillator), at_first,
                                    relaxing * parts_of_period, wanted, {});
  if (!first.outcome.complete()) return std::nullopt;
  if (first.forgotten) return Exponent{-infinity, 0};
  const auto second =
      average_growth(oscillator, tolerance, true, first.t, first.state, first.direction, then, 0, wanted, {});
  if (!second.outcome.complete()) return std::nullopt;
  return exponent_of(first, second);
}

}  // namespace rosin::analysis::cycles
