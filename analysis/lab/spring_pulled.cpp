/// A machine pulled through its springs: it slides steadily, or sticks and slips with a period and a drop of force.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/lab/tools.hpp"

namespace rosin::analysis::lab {

namespace {

/// Times at which x, after it has been above its upper quarter, falls through the middle of its range.
std::vector<double> falls(const std::vector<double>& t, const std::vector<double>& x, std::size_t first) {
  const auto [low, high] = std::minmax_element(x.begin() + static_cast<std::ptrdiff_t>(first), x.end());
  const double middle = 0.5 * (*low + *high), upper = 0.25 * *low + 0.75 * *high;
  std::vector<double> found;
  bool armed = false;
  for (std::size_t i = std::max<std::size_t>(first, 1); i < x.size(); ++i) {
    if (x[i] > upper) armed = true;
    if (!armed || x[i] > middle) continue;
    armed = false;
    found.push_back(std::lerp(t[i - 1], t[i], (x[i - 1] - middle) / (x[i - 1] - x[i])));
  }
  return found;
}

/// Period and drop of the spring's force in the last half of a record.
std::vector<Reading> read_record(const Record& seen, const CoordinateSum& spring, bool oscillates) {
  const auto &t = seen.time, &mu = seen.column("friction_coefficient");
  const auto x = spring.over(seen.columns);
  const double none = std::nan("");
  const std::size_t half = between(t, 0.5 * (t.front() + t.back()), t.back()).first;
  const auto [low, high] = std::minmax_element(x.begin() + static_cast<std::ptrdiff_t>(half), x.end());
  const auto drops = falls(t, x, half);
  const bool two = oscillates && drops.size() > 1;
  return {{"period", "s", "mean time between drops of the spring's force",
           two ? (drops.back() - drops.front()) / double(drops.size() - 1) : none},
          {"force_drop", "N", "highest less lowest force of the spring",
           oscillates ? spring.factor * (*high - *low) : none},
          {"friction_at_end", "1", "coefficient over the last tenth of the record",
           level(t, mu, t.front(), t.back() * (1 + 1e-12))}};
}

Result perform_spring_pulled(const Task& task) {
  Result result;
  const auto& settings = task.settings;
  const auto machine = machine_of(task);
  const double V = task.model.drive.speed.level();
  if (!(V > 0)) throw InputError(fmt::format("drive.speed = {} must be above 0 (m/s)", V));

  // Regime and thresholds need no record: linear stability, and the cycle reached from stick.
  const auto regime = machine->regime(task.tolerance);
  result.plan.push_back("stability of steady sliding and its thresholds: eigenvalues, no integration");
  if (!regime.oscillates) result.plan.push_back("no cycle is reached from stick: " + regime.why_not);

  const double load_up = machine->normal_load() * regime.friction_coefficient / machine->stiffness() / V;
  const double duration =
      settings.number_or("duration", regime.oscillates ? 2 * load_up + settings.number("periods") * regime.period.value
                                                       : 2 * load_up + 20 * regime.settling_time);
  std::vector<double> times;
  const int samples = settings.count("samples");
  for (int i = 0; i <= samples; ++i) times.push_back(duration * i / samples);
  motion::Start rest;
  rest.kind = motion::Start::Kind::rest;
  Task picture{task};
  picture.tolerance = std::max(task.tolerance, 1e-6);  // of many periods, whose phase gathers errors
  record_run(result, picture, motion_of(*machine, V), rest, times);
  if (result.outcome.ending == Ending::tolerance_not_met && result.record.time.size() == times.size()) {
    // Period and drop are the cycle's.
    result.warnings.push_back("the record itself is less accurate than its readings: " + result.outcome.detail);
    result.outcome = {};
  }
  if (result.record.time.size() < 16) return result;
  const auto spring = machine->spring_force();
  read_off(result, task.sensor, [&](const Record& seen) { return read_record(seen, spring, regime.oscillates); });

  const auto state = [](Reading& reading, const Regime::Number& number) {
    reading.value = number.value, reading.error = number.error;
  };
  if (regime.oscillates && task.sensor.ideal())  // the cycle itself is known better than a record of it
    state(result.readings[0], regime.period), state(result.readings[1], regime.force_drop);
  const auto add = [&](const char* name, const char* unit, const char* meaning, const Regime::Number& number) {
    result.readings.push_back({name, unit, meaning, number.value, number.error});
  };
  add("oscillates", "1", "1 if stick-slip is reached from rest, 0 if steady sliding", {regime.oscillates ? 1.0 : 0.0});
  add("stable", "1", "1 if steady sliding is stable", {regime.stable ? 1.0 : 0.0});
  add("slip_rate_max", "m/s", "fastest slip", regime.slip_rate_max);
  add("stick_fraction", "1", "part of the period in stick", regime.stick_fraction);
  add("critical_stiffness", "N/m", "nearest threshold of steady sliding in the stiffness at the contact",
      regime.critical_stiffness);
  add("critical_load", "N", "nearest threshold of steady sliding in the normal load", regime.critical_load);

  const auto& seen = result.record;
  auto force = spring.over(seen.columns);
  for (double& f : force) f *= spring.factor;
  std::vector<double> way;
  for (const double t : seen.time) way.push_back(V * t);
  result.panels = {{.x_label = "load-point displacement",
                    .x_unit = "m",
                    .y_label = "spring force",
                    .y_unit = "N",
                    .curves = {{"", std::move(way), std::move(force)}}}};
  if (regime.oscillates)
    result.panels.push_back({.x_label = "slip rate v",
                             .x_unit = "m/s",
                             .y_label = "friction coefficient μ",
                             .y_unit = "1",
                             .curves = {{"cycle", regime.slip_rate, regime.friction_coefficient_over}}});
  return result;
}

}  // namespace

Experiment spring_pulled() {
  return {.name = "spring-pulled",
          .title = "Slider pulled through a spring",
          .settings = {{.quantity = {"duration", "s", {1e-12, 1e12}, "length of the record; else load-up and periods"}},
                       {.quantity = {"periods", "1", {2, 1e4}, "periods of stick-slip that the record holds"},
                        .value = 8.0},
                       {.quantity = {"samples", "1", {32, 1e7}, "samples of the record, even in time"},
                        .value = 4000.0,
                        .whole = true}},
          .slider = {.mass = 1, .stiffness = 100, .damping = 0},
          .drive = {.speed = 1e-5, .normal_load = 1.0, .force = 0.0},
          .extra_columns = {},
          .prescribed = {},
          .protocol = perform_spring_pulled};
}

}  // namespace rosin::analysis::lab
