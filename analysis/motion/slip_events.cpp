/// Slip events out of a run's located switches, or out of its samples.
#include "analysis/motion/slip_events.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rosin::analysis::motion {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Where slip began, or ended: a time and the slider's displacement.
struct Moment {
  double time, displacement;
};
struct Slip {
  Moment begin, end;
};

std::vector<Slip> between_switches(const Run& run) {
  std::vector<Slip> slips;
  std::optional<Moment> begin;
  for (const auto& event : run.events) {
    if (event.kind == "slip") begin = Moment{event.time, event.displacement};
    if (event.kind == "stick" && begin && event.time > begin->time)
      slips.push_back({*begin, {event.time, event.displacement}});
    if (event.kind == "stick") begin.reset();
  }
  return slips;
}

const std::vector<double>* column(const Run& run, std::string_view name) {
  const auto found = std::ranges::find(run.column_names, name);
  return found == run.column_names.end() ? nullptr : &run.columns[std::size_t(found - run.column_names.begin())];
}

/// The moment between samples i − 1 and i at which the slider turns: its velocity is linear in between, and its
/// displacement, whose rate is zero there, the cubic of both ends.
Moment turn(const Run& run, const std::vector<double>& x, const std::vector<double>& velocity, std::size_t i) {
  const double h = run.time[i] - run.time[i - 1], v0 = velocity[i - 1], v1 = velocity[i], s = v0 / (v0 - v1);
  const double rest = 1 - s;
  return {run.time[i - 1] + s * h,
          (1 + 2 * s) * rest * rest * x[i - 1] + s * s * (3 - 2 * s) * x[i] + h * s * rest * (rest * v0 - s * v1)};
}

/// \param V speed of the drive, m/s
std::vector<Slip> above_drive(const Run& run, double V, double stick_threshold) {
  const auto *x = column(run, "displacement"), *velocity = column(run, "velocity");
  std::vector<Slip> slips;
  if (!x || !velocity) return slips;
  bool stuck = false;
  std::optional<Moment> begin;
  for (std::size_t i = 1; i < velocity->size(); ++i) {
    const double before = 1 - (*velocity)[i - 1] / V, now = 1 - (*velocity)[i] / V;  // slip rates over V
    if (before < stick_threshold) stuck = true;
    if (stuck && before <= 1 && now > 1) begin = turn(run, *x, *velocity, i), stuck = false;
    if (begin && before > 1 && now <= 1) {
      slips.push_back({*begin, turn(run, *x, *velocity, i)});
      begin.reset();
    }
  }
  return slips;
}

/// The vertex of the parabola through a sample and its neighbours.
double vertex(const std::vector<double>& time, const std::vector<double>& value, std::size_t i) {
  const double h0 = time[i] - time[i - 1], h1 = time[i + 1] - time[i];
  const double slope0 = (value[i] - value[i - 1]) / h0, slope1 = (value[i + 1] - value[i]) / h1;
  const double curvature = (slope1 - slope0) / (h0 + h1), slope = (slope0 * h1 + slope1 * h0) / (h0 + h1);
  return curvature == 0 ? value[i] : value[i] - slope * slope / (4 * curvature);
}

/// Without errors.
SlipEvents find_events(const Model& model, const Run& run, double stick_threshold) {
  SlipEvents events;
  const double V = model.drive.speed.level(), k = model.slider.stiffness;
  if (!model.drive.speed.constant() || V == 0 || k == infinity) return events;
  const auto slips = model.law->set_valued() ? between_switches(run) : above_drive(run, V, stick_threshold);
  const auto* rate = column(run, "slip_rate");
  for (const auto& [begin, end] : slips) {
    const double duration = end.time - begin.time, drop = k * (begin.displacement - end.displacement);
    events.recurrence.push_back(events.onset.empty() ? nan : begin.time - events.onset.back());
    events.onset.push_back(begin.time);
    events.duration.push_back(duration);
    events.force_drop.push_back(drop);
    events.friction_drop.push_back(drop / model.drive.normal_load.value(begin.time));
    events.slip.push_back(V * duration + begin.displacement - end.displacement);
    const auto first = std::size_t(std::ranges::lower_bound(run.time, begin.time) - run.time.begin());
    const auto last = std::size_t(std::ranges::upper_bound(run.time, end.time) - run.time.begin());
    const int samples = int(last - first);
    events.fewest_samples = events.onset.size() == 1 ? samples : std::min(events.fewest_samples, samples);
    if (!rate || samples == 0) {
      events.peak_slip_rate.push_back(nan);
      continue;
    }
    std::size_t top = first;
    for (std::size_t i = first; i < last; ++i)
      if ((*rate)[i] / V > (*rate)[top] / V) top = i;
    events.peak_slip_rate.push_back(top > first && top + 1 < last ? vertex(run.time, *rate, top) : (*rate)[top]);
  }
  return events;
}

/// Of a record, the events and every second sample.
Run every_second(const Run& run) {
  Run half;
  half.column_names = run.column_names, half.events = run.events;
  half.columns.resize(run.columns.size());
  for (std::size_t i = 0; i < run.time.size(); i += 2) {
    half.time.push_back(run.time[i]);
    for (std::size_t c = 0; c < run.columns.size(); ++c) half.columns[c].push_back(run.columns[c][i]);
  }
  return half;
}

/// What the run states of a column.
double stated(const Run& run, std::string_view name) {
  const auto c = std::size_t(std::ranges::find(run.column_names, name) - run.column_names.begin());
  return c < run.column_error.size() ? run.column_error[c] : 0;
}

}  // namespace

SlipEvents slip_events(const Model& model, const Run& run, double stick_threshold) {
  auto events = find_events(model, run, stick_threshold);
  if (events.onset.empty()) return events;
  const auto half = find_events(model, every_second(run), stick_threshold);
  const auto error = [&](std::vector<double> SlipEvents::*column, double stated_error) {
    const auto &all = events.*column, &some = half.*column;
    if (all.size() != some.size()) return infinity;
    double largest = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (!std::isnan(all[i])) largest = std::isnan(some[i]) ? infinity : std::max(largest, std::abs(all[i] - some[i]));
    return largest + stated_error;
  };
  const auto time = run.metrics.find("event_time_error");
  const double of_time = time == run.metrics.end() ? 0 : time->second, of_place = 2 * stated(run, "displacement");
  const double of_force = model.slider.stiffness * of_place;
  double least_load = infinity;
  for (const double onset : events.onset) least_load = std::min(least_load, model.drive.normal_load.value(onset));
  events.error = {.onset = error(&SlipEvents::onset, of_time),
                  .duration = error(&SlipEvents::duration, 2 * of_time),
                  .force_drop = error(&SlipEvents::force_drop, of_force),
                  .friction_drop = error(&SlipEvents::friction_drop, of_force / least_load),
                  .slip = error(&SlipEvents::slip, of_place + 2 * std::abs(model.drive.speed.level()) * of_time),
                  .peak_slip_rate = error(&SlipEvents::peak_slip_rate, stated(run, "slip_rate")),
                  .recurrence = error(&SlipEvents::recurrence, 2 * of_time)};
  return events;
}

}  // namespace rosin::analysis::motion
