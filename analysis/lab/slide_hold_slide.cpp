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

/// Peak after each hold, above the sliding level before it, and growth per e-fold of hold time since the hold before.
struct Peaks {
  std::vector<double> peak, rise, error, local_rate;  ///< error: of the rise, from a level that is not settled
};
Peaks read_peaks(const Record& record, const std::vector<Hold>& holds, double settling) {
  const auto &t = record.time, &mu = record.column("friction_coefficient");
  Peaks peaks;
  double begin = 0;
  for (const auto& hold : holds) {
    peaks.peak.push_back(extreme(record, mu, {hold.resume, hold.end, true}).value);
    peaks.rise.push_back(peaks.peak.back() - level(t, mu, begin, hold.begin));
    peaks.error.push_back(unsettled(t, mu, begin, hold.begin, settling));
    begin = hold.resume;
  }
  peaks.local_rate.push_back(std::nan(""));
  for (std::size_t i = 1; i < holds.size(); ++i)
    peaks.local_rate.push_back((peaks.rise[i] - peaks.rise[i - 1]) / std::log(holds[i].time / holds[i - 1].time));
  return peaks;
}

/// Holds [first, last) that a straight line in the logarithm of hold time is fitted to.
struct Stretch {
  std::size_t first, last;
};

/// The holds about the fastest growth, as far as the local rate stays within 2 % of it.
Stretch straight_part(const std::vector<double>& local_rate) {
  if (local_rate.size() < 2) return {0, local_rate.size()};
  const auto rate = [&](std::size_t i) { return std::abs(local_rate[i]); };
  std::size_t fastest = 1;
  for (std::size_t i = 1; i < local_rate.size(); ++i)
    if (rate(i) >= rate(fastest)) fastest = i;
  Stretch part{fastest - 1, fastest + 1};
  while (part.first > 0 && rate(part.first) >= 0.98 * rate(fastest)) --part.first;
  while (part.last < local_rate.size() && rate(part.last) >= 0.98 * rate(fastest)) ++part.last;
  return part;
}

/// Growth per e-fold of hold time. Error: the largest departure of a local rate, of the neighbours too where the
/// stretch has one rate only, and what the errors of rises make of it.
Line growth(const std::vector<Hold>& holds, const Peaks& peaks, Stretch part) {
  std::vector<double> x, y;
  double mean = 0, error = 0, apart = 0, square = 0;
  for (std::size_t i = part.first; i < part.last; ++i) x.push_back(std::log(holds[i].time)), y.push_back(peaks.rise[i]);
  auto line = fit_line(x, y);
  if (x.size() < 2) return line;
  const std::size_t beside = x.size() == 2 ? 1 : 0;
  for (auto i = std::max<std::size_t>(part.first + 1 - beside, 1); i < std::min(part.last + beside, holds.size()); ++i)
    apart = std::max(apart, std::abs(peaks.local_rate[i] - line.slope));
  for (const double at : x) mean += at / double(x.size());
  for (const double at : x) square += (at - mean) * (at - mean);
  for (std::size_t i = 0; i < x.size(); ++i) error += std::abs(x[i] - mean) / square * peaks.error[part.first + i];
  line.slope_error = apart + error;
  return line;
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

Result perform_slide_hold_slide(const Task& task) {
  Result result;
  Task pulled = task;
  pulled.model.drive.force = 0.0;
  const auto machine = machine_of(pulled);
  const auto& settings = task.settings;
  auto hold_times = settings.list("hold_times");
  std::ranges::sort(hold_times);
  if (std::ranges::adjacent_find(hold_times) != hold_times.end())
    throw InputError("lab.hold_times holds a time twice (s); each is one hold");
  const double speed = settings.number("speed"), N = machine->normal_load(), k = machine->stiffness();

  double slide = settings.number_or("slide_time", 0);
  const double settling = machine->settling_time(speed);
  if (slide == 0) {
    if (!std::isfinite(settling))
      throw InputError(
          fmt::format("steady sliding at lab.speed = {} m/s is unstable on this machine: it would stick "
                      "and slip; stiffen oscillator.stiffness, or give lab.slide_time",
                      speed));
    constexpr double forgotten = 24;
    const double reload = std::isfinite(k) ? 2 * N / k / speed : 0;
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
  const Signal load_point(drive);
  std::vector<Sought> extremes;
  for (const auto& hold : holds) extremes.push_back({hold.resume, hold.end, true});
  if (const auto* model = machine->curve())
    hold_without_memory(result, *model, times, holds, speed);
  else
    record_run(result, task, motion_of(*machine, load_point), motion::Start{}, times, extremes);
  result.record.add("load_point", "m", driven_way(result.record.time, load_point));
  for (const auto& hold : holds) result.record.breaks.insert(result.record.breaks.end(), {hold.begin, hold.resume});
  if (!result.outcome.complete()) return result;

  // Which holds lie on a straight line is seen on the true record: noise would pick the steepest by chance.
  std::ranges::sort(result.record.breaks);
  Stretch part = straight_part(read_peaks(result.record, holds, settling).local_rate);
  if (settings.given("fit_from")) {
    const double shortest = settings.number("fit_from");
    part = {std::size_t(std::ranges::lower_bound(hold_times, shortest) - hold_times.begin()), hold_times.size()};
  }
  const auto stretch = part.first < part.last
                           ? fmt::format("from {:g} to {:g} s", hold_times[part.first], hold_times[part.last - 1])
                           : std::string("of no hold");
  read_off(result, task.sensor, [&](const Record& seen) -> std::vector<Reading> {
    const auto peaks = read_peaks(seen, holds, settling);
    const auto line = growth(holds, peaks, part);
    const auto n = peaks.rise.size();
    const double last_error =
        n < 2 ? 0 : (peaks.error[n - 1] + peaks.error[n - 2]) / std::log(hold_times[n - 1] / hold_times[n - 2]);
    return {{"healing_rate", "1", fmt::format("growth of the peak per e-fold of hold time, least squares {}", stretch),
             line.slope, line.slope_error},
            {"healing_rate_per_decade", "1", "the same per decade", line.slope * std::log(10),
             line.slope_error * std::log(10)},
            {"last_healing_rate", "1", "growth per e-fold between the two longest holds", peaks.local_rate.back(),
             last_error},
            {"last_rise", "1", "peak after the longest hold above the sliding level", peaks.rise.back(),
             peaks.error.back()}};
  });
  const auto peaks = read_peaks(result.record, holds, settling);
  const auto line = growth(holds, peaks, part);
  result.tables.push_back({"peaks",
                           {"hold_time", "peak", "rise", "local_rate"},
                           {"s", "1", "1", "1"},
                           {hold_times, peaks.peak, peaks.rise, peaks.local_rate}});
  Panel::Curve fit{"line fitted, slope β", {}, {}};
  for (std::size_t i = part.first; i < part.last; ++i)
    fit.x.push_back(hold_times[i]), fit.y.push_back(line.offset + line.slope * std::log(hold_times[i]));
  const auto& seen = result.record;
  result.panels = {{.x_label = "load-point displacement",
                    .x_unit = "m",
                    .y_label = "friction coefficient μ",
                    .y_unit = "1",
                    .curves = {{"", seen.column("load_point"), seen.column("friction_coefficient")}}},
                   {.x_label = "hold time",
                    .x_unit = "s",
                    .y_label = "peak above sliding Δμ",
                    .y_unit = "1",
                    .x_decades = true,
                    .curves = {{"peaks", hold_times, peaks.rise, true}},
                    .y_error = result.reading("last_rise").error}};
  const bool heals =
      std::ranges::any_of(peaks.rise, [&](double rise) { return std::abs(rise) > result.panels[1].y_error; });
  if (!heals)
    result.warnings.push_back(fmt::format(
        "no healing: no peak stands above sliding by more than its error, {:.0e}{}", result.panels[1].y_error,
        machine->rigid()
            ? fmt::format("; on a rigid machine the law '{}' does not strengthen at rest: give [oscillator] mass = 0 "
                          "and the machine's stiffness",
                          task.model.law->card().name)
            : ""));
  if (heals && std::isfinite(line.slope)) result.panels[1].curves.push_back(std::move(fit));
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
                                     "shortest hold that the healing rate is fitted to; else where growth is fastest"}},
                       {.quantity = {"samples", "1", {8, 1e5}, "pairs of samples of each slide and hold"},
                        .value = 200.0,
                        .whole = true}},
          .slider = {.mass = 0, .stiffness = infinity, .damping = 0},
          .drive = {.speed = 0.0, .normal_load = 1.0, .force = 0.0},
          .extra_columns = {"load_point"},
          .prescribed = {"drive.speed", "drive.force"},
          .protocol = perform_slide_hold_slide};
}

}  // namespace rosin::analysis::lab
