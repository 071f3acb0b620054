/// Steps cut at returns; extremes at the full order of the steps, integrals by Gauss's rule on their parts.
#include "analysis/cycles/stepped_returns.hpp"

#include <fmt/format.h>

#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numeric>

#include "analysis/motion/motion_record.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::cycles {

using motion::MotionRecord;

SteppedReturns::SteppedReturns(const motion::SteppedOscillator& oscillator, double tolerance, bool finer)
    : oscillator_(oscillator),
      motion_(oscillator.motion(tolerance, finer)),
      watched_(std::max(oscillator.watched, 0)),
      row_(oscillator.channels.size()) {
  start(0, oscillator.start);
}

void SteppedReturns::start(double t, const std::vector<double>& state) {
  motion_->start(t, state);
  // The moment of the drive at or before t from which periods are counted.
  phase_ = oscillator_.driven() ? std::floor(t / oscillator_.drive_period) * oscillator_.drive_period : 0;
  begin_ = t, periods_ = 0;
}

double SteppedReturns::velocity(double t, bool near) {
  motion_->observe(t, near, row_.data());
  return row_[std::size_t(oscillator_.coordinates + watched_)];
}

/// Where the velocity of the watched coordinate passes 0 between two moments of the step.
double SteppedReturns::crossing(double from, double to) {
  const double before = velocity(from, false), after = velocity(to, false);
  if (before == 0 || (before > 0) == (after > 0)) return to;  // the polynomial and the solution differ there
  std::uintmax_t most = 60;
  const auto [low, high] =
      boost::math::tools::toms748_solve([this](double t) { return velocity(t, false); }, from, to, before, after,
                                        boost::math::tools::eps_tolerance<double>(48), most);
  return std::midpoint(low, high);
}

/// Takes what the last step shows between two moments, up to a return. \returns whether there is one
bool SteppedReturns::take(double from, double to, SteppedReturn& into, bool measured) {
  bool returns = false;
  const double until = phase_ + double(periods_ + 1) * oscillator_.drive_period;
  if (oscillator_.driven() && to >= until) to = until, returns = true;
  const double whole = motion_->time() - motion_->time_before();
  int parts = whole > 0 ? std::max(1, int(std::ceil(motion_->parts() * (to - from) / whole))) : 1;
  const bool looks_for_extrema = extremum != nullptr || !oscillator_.driven();
  double before = looks_for_extrema ? velocity(from, true) : 0, left = from;
  std::vector<double> nodes;
  for (int k = 1; k <= parts; ++k) {
    const double right = k == parts ? to : std::lerp(from, to, double(k) / parts);
    if (looks_for_extrema) {
      const double after = velocity(right, true);
      const bool maximum = before > 0 && after <= 0, minimum = before < 0 && after >= 0;
      if (maximum || minimum) {
        const double at = crossing(left, right);
        if (extremum) {
          motion_->observe(at, false, row_.data());
          extremum(row_);
        }
        constexpr double apart = 1e-6;  // natural periods: that of the last return is not met again
        if (maximum && !oscillator_.driven() && at > begin_ + apart * oscillator_.natural_period) {
          to = at, returns = true, parts = k;
          break;
        }
      }
      before = after;
    }
    nodes.push_back(right), left = right;
  }
  nodes.push_back(to);
  for (const double t : nodes) {
    motion_->observe(t, true, row_.data());
    for (std::size_t c = 0; c < row_.size(); ++c)
      into.low[c] = std::min(into.low[c], row_[c]), into.high[c] = std::max(into.high[c], row_[c]);
  }
  if (returns) {
    motion_->observe(to, false, row_.data());
    into.row = row_, into.duration = to - begin_;
  }
  if (measured && to > from) {
    const auto columns = row_.size();
    static const std::vector<double> no_samples;
    MotionRecord record(columns, 0, no_samples);
    record.step(
        from, to, nodes, [&](double t, double* row) { motion_->observe(t, true, row); },
        [&](double t, double* row) { motion_->observe(t, false, row); });
    constexpr std::array<std::pair<double, double>, 3> gauss = {
        {{0.5 - 0.3872983346207417, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + 0.3872983346207417, 5.0 / 18}}};
    const auto note = [&](double t) {
      motion_->observe(t, true, row_.data());
      into.time.push_back(t - begin_), into.rows.push_back(row_);
    };
    if (into.time.empty()) note(from);
    double last = from;
    for (const double t : nodes) {
      for (const auto& [place, weight] : gauss) {
        motion_->observe(std::lerp(last, t, place), true, row_.data());
        for (std::size_t c = 0; c < columns; ++c) into.integral[c] += weight * (t - last) * row_[c];
      }
      if (t > last) note(t);
      last = t;
    }
    for (std::size_t c = 0; c < columns; ++c)
      into.low[c] = std::min(into.low[c], record.low(c)), into.high[c] = std::max(into.high[c], record.high(c));
  }
  if (returns) begin_ = to, ++periods_;
  return returns;
}

Outcome SteppedReturns::next(SteppedReturn& into, bool measured) {
  const auto channels = oscillator_.channels.size();
  into = {};
  into.low.assign(channels, infinity), into.high.assign(channels, -infinity), into.integral.assign(channels, 0.0);
  constexpr double patience = 100;  // natural periods
  const double end = begin_ + patience * oscillator_.natural_period;
  const double limit = oscillator_.driven() ? phase_ + double(periods_ + 1) * oscillator_.drive_period : end;
  if (motion_->time() > begin_ && take(begin_, motion_->time(), into, measured)) return {Ending::event, ""};
  while (oscillator_.driven() || motion_->time() < end) {
    end_if_stopped();
    if (++steps_ > most_steps)
      return {Ending::budget_spent, fmt::format("{} steps at t = {:.9g} s", most_steps, motion_->time())};
    if (const auto outcome = motion_->advance(limit); !outcome.complete()) return outcome;
    if (take(motion_->time_before(), motion_->time(), into, measured)) return {Ending::event, ""};
  }
  motion_->observe(motion_->time(), false, row_.data());
  into.row = row_, into.duration = motion_->time() - begin_;
  return {Ending::none_exists, "the motion does not return"};
}

}  // namespace rosin::analysis::cycles
