/// Waves that leave the bow press on an end a little later, and come back from there as the end is known to reflect:
/// both ends together tell what the bow did in between (Schumacher, Garoff & Woodhouse 2005, J. Acoust. Soc. Am. 117,
/// 2232). Each side gives velocity and friction by itself; half their difference is the error of the mean.
#include "analysis/lab/string_inverse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/strings/bowing.hpp"

namespace rosin::analysis::lab {

namespace {

using oscillators::BowedString;
using oscillators::StringLanes;

/// Samples at equal intervals, between them a cubic.
class Sampled {
 public:
  Sampled(const std::vector<double>& time, const std::vector<double>& value)
      : begin_(time.front()), interval_((time.back() - time.front()) / double(time.size() - 1)), value_(value) {}
  double end() const { return begin_ + interval_ * double(value_.size() - 1); }
  double at(double t) const {
    const double place = (t - begin_) / interval_;
    const auto last = double(value_.size()) - 4;
    const auto first = std::size_t(std::clamp(std::floor(place) - 1, 0.0, last));
    double sum = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      double weight = 1;
      for (std::size_t i = 0; i < 4; ++i)
        if (i != j) weight *= (place - double(first + i)) / (double(j) - double(i));
      sum += weight * value_[first + j];
    }
    return sum;
  }

 private:
  double begin_, interval_;
  const std::vector<double>& value_;
};

/// Until waves that were on their way before a record have been forgotten: transverse ones go round once, torsional
/// ones until a thousandth is left.
double time_to_forget(const BowedString& string) {
  double periods = 1;
  constexpr double left = 1e-3;
  if (const auto& torsion = string.torsion)
    periods += torsion->quality / std::numbers::pi * std::log(1 / left) / torsion->speed_ratio;
  return periods * string.period() + 8 * string.corner_rounding;
}

void require_served(const Task& task) {
  const auto& string = task.string->string;
  const auto refuse = [](const std::string& why) { throw InputError(why); };
  if (string.bow.contacts > 1)
    refuse(
        "oscillator.bow.contacts: two forces at the ends tell one friction force and not one of each contact; give "
        "one contact");
  if (!string.body.empty())
    refuse(
        "oscillator.body: on a bridge that moves the force is not that of a wave alone; of a string on rigid ends, "
        "or with a measured oscillator.reflection, the inverse follows from both forces");
  for (const char* key : {"samples", "noise"})
    if (task.settings.given(key) && task.settings.number(key) != Settings(inverse().settings).number_or(key, 0))
      refuse(
          fmt::format("lab.{} has no effect on a string, whose motion has the samples of oscillator.sample_rate, and "
                      "whose noise is found as the difference of both sides",
                      key));
}

/// The forces as measured, and the motion that they are of where it is known.
struct Measured {
  Record forces;
  std::optional<strings::StringRecord> truth;
  bool from_rest = false;  ///< no wave is on its way before
};

Measured simulated(const Task& task, Result& result) {
  auto model = *task.string;
  const bool steady = model.speed.constant();
  model.start = steady ? oscillators::StringStart::helmholtz : oscillators::StringStart::rest;
  const double skip = task.settings.number_or("skip", 0), period = model.string.period();
  constexpr double periods = 10;
  double duration = task.settings.number_or("duration", 0);
  if (duration == 0 && steady) duration = time_to_forget(model.string) + periods * period;
  strings::BowingOptions options;
  if (duration > 0) options.duration = skip + duration;
  Measured measured;
  auto& truth = measured.truth.emplace(strings::record(model, options));
  result.outcome = truth.bowing.outcome;
  const auto begin = std::ranges::lower_bound(truth.time, skip * (1 - 1e-12)) - truth.time.begin();
  for (auto* list : {&truth.time, &truth.velocity, &truth.friction, &truth.bridge_force, &truth.nut_force})
    list->erase(list->begin(), list->begin() + begin);
  if (truth.time.size() < 8) throw InputError("lab.skip leaves nothing of the motion to be recorded");
  result.record.time = truth.time;
  result.record.add("bridge_force", "N", truth.bridge_force);
  result.record.add("nut_force", "N", truth.nut_force);
  measured.forces = measure(result.record, task.sensor, result.warnings);
  measured.from_rest = !steady && begin == 0;
  return measured;
}

Measured recorded(const Task& task) {
  const auto& [bridge, nut] = *task.end_forces;
  if (bridge.time != nut.time)
    throw InputError("lab.bridge_force and lab.nut_force must have the same times, evenly spaced");
  if (bridge.time.size() < 8)
    throw InputError(fmt::format("lab.bridge_force has {} samples; give it 8 or more", bridge.time.size()));
  Measured measured;
  measured.forces = {bridge.time, {}, {}, {}, {}, {}};
  measured.forces.add("bridge_force", "N", bridge.value);
  measured.forces.add("nut_force", "N", nut.value);
  return measured;
}

double median(std::vector<double> list) {
  const auto middle = list.begin() + std::ptrdiff_t(list.size() / 2);
  std::ranges::nth_element(list, middle);
  return *middle;
}

double rms(const std::vector<double>& list) {
  double sum = 0;
  for (const double x : list) sum += x * x;
  return std::sqrt(sum / double(list.size()));
}

}  // namespace

Result inverse_of_string(const Task& task) {
  require_served(task);
  Result result;
  const auto& model = *task.string;
  const auto measured = task.end_forces ? recorded(task) : simulated(task, result);
  if (!result.outcome.complete()) return result;
  const auto& seen = measured.forces;
  const double interval = (seen.time.back() - seen.time.front()) / double(seen.time.size() - 1);
  for (std::size_t i = 1; i < seen.time.size(); ++i)
    if (std::abs(seen.time[i] - seen.time[i - 1] - interval) > 1e-3 * interval)
      throw InputError(
          fmt::format("lab.bridge_force: times must be evenly spaced, but {} s follows {} s where the mean "
                      "interval is {:.6g} s",
                      seen.time[i], seen.time[i - 1], interval));
  const Sampled bridge(seen.time, seen.column("bridge_force")), nut(seen.time, seen.column("nut_force"));

  StringLanes string(model.string, model.law, model.lambda);
  const double step = model.string.step(), per_force = 0.5 / model.string.impedance;
  const double begin = seen.time.front(), forget = measured.from_rest ? 0 : time_to_forget(model.string);
  const double end = std::min(bridge.end() - string.way_to_bridge(), nut.end() - string.way_to_nut());
  constexpr double rounding = 1e-9;
  const auto count = long(std::floor((end - begin) / step + rounding)) + 1;
  const auto first = long(std::ceil(forget / step - rounding));
  if (constexpr double least = 1; double(count - first) * step < least * model.string.period())
    throw InputError(
        fmt::format("the record of {:.4g} s is too short: until the waves that were on their way before are forgotten "
                    "{:.4g} s go by, and as much as half a period at the end; give it {:.4g} s or more",
                    seen.time.back() - begin, forget, forget + 2 * model.string.period()));
  Record record;
  std::vector<double> velocity, friction, velocity_apart, force_apart;
  for (long n = 0; n < count; ++n) {
    const double t = begin + double(n) * step;
    const auto bow = string.step_between(per_force * bridge.at(t + string.way_to_bridge()),
                                         per_force * nut.at(t + string.way_to_nut()));
    if (n < first) continue;
    record.time.push_back(t);
    velocity.push_back(bow.velocity), friction.push_back(bow.friction);
    velocity_apart.push_back(bow.velocity_apart), force_apart.push_back(bow.force_apart);
  }
  result.plan.push_back(
      fmt::format("waves at the bow from the forces at bridge and nut, {:.4g} s and {:.4g} s later, and as the ends "
                  "send them back; the first {:.4g} s are left out",
                  string.way_to_bridge(), string.way_to_nut(), forget));

  // What the sides differ by is twice the error of their mean where errors of both forces are alike.
  constexpr double wide = 3, half = 0.5, arithmetic = 1e-12;
  const auto band_of = [&](const std::vector<double>& apart, const std::vector<double>& of) {
    const double usual = wide * half * rms(apart) + arithmetic * rms(of);
    std::vector<double> band;
    for (const double x : apart) band.push_back(std::max(usual, std::abs(x)));
    return band;
  };
  const auto band = band_of(force_apart, friction), velocity_band = band_of(velocity_apart, velocity);
  std::vector<double> slip_rate, low, high;
  for (std::size_t i = 0; i < friction.size(); ++i) {
    slip_rate.push_back(model.speed.value(record.time[i]) - velocity[i]);
    low.push_back(friction[i] - band[i]), high.push_back(friction[i] + band[i]);
  }
  const auto largest = std::ranges::max_element(friction, {}, [](double f) { return std::abs(f); }) - friction.begin();
  const auto [slowest, fastest] = std::ranges::minmax(velocity);
  std::vector<double> sticking, slipping;
  for (const double v : velocity) (v > 0.5 * (slowest + fastest) ? sticking : slipping).push_back(v);
  const double of_velocity = half * rms(velocity_apart), of_force = half * rms(force_apart);
  result.readings = {
      {"force_max", "N", "largest friction force", std::abs(friction[std::size_t(largest)]),
       band[std::size_t(largest)]},
      {"sticking_velocity", "m/s", "median velocity of the string above the middle of its range", median(sticking),
       of_velocity},
      {"slipping_velocity", "m/s", "median velocity of the string below the middle of its range", median(slipping),
       of_velocity},
      {"force_apart", "N", "rms of half the difference between friction by either side", of_force},
      {"velocity_apart", "m/s", "rms of half the difference between the velocity by either side", of_velocity}};
  record.add("velocity", "m/s", velocity);
  record.add("slip_rate", "m/s", slip_rate);
  record.add("friction_force", "N", friction);
  record.add("band", "N", band);
  record.add("velocity_band", "m/s", velocity_band);

  // The last periods are shown.
  constexpr double shown = 4;
  const auto from =
      std::ranges::lower_bound(record.time, record.time.back() - shown * model.string.period()) - record.time.begin();
  const auto part = [&](const std::vector<double>& list) {
    return std::vector<double>(list.begin() + from, list.end());
  };
  Panel of_velocities{.x_label = "time",
                      .x_unit = "s",
                      .y_label = "velocity of the string",
                      .y_unit = "m/s",
                      .curves = {{.label = "reconstructed", .x = part(record.time), .y = part(velocity)}}};
  Panel history{.x_label = "time",
                .x_unit = "s",
                .y_label = "friction force F",
                .y_unit = "N",
                .curves = {{.label = "reconstructed",
                            .x = part(record.time),
                            .y = part(friction),
                            .low = part(low),
                            .high = part(high)}}};
  if (measured.truth) {
    std::vector<double> true_velocity, true_friction, off, velocity_off;
    std::size_t covered = 0;
    for (std::size_t i = 0; i < friction.size(); ++i) {
      const auto at = std::size_t(first) + i;
      true_velocity.push_back(measured.truth->velocity[at]), true_friction.push_back(measured.truth->friction[at]);
      off.push_back(friction[i] - true_friction.back()), velocity_off.push_back(velocity[i] - true_velocity.back());
      covered += std::abs(off.back()) <= band[i];
    }
    const auto worst = [](const std::vector<double>& list) {
      double most = 0;
      for (const double x : list) most = std::max(most, std::abs(x));
      return most;
    };
    result.readings.push_back({"error_rms", "N", "rms of the difference to the true force", rms(off)});
    result.readings.push_back({"error_max", "N", "largest difference to the true force", worst(off)});
    result.readings.push_back(
        {"velocity_error_rms", "m/s", "rms of the difference to the true velocity", rms(velocity_off)});
    result.readings.push_back(
        {"velocity_error_max", "m/s", "largest difference to the true velocity", worst(velocity_off)});
    result.readings.push_back({"coverage", "1", "part of the record in which the true force lies within the band",
                               double(covered) / double(friction.size())});
    of_velocities.curves.push_back({"true", part(record.time), part(true_velocity)});
    history.curves.push_back({"true", part(record.time), part(true_friction)});
    record.add("true_velocity", "m/s", std::move(true_velocity));
    record.add("true_friction_force", "N", std::move(true_friction));
  }
  result.panels = {std::move(of_velocities),
                   std::move(history),
                   {.x_label = "slip rate v",
                    .x_unit = "m/s",
                    .y_label = "friction force F",
                    .y_unit = "N",
                    .curves = {{"", part(slip_rate), part(friction)}}}};
  result.record = std::move(record);
  return result;
}

}  // namespace rosin::analysis::lab
