/// Slide, hold, slide again: friction peaks when sliding resumes, by more the longer the hold (Dieterich 1972).
///
/// Under the ageing law the peak grows by b per e-fold of hold time; without healing at rest only what creeps heals.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/lab/tools.hpp"

namespace rosin::analysis::lab {

namespace {

struct Hold {
  double begin, time, resume, end;  ///< s
};

/// Peak after each hold, above the sliding level before it.
struct Peaks {
  std::vector<double> peak, rise;
};
Peaks read_peaks(const Record& record, const std::vector<Hold>& holds) {
  const auto &t = record.time, &mu = record.column("friction_coefficient");
  Peaks peaks;
  double begin = 0;
  for (const auto& hold : holds) {
    const auto [first, last] = between(t, hold.resume, hold.end);
    peaks.peak.push_back(extreme(t, mu, first, last, true).value);
    peaks.rise.push_back(peaks.peak.back() - level(t, mu, begin, hold.begin));
    begin = hold.resume;
  }
  return peaks;
}

/// Growth per e-fold of hold time, over the longer half of the holds.
Line growth(const std::vector<Hold>& holds, const std::vector<double>& rise, double shortest) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < holds.size(); ++i)
    if (holds[i].time >= shortest) x.push_back(std::log(holds[i].time)), y.push_back(rise[i]);
  return fit_line(x, y);
}

/// A set-valued law at rest bears its static limit, after any hold: decided without integration.
void hold_without_memory(Result& result, const Model& model, const std::vector<double>& times,
                         const std::vector<Hold>& holds, double speed) {
  std::vector<double> rates;
  for (const double t : times) {
    const bool held = std::ranges::any_of(holds, [&](const Hold& h) { return h.begin <= t && t < h.resume; });
    rates.push_back(held ? 0 : speed);
  }
  record_curve(result, model, times, rates);
  const double N = model.drive.normal_load.level();
  const auto limit = static_limit(*model.law, N);
  if (!limit) return;
  auto &force = result.record.columns[3], &mu = result.record.columns[4];
  for (std::size_t i = 0; i < times.size(); ++i)
    for (const auto& hold : holds)
      if (times[i] == hold.resume) mu[i] = *limit, force[i] = N * *limit;
}

Result perform(const Task& task) {
  Result result;
  Model model = task.model;
  const auto& settings = task.settings;
  auto hold_times = settings.list("hold_times");
  std::ranges::sort(hold_times);
  if (std::ranges::adjacent_find(hold_times) != hold_times.end())
    throw InputError("lab.hold_times holds a time twice (s); each is one hold");
  const double speed = settings.number("speed"), N = model.drive.normal_load.level();
  model.drive.force = 0.0;

  double slide = settings.number_or("slide_time", 0);
  if (slide == 0) {
    const double settling = settling_time(model, speed);
    if (!std::isfinite(settling))
      throw InputError(
          fmt::format("steady sliding at lab.speed = {} m/s is unstable on this machine: it would stick "
                      "and slip; stiffen oscillator.stiffness, or give lab.slide_time",
                      speed));
    constexpr double forgotten = 24;
    const double reload = std::isfinite(model.slider.stiffness) ? 2 * N / model.slider.stiffness / speed : 0;
    slide = settling > 0 ? forgotten * settling + reload : 1;
    // Transients of large peaks decay from far above steady sliding first.
    if (settling > 0) slide += settling * std::log1p(hold_times.back() / settling);
  }
  std::vector<double> times = {0};
  std::vector<Hold> holds;
  Signal::Steps drive{{{0, speed}}};
  const int samples = 2 * settings.count("samples");
  append_times(times, 0, slide, samples);
  double t = slide;
  for (const double hold : hold_times) {
    holds.push_back({t, hold, t + hold, t + hold + slide});
    drive.steps.push_back({t, 0});
    drive.steps.push_back({t + hold, speed});
    append_times(times, t, hold, samples);
    times.back() = t + hold;
    append_times(times, t + hold, slide, samples);
    t += hold + slide;
    times.back() = t;
  }
  holds.back().end = times.back() * (1 + 1e-12);
  model.drive.speed = Signal(drive);
  if (memoryless(model) && rigid_machine(model))
    hold_without_memory(result, model, times, holds, speed);
  else
    record_run(result, task, model, Start{}, times);
  result.record.add("load_point", "m", driven_way(result.record.time, model.drive.speed));
  for (const auto& hold : holds) result.record.breaks.insert(result.record.breaks.end(), {hold.begin, hold.resume});
  if (!result.outcome.complete()) return result;

  const double shortest = settings.number_or("fit_from", hold_times[(hold_times.size() - 1) / 2]);
  read_off(result, task.sensor, [&](const Record& seen) -> std::vector<Reading> {
    const auto peaks = read_peaks(seen, holds);
    const auto line = growth(holds, peaks.rise, shortest);
    const auto n = peaks.rise.size();
    const double last = n < 2
                            ? std::nan("")
                            : (peaks.rise[n - 1] - peaks.rise[n - 2]) / std::log(hold_times[n - 1] / hold_times[n - 2]);
    return {{"healing_rate", "1",
             fmt::format("growth of the peak per e-fold of hold time, least squares from {:g} s", shortest), line.slope,
             line.slope_error},
            {"healing_rate_per_decade", "1", "the same per decade", line.slope * std::log(10),
             line.slope_error * std::log(10)},
            {"last_healing_rate", "1", "growth per e-fold between the two longest holds", last},
            {"last_rise", "1", "peak after the longest hold above the sliding level", peaks.rise.back()}};
  });
  const auto peaks = read_peaks(result.record, holds);
  const auto line = growth(holds, peaks.rise, shortest);
  result.tables.push_back(
      {"peaks", {"hold_time", "peak", "rise"}, {"s", "1", "1"}, {hold_times, peaks.peak, peaks.rise}});
  Panel::Curve fit{"least squares", {}, {}};
  for (const double hold : hold_times)
    if (hold >= shortest) fit.x.push_back(hold), fit.y.push_back(line.offset + line.slope * std::log(hold));
  const auto& seen = result.record;
  result.panels = {{.x_label = "load-point displacement",
                    .x_unit = "m",
                    .y_label = "friction coefficient",
                    .y_unit = "1",
                    .curves = {{"", seen.column("load_point"), seen.column("friction_coefficient")}}},
                   {.x_label = "hold time",
                    .x_unit = "s",
                    .y_label = "peak above sliding",
                    .y_unit = "1",
                    .x_decades = true,
                    .curves = {{"peaks", hold_times, peaks.rise, true}}}};
  if (std::isfinite(line.slope)) result.panels[1].curves.push_back(std::move(fit));
  return result;
}

}  // namespace

Experiment slide_hold_slide() {
  return {.name = "slide-hold-slide",
          .title = "Slide, hold, slide",
          .settings = {{.quantity = {"hold_times", "s", {1e-9, 1e12}, "times at rest", Scale::linear, true},
                        .value = std::vector<double>{1, 10, 100, 1e3, 1e4, 1e5}},
                       {.quantity = {"speed", "m/s", {1e-14, 1e3}, "slip rate between holds"}, .value = 1e-5},
                       {.quantity = {"slide_time", "s", {1e-12, 1e12}, "sliding between holds; else until settled"}},
                       {.quantity = {"fit_from",
                                     "s",
                                     {0, 1e12},
                                     "shortest hold that the healing rate is fitted to; else "
                                     "that in the middle"}},
                       {.quantity = {"samples", "1", {8, 1e5}, "pairs of samples of each slide and hold"},
                        .value = 200.0,
                        .whole = true}},
          .slider = {.mass = 0, .stiffness = infinity, .damping = 0},
          .drive = {.speed = 0.0, .normal_load = 1.0, .force = 0.0},
          .extra_columns = {"load_point"},
          .prescribed = {"drive.speed", "drive.force"},
          .protocol = perform};
}

}  // namespace rosin::analysis::lab
