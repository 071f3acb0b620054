/// A slider pulled through a spring: it slides steadily, or sticks and slips with a period and a drop of force.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lab/tools.hpp"
#include "analysis/steady/stability.hpp"

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
std::vector<Reading> read_record(const Record& seen, double stiffness, bool oscillates) {
  const auto &t = seen.time, &x = seen.column("displacement"), &mu = seen.column("friction_coefficient");
  const double none = std::nan("");
  const std::size_t half = between(t, 0.5 * (t.front() + t.back()), t.back()).first;
  const auto [low, high] = std::minmax_element(x.begin() + static_cast<std::ptrdiff_t>(half), x.end());
  const auto drops = falls(t, x, half);
  const bool two = oscillates && drops.size() > 1;
  return {
      {"period", "s", "mean time between drops of the spring's force",
       two ? (drops.back() - drops.front()) / double(drops.size() - 1) : none},
      {"force_drop", "N", "highest less lowest force of the spring", oscillates ? stiffness * (*high - *low) : none},
      {"friction_at_end", "1", "coefficient over the last tenth of the record",
       level(t, mu, t.front(), t.back() * (1 + 1e-12))}};
}

Result perform(const Task& task) {
  Result result;
  const auto& settings = task.settings;
  const Model& model = task.model;
  if (!model.drive.constant())
    throw InputError("spring-pulled takes a constant drive.speed, normal_load and force; 'rosin run' follows others");
  const double V = model.drive.speed.level(), k = model.slider.stiffness;
  if (!(V > 0)) throw InputError(fmt::format("drive.speed = {} must be above 0 (m/s)", V));
  if (!(k > 0) || std::isinf(k))
    throw InputError(fmt::format("oscillator.stiffness = {} must be a spring's (above 0, finite, N/m)", k));

  // Regime and thresholds need no record: linear stability, and the cycle reached from stick.
  const auto steady = steady::stability(model);
  result.plan.push_back("stability of steady sliding and its thresholds: eigenvalues, no integration");
  const auto cycle = cycles::find_cycle(model, {.tolerance = task.tolerance});
  const bool oscillates = cycle.metrics.period > 0;
  if (!oscillates)
    result.plan.push_back("no cycle is reached from stick: " +
                          (cycle.outcome.detail.empty() ? name(cycle.outcome.ending) : cycle.outcome.detail));

  const double load_up = model.drive.normal_load.level() * steady.steady.friction_coefficient / k / V;
  const double slowest = steady.stable ? -1 / steady.eigenvalues.front().real() : 0;
  const double duration =
      settings.number_or("duration", oscillates ? 2 * load_up + settings.number("periods") * cycle.metrics.period
                                                : 2 * load_up + 20 * slowest);
  std::vector<double> times;
  const int samples = settings.count("samples");
  for (int i = 0; i <= samples; ++i) times.push_back(duration * i / samples);
  motion::Start rest;
  rest.kind = motion::Start::Kind::rest;
  Task picture{task};
  picture.tolerance = std::max(task.tolerance, 1e-6);  // of many periods, whose phase gathers errors
  record_run(result, picture, model, rest, times);
  if (result.outcome.ending == Ending::tolerance_not_met && result.record.time.size() == times.size()) {
    // Period and drop are the cycle's.
    result.warnings.push_back("the record itself is less accurate than its readings: " + result.outcome.detail);
    result.outcome = {};
  }
  if (result.record.time.size() < 16) return result;
  read_off(result, task.sensor, [&](const Record& seen) { return read_record(seen, k, oscillates); });

  if (oscillates && task.sensor.ideal()) {  // the cycle itself is known better than a record of it
    result.readings[0].value = cycle.metrics.period;
    result.readings[0].error = cycle.error.period;
    double low = infinity, high = -infinity, most = 0;
    for (const auto& point : cycle.orbit)
      low = std::min(low, point.displacement), high = std::max(high, point.displacement);
    for (std::size_t i = 1; i + 1 < cycle.orbit.size(); ++i) {  // what lies between two points of the orbit, at most
      const double gap = cycle.orbit[i].displacement;
      if (gap == low || gap == high)
        most = std::max(
            {most, std::abs(gap - cycle.orbit[i - 1].displacement), std::abs(gap - cycle.orbit[i + 1].displacement)});
    }
    result.readings[1].value = k * (high - low);
    result.readings[1].error = 2 * k * most;
  }
  const double none = std::nan("");
  result.readings.push_back(
      {"oscillates", "1", "1 if stick-slip is reached from rest, 0 if steady sliding", oscillates ? 1.0 : 0.0});
  result.readings.push_back({"stable", "1", "1 if steady sliding is stable", steady.stable ? 1.0 : 0.0});
  result.readings.push_back({"slip_rate_max", "m/s", "fastest slip", oscillates ? cycle.metrics.slip_rate_max : none,
                             cycle.error.slip_rate_max});
  result.readings.push_back({"stick_fraction", "1", "part of the period in stick",
                             oscillates ? cycle.metrics.stick_fraction : none, cycle.error.stick_fraction});
  for (const auto& [path, reading, unit] : {std::tuple{"oscillator.stiffness", "critical_stiffness", "N/m"},
                                            std::tuple{"drive.normal_load", "critical_load", "N"}}) {
    const auto points = steady::hopf_points(model, path);
    result.readings.push_back({reading, unit, fmt::format("nearest threshold of steady sliding in {}", path),
                               points.empty() ? none : points.front().value,
                               points.empty() ? 0 : points.front().value_error});
  }

  const auto& seen = result.record;
  std::vector<double> force, way;
  for (std::size_t i = 0; i < seen.time.size(); ++i)
    force.push_back(k * seen.column("displacement")[i]), way.push_back(V * seen.time[i]);
  result.panels = {{.x_label = "load-point displacement",
                    .x_unit = "m",
                    .y_label = "spring force",
                    .y_unit = "N",
                    .curves = {{"", way, force}}}};
  if (oscillates) {
    Panel loop{.x_label = "slip rate v",
               .x_unit = "m/s",
               .y_label = "friction coefficient μ",
               .y_unit = "1",
               .curves = {{"cycle", {}, {}}}};
    for (const auto& point : cycle.orbit)
      loop.curves[0].x.push_back(point.slip_rate), loop.curves[0].y.push_back(point.friction_coefficient);
    result.panels.push_back(std::move(loop));
  }
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
          .protocol = perform};
}

}  // namespace rosin::analysis::lab
