/// Velocity stepping: the slip rate jumps, and friction jumps with it and relaxes over a memory length.
///
/// Direct effect a = Δμ/ln(V₂/V₁), final change (a − b) ln(V₂/V₁) and decay over L: Dieterich (1979), Ruina (1983).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/lab/tools.hpp"

namespace rosin::analysis::lab {

namespace {

/// What one step shows.
struct Step {
  double from, to, before, jump, peak, change, decay_length;
  double before_error, after_error;  ///< what transients leave of the levels
  double peak_slip;                  ///< m, where the extreme is
};

/// When a step happens, and the time constants at the slip rates before and after it.
struct Moment {
  double begin, at, end, settling_before, settling_after;
};

/// The level before, the extreme in the direction of the step, the level after, and the slip in which the difference
/// between the last two falls to 1/e.
Step read_step(const Record& record, double from, double to, const Moment& moment) {
  const auto [begin, at, end, settling_before, settling_after] = moment;
  const auto &t = record.time, &mu = record.column("friction_coefficient"), &slip = record.column("slip");
  Step step{from, to, level(t, mu, begin, at), 0, 0, 0, std::nan(""), 0, 0, 0};
  step.before_error = unsettled(t, mu, begin, at, settling_before);
  step.after_error = unsettled(t, mu, at, end, settling_after);
  const auto [first, last] = between(t, at, end);
  const auto peak = extreme(record, mu, {at, end, to > from});
  const double after = level(t, mu, at, end), height = peak.value - after;
  step.peak = peak.value;
  step.peak_slip = at_time(t, slip, peak.time);
  step.jump = peak.value - step.before;
  step.change = after - step.before;
  if (std::abs(height) <= 1e-6 * std::abs(after)) return step;  // no transient
  for (auto i = std::max(first + 1, between(t, peak.time, end).first); i < last; ++i) {
    const double now = (mu[i] - after) / height, was = std::min(1.0, (mu[i - 1] - after) / height);
    if (now > std::exp(-1)) continue;
    const double part = now > 0 ? (std::log(was) + 1) / (std::log(was) - std::log(now)) : 1;
    step.decay_length = std::lerp(slip[i - 1], slip[i], part) - step.peak_slip;
    break;
  }
  return step;
}

/// The first step at close range: from some decay lengths before it until the transient is gone.
Panel close_up(const Record& record, const Step& step, const Moment& moment) {
  const auto &slip = record.column("slip"), &mu = record.column("friction_coefficient");
  const double at = at_time(record.time, slip, moment.at), begin = at_time(record.time, slip, moment.begin),
               end = at_time(record.time, slip, moment.end), length = step.decay_length;
  const bool decays = std::isfinite(length);
  const double before = decays ? std::max(begin - at, -3 * length) : 0.2 * (begin - at),
               after = decays ? std::min(end - at, step.peak_slip - at + 9 * length) : 0.6 * (end - at);
  Panel panel{.x_label = "slip since the step",
              .x_unit = "m",
              .y_label = "friction coefficient μ",
              .y_unit = "1",
              .curves = {{"", {}, {}}, {"level before", {before, after}, {step.before, step.before}}}};
  for (std::size_t i = 0; i < slip.size(); ++i)
    if (slip[i] >= at + before && slip[i] <= at + after)
      panel.curves[0].x.push_back(slip[i] - at), panel.curves[0].y.push_back(mu[i]);
  return panel;
}

Result perform_velocity_step(const Task& task) {
  Result result;
  Task pulled = task;
  pulled.model.drive.force = 0.0;
  const auto machine = machine_of(pulled);
  const auto& speeds = task.settings.list("speeds");
  if (speeds.size() < 2) throw InputError("lab.speeds needs two or more slip rates (m/s), one step between each two");

  // Each speed is held until the step before it has been forgotten.
  const double N = machine->normal_load(), k = machine->stiffness();
  Signal::Steps drive;
  std::vector<double> times = {0}, breaks, settling;
  double t = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    drive.steps.push_back({t, speeds[i]});
    double dwell = task.settings.number_or("dwell", 0);
    settling.push_back(machine->settling_time(speeds[i]));
    if (dwell == 0) {
      if (!std::isfinite(settling.back()))
        throw InputError(
            fmt::format("steady sliding at lab.speeds = {} m/s is unstable on this machine: it would stick "
                        "and slip; stiffen oscillator.stiffness, or give lab.dwell to see it",
                        speeds[i]));
      constexpr double forgotten = 24;  // time constants: e^−24 is left
      const double reload = std::isfinite(k) ? 0.1 * N / k / speeds[i] : 0;
      dwell = settling.back() > 0 ? forgotten * settling.back() + reload : 1;
    }
    append_times(times, t, dwell, 2 * task.settings.count("samples"));
    t += dwell;
    if (i + 1 < speeds.size()) breaks.push_back(t);
  }
  const Signal speed(drive);
  std::vector<Moment> moments;
  std::vector<Sought> extremes;
  for (std::size_t i = 0; i < breaks.size(); ++i) {
    const double end = i + 1 < breaks.size() ? breaks[i + 1] : times.back() * (1 + 1e-12);
    moments.push_back({i > 0 ? breaks[i - 1] : 0, breaks[i], end, settling[i], settling[i + 1]});
    extremes.push_back({breaks[i], end, speeds[i + 1] > speeds[i]});
  }

  if (const auto* model = machine->curve()) {
    std::vector<double> rates;
    for (const double time : times) rates.push_back(speed.value(time));
    record_curve(result, *model, times, rates);
  } else {
    motion::Start steady;
    record_run(result, task, motion_of(*machine, speed), steady, times, extremes);
  }
  auto& record = result.record;
  record.breaks.insert(record.breaks.end(), breaks.begin(), breaks.end());
  // Slip: what the drive has moved less what the machine has yielded.
  auto slip = driven_way(record.time, speed);
  const auto yielded = machine->displacement().over(record.columns);
  for (std::size_t i = 0; i < slip.size(); ++i) slip[i] -= yielded[i] - yielded[0];
  record.add("slip", "m", std::move(slip), machine->displacement().error(record.errors));

  const auto steps_of = [&](const Record& seen) {
    std::vector<Step> steps;
    for (std::size_t i = 0; i < moments.size(); ++i)
      steps.push_back(read_step(seen, speeds[i], speeds[i + 1], moments[i]));
    return steps;
  };
  read_off(result, task.sensor, [&](const Record& seen) -> std::vector<Reading> {
    const auto step = steps_of(seen).front();
    const double folds = std::log(step.to / step.from);
    const double change_error = step.before_error + step.after_error;
    // The transient, e^(-x/L) of its height, crosses 1/e later by (e - 1) L of what the level after is off by.
    const double height = std::abs(step.jump - step.change);
    const double length_error = (std::exp(1) - 1) * step.decay_length * step.after_error / height;
    return {
        {"friction_before", "1", "steady coefficient before the first step", step.before, step.before_error},
        {"direct_jump", "1", "peak less the level before", step.jump, step.before_error},
        {"direct_effect", "1", "direct jump per e-fold of slip rate, a", step.jump / folds,
         step.before_error / std::abs(folds)},
        {"peak", "1", "extreme coefficient after the step", step.peak},
        {"final_change", "1", "level after less the level before", step.change, change_error},
        {"rate_dependence", "1", "final change per e-fold of slip rate, a - b", step.change / folds,
         change_error / std::abs(folds)},
        {"decay_length", "m", "slip from the peak in which the transient falls to 1/e", step.decay_length,
         std::isfinite(step.decay_length) ? length_error : 0},
    };
  });
  Table table{
      "steps", {"from", "to", "direct_jump", "final_change", "decay_length"}, {"m/s", "m/s", "1", "1", "m"}, {}};
  table.values.resize(5);
  for (const auto& step : steps_of(result.record)) {
    const double row[] = {step.from, step.to, step.jump, step.change, step.decay_length};
    for (int c = 0; c < 5; ++c) table.values[c].push_back(row[c]);
  }
  result.tables.push_back(std::move(table));
  const auto& seen = result.record;
  result.panels = {{.x_label = "slip",
                    .x_unit = "m",
                    .y_label = "friction coefficient μ",
                    .y_unit = "1",
                    .curves = {{"", seen.column("slip"), seen.column("friction_coefficient")}}},
                   close_up(seen, steps_of(seen).front(), moments.front())};
  if (!machine->rigid())  // the slip rate is not what the protocol says
    result.panels.push_back({.x_label = "slip",
                             .x_unit = "m",
                             .y_label = "slip rate v",
                             .y_unit = "m/s",
                             .y_decades = true,
                             .curves = {{"", seen.column("slip"), seen.column("slip_rate")}}});
  return result;
}

}  // namespace

Experiment velocity_step() {
  return {
      .name = "velocity-step",
      .title = "Velocity steps",
      .settings = {{.quantity = {"speeds", "m/s", {1e-14, 1e3}, "slip rates, one after the other", Scale::linear, true},
                    .value = std::vector<double>{1e-6, 1e-5}},
                   {.quantity = {"dwell", "s", {1e-12, 1e12}, "time at each speed; else until settled"}},
                   {.quantity = {"samples", "1", {8, 1e6}, "pairs of samples at each speed"},
                    .value = 500.0,
                    .whole = true}},
      .slider = {.mass = 0, .stiffness = infinity, .damping = 0},
      .drive = {.speed = 0.0, .normal_load = 1.0, .force = 0.0},
      .extra_columns = {"slip"},
      .prescribed = {"drive.speed", "drive.force"},
      .protocol = perform_velocity_step};
}

}  // namespace rosin::analysis::lab
