/// Rabinowicz's impulse: a block rests on a slope on which it would keep sliding, and is pushed. Below a critical speed
/// it stops again, because static friction fades only over a distance of slip (Rabinowicz 1951).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/lab/block.hpp"

namespace rosin::analysis::lab {

namespace {

constexpr double slowest = 1e-12, fastest = 1e3;  ///< m/s: pushes that are considered

/// The slip rate at which the steady curve first falls through tan α, from which on the block speeds up.
std::optional<double> falls_through(const FrictionLaw& law, double N, double tangent) {
  const auto above = [&](double w) { return law.steady_friction({std::exp(w), N}).friction > tangent; };
  const double low = std::log(slowest), high = std::log(fastest);
  constexpr int cells = 2048;
  for (int i = 0; i < cells; ++i) {
    double a = std::lerp(low, high, double(i) / cells), b = std::lerp(low, high, double(i + 1) / cells);
    if (!above(a) || above(b)) continue;
    for (double middle = 0.5 * (a + b); middle > a && middle < b; middle = 0.5 * (a + b))
      (above(middle) ? a : b) = middle;
    return std::exp(b);
  }
  return std::nullopt;
}

enum class Fate { stops, runs, unknown };

/// A block on its slope, to be pushed again and again.
class Slope {
 public:
  Slope(const Task& task, double slope)
      : task_(task), model_(block(task, slope)), start_(rested(task)), tangent_(std::tan(slope)) {
    turning_ = falls_through(*model_.law, model_.drive.normal_load.level(), tangent_);
  }

  const Model& model() const { return model_; }
  double tangent() const { return tangent_; }
  std::optional<double> turning_speed() const { return turning_; }
  motion::Start pushed(double v0) const {
    motion::Start start = start_;
    start.slip_rate = v0;
    start.displacement = 0;
    return start;
  }

  /// Followed until it can only speed up (faster than the unstable steady slip, and gaining) or only stop (slower, and
  /// losing, or at rest): for one state that weakens steady friction, neither can turn back.
  Fate fate(double v0) const {
    const double turning = turning_.value_or(model_.law->set_valued() ? 0 : 1e-3 * v0);
    for (double duration = 1; duration < 1e7; duration *= 10) {
      Result trial;
      std::vector<double> times = {0};
      append_times(times, 0, duration, 300);
      record_run(trial, task_, motion_of(model_), pushed(v0), times);
      const auto &u = trial.record.columns[2], &mu = trial.record.columns[4];
      for (std::size_t i = 1; i < u.size(); ++i) {
        if (model_.law->set_valued() && u[i] <= 0) return Fate::stops;
        if (u[i] > turning && mu[i] < tangent_) return Fate::runs;
        if (u[i] < turning && mu[i] > tangent_) return Fate::stops;
      }
      if (!trial.outcome.complete()) return Fate::unknown;
    }
    return Fate::unknown;
  }

 private:
  const Task& task_;
  Model model_;
  motion::Start start_;
  double tangent_;
  std::optional<double> turning_;
};

/// The least push after which the block runs away: 0 if any does, infinite if none, NaN if it cannot be told.
Reading critical_speed(const Slope& slope, const Task& task, std::vector<std::string>& plan) {
  Reading reading{"critical_speed", "m/s", "least speed of a push after which the block runs away", 0};
  const auto& model = slope.model();
  if (memoryless(model)) {
    plan.push_back("critical speed: where the friction curve falls through tan of the slope, without integration");
    const double N = model.drive.normal_load.level();
    if (model.law->steady_friction({slowest, N}).friction > slope.tangent())
      reading.value = slope.turning_speed().value_or(infinity), reading.error = 1e-14 * reading.value;
    return reading;
  }
  if (model.law->deflects()) {
    reading.value = std::nan("");
    plan.push_back("critical speed: not looked for, because contacts that bend may oscillate before they run");
    return reading;
  }
  plan.push_back("critical speed: bisection between pushes after which the block stops and runs away");
  double low = slowest, high = slope.turning_speed().value_or(1e-3);
  while (high < fastest && slope.fate(high) == Fate::stops) low = high, high *= 4;
  if (high >= fastest) reading.value = infinity;
  if (low == slowest)
    for (double probe = high / 16;; probe /= 16) {
      if (probe < slowest) return reading;  // any push
      if (slope.fate(probe) == Fate::stops) {
        low = probe;
        break;
      }
      high = probe;
    }
  if (reading.value > 0) return reading;
  while (high / low - 1 > 0.1 * task.tolerance) {
    const double middle = std::sqrt(low * high);
    const Fate fate = slope.fate(middle);
    if (fate == Fate::unknown) break;
    (fate == Fate::stops ? low : high) = middle;
  }
  reading.value = std::sqrt(low * high);
  reading.error = high - low + 3 * task.tolerance * reading.value;
  return reading;
}

double default_slope(const Task& task) {
  const auto& law = *task.model.law;
  const auto states = states_of(law, rested(task));
  return balance_slope(task, [&](double N) {
    const auto range = steady_range(law, N, 1e-9, 0.1);
    const double most = static_limit(law, N, states).value_or(range.most);
    return most > range.least ? 0.5 * (range.least + most) : 0.9 * range.least;  // else: on which everything stops
  });
}

Result perform_impulse(const Task& task) {
  Result result;
  const auto& settings = task.settings;
  const double alpha = settings.number_or("slope", 0) > 0 ? settings.number("slope") : default_slope(task);
  const Slope slope(task, alpha);
  const auto& model = slope.model();
  const double N = model.drive.normal_load.level(), gravity = settings.number("gravity");
  if (const auto limit = static_limit(*model.law, N, states_of(*model.law, slope.pushed(0)));
      limit && *limit < slope.tangent())
    throw InputError(
        fmt::format("lab.slope = {} rad is steeper than rest can bear: its tangent {} is above the static "
                    "coefficient {}; take less than {} rad",
                    alpha, slope.tangent(), *limit, std::atan(*limit)));
  const auto critical = critical_speed(slope, task, result.plan);
  const bool finite = std::isfinite(critical.value) && critical.value > 0;
  const double push = settings.number_or("push", finite ? 0.9 * critical.value : 0.1);

  const auto times_after = [&](double v0, double stretch) {
    const double pull = std::max(std::abs(slope.tangent() - model.law->steady_friction({v0, N}).friction), 1e-3);
    const double duration = settings.number_or("duration", 10 * v0 / (gravity * std::cos(alpha) * pull)) * stretch;
    std::vector<double> times;
    const int count = 2 * settings.count("samples");
    for (int i = 0; i <= count; ++i) times.push_back(duration * std::pow(double(i) / count, 3));
    return times;
  };
  const auto slid_in = [](const Record& record) {
    std::vector<double> slid;
    for (const double x : record.columns[0]) slid.push_back(-x);
    return slid;
  };
  record_run(result, task, motion_of(model), slope.pushed(push), times_after(push, 1));
  result.record.add("slid", "m", slid_in(result.record), result.record.errors[0]);
  const double at_rest = settings.number_or("rest_speed", 1e-3 * push);
  const bool set_valued = model.law->set_valued();
  read_off(result, task.sensor, [&](const Record& seen) -> std::vector<Reading> {
    const auto &u = seen.column("slip_rate"), &slid = seen.column("slid");
    Reading stop{
        "stop_distance", "m",
        set_valued ? "way of the block until it rests" : "way of the block until its slip rate falls below rest_speed",
        std::nan("")};
    for (std::size_t i = 1; i < u.size() && !std::isfinite(stop.value); ++i)
      if (u[i] <= at_rest) {
        const double part = (std::log(u[i - 1]) - std::log(at_rest)) / (std::log(u[i - 1]) - std::log(u[i]));
        stop.value = set_valued ? slid.back() : std::lerp(slid[i - 1], slid[i], std::clamp(part, 0.0, 1.0));
      }
    return {std::move(stop), {"final_speed", "m/s", "slip rate at the end of the record", u.back()}};
  });
  result.readings.push_back({"slope", "rad", "slope of the table", alpha});
  result.readings.push_back({"push", "m/s", "speed that the push gives the block", push,
                             finite && !settings.given("push") ? 0.9 * critical.error : 0});
  result.readings.push_back({"runs_away", "1", "1 if the block runs away after this push, 0 if it stops",
                             std::isnan(critical.value) ? critical.value
                             : push > critical.value    ? 1.0
                                                        : 0.0});
  result.readings.push_back(critical);
  result.readings.push_back({"critical_impulse", "N s", "mass times the critical speed",
                             model.slider.mass * critical.value, model.slider.mass * critical.error});

  Panel panel{.x_label = "way of the block",
              .x_unit = "m",
              .y_label = "slip rate v",
              .y_unit = "m/s",
              .y_decades = !set_valued,
              .curves = {}};
  panel.curves.push_back({"push", result.record.column("slid"), result.record.column("slip_rate")});
  if (finite) {
    const double farthest = result.record.column("slid").back();
    for (const double v0 : {0.99 * critical.value, 1.01 * critical.value}) {
      Result other;
      for (double stretch = 1; stretch < 100; stretch *= 8) {  // close to critical it takes its time
        record_run(other, task, motion_of(model), slope.pushed(v0), times_after(v0, stretch));
        const auto &x = other.record.columns[0], &u = other.record.columns[2];
        if (-x.back() > 4 * farthest || u.back() == 0) break;
      }
      Panel::Curve curve{v0 < critical.value ? "1 % below critical" : "1 % above critical", {}, {}};
      const auto slid = slid_in(other.record);
      for (std::size_t i = 0; i < slid.size() && slid[i] < 4 * farthest; ++i)
        curve.x.push_back(slid[i]), curve.y.push_back(other.record.columns[2][i]);
      panel.curves.push_back(std::move(curve));
    }
  }
  result.panels = {std::move(panel)};
  return result;
}

}  // namespace

Experiment impulse() {
  std::vector<Setting> settings = block_settings();
  settings.insert(
      settings.end(),
      {{.quantity =
            {"slope", "rad", {1e-6, 1.55}, "slope of the table; else between the least and the greatest coefficient"}},
       {.quantity = {"push", "m/s", {1e-12, 1e3}, "speed that the push gives; else nine tenths of the critical speed"}},
       {.quantity = {"duration", "s", {1e-12, 1e9}, "length of the record; else until it shows what happens"}},
       {.quantity = {"rest_speed",
                     "m/s",
                     {1e-15, 1e3},
                     "slip rate that counts as rest under laws that creep; else a thousandth of the push"}},
       {.quantity = {"samples", "1", {8, 1e6}, "pairs of samples"}, .value = 500.0, .whole = true}});
  return {
      .name = "impulse",
      .title = "Rabinowicz's impulse",
      .settings = std::move(settings),
      .slider = {.mass = 1, .stiffness = 0, .damping = 0},
      .drive = {.speed = 0.0, .normal_load = 1.0, .force = 0.0},
      .extra_columns = {"slid"},
      .prescribed = {"drive.speed", "drive.normal_load", "drive.force", "oscillator.stiffness", "oscillator.damping"},
      .only_slider = "a push gives a block alone its speed, and would set a frame that holds it swinging",
      .protocol = perform_impulse};
}

}  // namespace rosin::analysis::lab
