/// The measuring chain: a pole solved exactly between samples, linear resampling, noise from a counter.
#include "analysis/lab/sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/random.hpp"

namespace rosin::analysis::lab {

namespace {

/// ẏ = ω (x − y) for x linear between samples, from rest on the first.
std::vector<double> low_passed(const std::vector<double>& t, const std::vector<double>& x, double corner) {
  const double omega = 2 * std::numbers::pi * corner;
  std::vector<double> y(x.size());
  y[0] = x[0];
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double h = omega * (t[i] - t[i - 1]), slope = (x[i] - x[i - 1]) / h, forget = -std::expm1(-h);
    // y tends to the line x(t) − slope, from its difference at the last sample
    y[i] = x[i] - slope + (y[i - 1] - x[i - 1] + slope) * (1 - forget);
  }
  return y;
}

double interpolate(const std::vector<double>& t, const std::vector<double>& x, double at, std::size_t& hint) {
  while (hint + 2 < t.size() && t[hint + 1] <= at) ++hint;
  const double part = std::clamp((at - t[hint]) / (t[hint + 1] - t[hint]), 0.0, 1.0);
  return std::lerp(x[hint], x[hint + 1], part);
}

/// The part of a record's variance (in time) that straight lines between samples miss.
double unseen(const Record& truth, const std::vector<double>& x, const Record& sampled,
              const std::vector<double>& samples) {
  double mean = 0, duration = 0, total = 0, missed = 0;
  const auto over_time = [&](auto add) {
    for (std::size_t i = 1; i < x.size(); ++i) add(i, truth.time[i] - truth.time[i - 1]);
  };
  over_time([&](std::size_t i, double h) { mean += h * x[i], duration += h; });
  mean /= duration;
  std::size_t hint = 0;
  over_time([&](std::size_t i, double h) {
    if (truth.time[i] > sampled.time.back()) return;
    total += h * (x[i] - mean) * (x[i] - mean);
    const double gap = x[i] - interpolate(sampled.time, samples, truth.time[i], hint);
    missed += h * gap * gap;
  });
  return total > 0 ? missed / total : 0;
}

constexpr double aliases = 0.01;  ///< unseen part of the variance from which a column is said to alias
constexpr Range positive{0, 1e15};

}  // namespace

const std::vector<double>& Record::column(std::string_view name) const {
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) {
    const auto near = nearest_name(name, names);
    throw InputError(fmt::format("the record has no column '{}'{}", name,
                                 near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
  }
  return columns[static_cast<std::size_t>(at - names.begin())];
}

void Record::add(std::string name, std::string unit, std::vector<double> values, double error) {
  names.push_back(std::move(name));
  units.push_back(std::move(unit));
  errors.push_back(error);
  columns.push_back(std::move(values));
}

bool Sensor::ideal() const {
  return low_pass == 0 && sample_rate == 0 && noise.empty() && resolution.empty() && range.empty();
}

Record measure(const Record& truth, const Sensor& sensor, std::vector<std::string>& warnings) {
  require(sensor.low_pass, positive, "lab.sensor.low_pass", "corner frequency, 0 for none", "Hz");
  require(sensor.sample_rate, positive, "lab.sensor.sample_rate", "samples per second, 0 for the record's own", "Hz");
  for (const auto& [list, key] : {std::pair{&sensor.noise, "noise"}, std::pair{&sensor.resolution, "resolution"},
                                  std::pair{&sensor.range, "range"}})
    for (const auto& [name, value] : *list) {
      truth.column(name);
      require(value, {0, 1e300}, fmt::format("lab.sensor.{}.{}", key, name), "in the unit of the column", "SI");
    }
  if (sensor.ideal() || truth.time.size() < 2) return truth;

  Record measured = truth;
  measured.columns.clear();
  if (sensor.sample_rate > 0) {
    const double begin = truth.time.front(), duration = truth.time.back() - begin;
    const double intervals = std::floor(duration * sensor.sample_rate * (1 + 1e-12));
    if (intervals < 8 || intervals > 2e7)
      throw InputError(
          fmt::format("lab.sensor.sample_rate = {} Hz takes {:.3g} samples in the {:.3g} s of this record; "
                      "between {:.3g} and {:.3g} Hz are of use",
                      sensor.sample_rate, intervals, duration, 8 / duration, 2e7 / duration));
    measured.time.resize(static_cast<std::size_t>(intervals) + 1);
    for (std::size_t i = 0; i < measured.time.size(); ++i) measured.time[i] = begin + double(i) / sensor.sample_rate;
  }
  for (std::size_t c = 0; c < truth.columns.size(); ++c) {
    const auto& name = truth.names[c];
    const auto seen =
        sensor.low_pass > 0 ? low_passed(truth.time, truth.columns[c], sensor.low_pass) : truth.columns[c];
    std::vector<double> samples = seen;
    if (sensor.sample_rate > 0) {
      samples.resize(measured.time.size());
      std::size_t hint = 0;
      for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = interpolate(truth.time, seen, measured.time[i], hint);
      measured.columns.push_back(samples);
      if (const double part = unseen(truth, seen, measured, samples); part > aliases)
        warnings.push_back(
            fmt::format("{} aliases: at {:.6g} Hz {:.0f} % of its variance falls between samples; raise "
                        "lab.sensor.sample_rate, or put a low_pass before it",
                        name, sensor.sample_rate, 100 * part));
    } else {
      measured.columns.push_back(samples);
    }
    auto& column = measured.columns.back();
    if (const auto rms = sensor.noise.find(name); rms != sensor.noise.end()) {
      const auto noise = white_noise(column.size(), splitmix(sensor.seed + splitmix_step) + c);
      for (std::size_t i = 0; i < column.size(); ++i) column[i] += rms->second * noise[i];
    }
    if (const auto step = sensor.resolution.find(name); step != sensor.resolution.end() && step->second > 0)
      for (double& x : column) x = step->second * std::round(x / step->second);
    if (const auto most = sensor.range.find(name); most != sensor.range.end()) {
      long held = 0;
      for (double& x : column) {
        held += std::abs(x) > most->second;
        x = std::clamp(x, -most->second, most->second);
      }
      if (held > 0)
        warnings.push_back(fmt::format("{} saturates: {} of {} samples lie beyond ± {:.6g} {}", name, held,
                                       column.size(), most->second, measured.units[c]));
    }
  }
  return measured;
}

}  // namespace rosin::analysis::lab
