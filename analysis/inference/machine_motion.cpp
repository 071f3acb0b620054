/// Columns of a machine's motion, and their slopes by differences of runs.
#include "analysis/inference/machine_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/workers.hpp"

namespace rosin::analysis::inference {

namespace {

/// The slope between three values with steps of `low` and `high` in between, one of which may be 0: that side is not
/// known. A located switch that passes the sample makes the difference of one side far larger than the other.
double slope(double before, double here, double after, double low, double high) {
  const double left = (here - before) / low, right = (after - here) / high;
  if (low == 0) return right;
  if (high == 0) return left;
  constexpr double apart = 0.5;
  const double larger = std::max(std::abs(left), std::abs(right));
  if (std::abs(right - left) > apart * larger) return std::abs(left) < std::abs(right) ? left : right;
  return (left * high + right * low) / (low + high);
}

/// The column at each x of a record.
std::vector<double> seen(const Machine::Motion& motion, const std::string& column, const std::vector<double>& x,
                         double later) {
  const auto& values = motion.column(column);
  std::vector<double> y;
  for (const double t : x) y.push_back(values[motion.at(t + later)]);
  return y;
}

/// Root mean square of the difference, over the spread of a column.
double change(const std::vector<double>& y, const std::vector<double>& other) {
  const auto [low, high] = std::ranges::minmax(y);
  const double size = high > low ? high - low : std::max(std::abs(high), 1e-300);
  double sum = 0;
  for (std::size_t k = 0; k < y.size(); ++k) sum += std::pow((other[k] - y[k]) / size, 2);
  return std::sqrt(sum / double(y.size()));
}

/// The slip rate of the contact that a column is numbered like, else of the first; empty where no contact slips.
std::string slip_rate_beside(const std::string& column, const std::vector<std::string>& names) {
  const auto number = column.rfind('_');
  std::string first;
  for (const auto& name : names) {
    if (!name.starts_with("slip_rate")) continue;
    if (first.empty()) first = name;
    if (number != std::string::npos && name == "slip_rate" + column.substr(number)) return name;
  }
  return first;
}

}  // namespace

Prediction predict_motion(const Subject& subject, const Measurement& m, const std::vector<std::string>& paths,
                          double clock_offset) {
  const auto& machine = *subject.machines.at(*m.machine);
  Prediction prediction;
  const auto at = [&](const MachineNumbers& numbers, double beside, long& steps) {
    return machine.motion(numbers, clock_offset, beside, steps);
  };
  // A twentieth of the spacing of samples leaves the polynomial of a motion that they resolve within 1e-4.
  const auto& times = machine.times();
  const double mean_spacing = (times.back() - times.front()) / double(std::max<std::size_t>(1, times.size() - 1));
  const double beside = m.terms.clock_offset ? mean_spacing / 20 : 0;
  const auto own = at(subject.changed, beside, prediction.steps);
  auto& y = prediction.y = seen(*own, m.column, m.x, -clock_offset);
  if (const auto rate = slip_rate_beside(m.column, own->names); !rate.empty())
    prediction.slip_rate = seen(*own, rate, m.x, -clock_offset);
  for (std::size_t k = 0; beside > 0 && k < m.x.size(); ++k) {
    const auto value = [&](double shift) { return own->column(m.column)[own->at(m.x[k] - clock_offset + shift)]; };
    const bool started = m.x[k] - clock_offset - beside >= 0;
    prediction.by_clock.push_back(-slope(value(-beside), y[k], value(beside), started ? beside : 0, beside));
  }

  prediction.slopes.assign(paths.size(), std::vector<double>(y.size(), 0.0));
  std::vector<long> steps(paths.size(), 0);
  in_parallel(machine.threads(), paths.size(), [&](std::size_t i) {
    if (!machine.depends_on(paths[i])) return;
    const double value = subject.get(paths[i]), least = 1e-9;
    const auto moved = [&](double step, std::vector<double>& other) {
      try {
        other = seen(*at(subject.with(paths[i], value + step).changed, 0, steps[i]), m.column, m.x, -clock_offset);
        return std::abs(step);
      } catch (const InputError&) {  // the end of the number's range
        other = y;
        return 0.0;
      }
    };
    // Runs known to 1e-9 tell a change of 1e-5 to 1e-4 of it; one of a twentieth is no longer straight.
    constexpr double faint = 1e-5, strong = 0.05, factor = 30, most_part = 0.03;
    double step = value != 0 ? motion_part * std::abs(value) : least;
    std::vector<double> before, after;
    double low = 0, high = 0;
    for (int attempt = 0;; ++attempt) {
      low = moved(-step, before), high = moved(step, after);
      if (low == 0 && high == 0)
        throw InputError(fmt::format("{}: no motion beside {} = {:.6g}", m.name, paths[i], value));
      const double changed = std::max(change(y, before), change(y, after));
      constexpr int most_attempts = 6;
      if (attempt == most_attempts) break;
      if (changed < faint && (value == 0 || step < most_part * std::abs(value)))
        step = value == 0 ? factor * step : std::min(factor * step, most_part * std::abs(value));
      else if (changed > strong && attempt < 2)
        step /= factor;
      else
        break;
    }
    for (std::size_t k = 0; k < y.size(); ++k) prediction.slopes[i][k] = slope(before[k], y[k], after[k], low, high);
  });
  for (const long some : steps) prediction.steps += some;
  return prediction;
}

}  // namespace rosin::analysis::inference
