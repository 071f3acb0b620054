/// The inclined plane: a table is tilted until the block on it slides, and back until it no longer would.
///
/// tan α_s = μ_s and tan α_d = μ_d, the least of the steady curve (Coulomb 1785). Rate-and-state contacts creep at
/// every slope; the block runs away where tan α passes the maximum of the steady curve, if there is one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/lab/block.hpp"

namespace rosin::analysis::lab {

namespace {

constexpr double slowest_slip = 1e-12;  ///< m/s: lower end of the steady curve that is searched
constexpr double steepest = 1.55;       ///< rad

/// The least slope that sustains sliding, and the slope above which creep runs away: minimum and maximum of the steady
/// curve. NaN where the curve has none.
void read_curve(Result& result, const Task& task) {
  const auto& law = *task.model.law;
  const double fastest = task.settings.number("fastest"), none = std::nan("");
  const auto range_at = [&](double N) { return steady_range(law, N, slowest_slip, fastest); };
  const auto range = range_at(task.model.slider.mass * task.settings.number("gravity"));
  const double least =
      range.minimum ? balance_slope(task, [&](double N) { return range_at(N).minimum.value_or(none); }) : none;
  if (!range.minimum)
    result.warnings.push_back(fmt::format(
        "the steady curve has no minimum up to lab.fastest = {:g} m/s: no least slope sustains sliding", fastest));
  constexpr double rounding = 1e-15;
  result.readings.push_back({"mu_d", "1", "tan of the least slope that sustains sliding: minimum of the steady curve",
                             std::tan(least), rounding});
  result.readings.push_back({"sustaining_angle", "rad", "that slope", least, rounding});
  if (memoryless(task.model)) return;
  const double most =
      range.maximum ? balance_slope(task, [&](double N) { return range_at(N).maximum.value_or(none); }) : none;
  result.readings.push_back({"runaway_coefficient", "1", "maximum of the steady curve: steeper, no creep is steady",
                             std::tan(most), rounding});
  result.readings.push_back({"runaway_angle", "rad", "the slope of it", most, rounding});
  if (!range.maximum) return;
  // Steady creep on the strengthening branch below the maximum, by bisection of the steady curve.
  Table creep{"creep", {"slope", "slip_rate"}, {"rad", "m/s"}, {{}, {}}};
  for (const double part : {0.8, 0.9, 0.95, 0.98, 0.99, 0.999}) {
    const double slope = std::atan(part * std::tan(most));
    const double N = task.model.slider.mass * task.settings.number("gravity") * std::cos(slope);
    double low = std::log(1e-40), high = std::log(range.maximum_at);
    for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
      (law.steady_friction({std::exp(middle), N}).friction < std::tan(slope) ? low : high) = middle;
    creep.values[0].push_back(slope);
    creep.values[1].push_back(std::exp(high));
  }
  result.tables.push_back(std::move(creep));
}

/// The slope at which slip starts, and the mean coefficient from balance of momentum once it has.
std::vector<Reading> read_record(const Record& seen, double gravity, double rate, double threshold) {
  const auto &t = seen.time, &u = seen.column("slip_rate"), &slope = seen.column("slope");
  std::size_t i = 1;
  while (i < t.size() && u[i] < threshold) ++i;
  if (i == t.size())
    return {{"slip_angle", "rad", "slope at which slip starts", std::nan("")},
            {"mu_s", "1", "tan of it", std::nan("")},
            {"mu_moving", "1", "mean coefficient in motion, by balance of momentum", std::nan("")}};
  const double part = std::clamp((threshold - u[i - 1]) / (u[i] - u[i - 1]), 0.0, 1.0);
  const double start = std::lerp(slope[i - 1], slope[i], part);
  // ∫(g sin α − μ g cos α) dt = Δu, over the last half of the motion
  const std::size_t a = (i + t.size() - 1) / 2, b = t.size() - 1;
  const double alpha = rate * t[a], beta = rate * t[b];
  const double mu =
      (std::cos(alpha) - std::cos(beta) - (u[b] - u[a]) * rate / gravity) / (std::sin(beta) - std::sin(alpha));
  return {{"slip_angle", "rad", "slope at which the slip rate passes slip_threshold", start},
          {"mu_s", "1", "tan of it", std::tan(start)},
          {"mu_moving", "1", "mean coefficient in motion, by balance of momentum", mu}};
}

Result perform_inclined_plane(const Task& task) {
  Result result;
  const auto& settings = task.settings;
  const auto& law = *task.model.law;
  const double gravity = settings.number("gravity"), rate = settings.number("angle_rate"),
               travel = settings.number("travel");
  const double threshold = settings.number("slip_threshold");
  const Model model = block(task, 0, rate);
  const motion::Start start = rested(task);

  // Where to look for slip: the static limit, or friction of the rested contacts at the speed that counts as slip.
  const auto states = states_of(law, start);
  const double guess = balance_slope(task, [&](double N) {
    if (const auto limit = static_limit(law, N, states)) return *limit;
    return memoryless(model) ? steady_range(law, N, slowest_slip, threshold).most
                             : law.friction({threshold, N}, states);
  });
  const double run_out = std::cbrt(6 * travel / (gravity * rate));  // time to slide that far with nothing lost
  double end = std::min(guess / rate + run_out, steepest / rate);
  const auto times_to = [&](double last, int count) {
    std::vector<double> times;
    const double bent = std::max(guess / rate * 0.999, 0.5 * last);
    for (int i = 0; i <= count; ++i) times.push_back(std::min(bent, last) * i / count);
    for (int i = 1; i <= count && bent < last; ++i) times.push_back(std::lerp(bent, last, double(i) / count));
    return times;
  };
  Result trial;
  for (;; end = std::min(1.1 * end, steepest / rate)) {
    trial = {};
    record_run(trial, task, motion_of(model), start, times_to(end, 200));
    const auto& x = trial.record.columns[0];
    if (!trial.outcome.complete() || -x.back() >= travel || end == steepest / rate) break;
  }
  const auto& x = trial.record.columns[0];
  if (-x.back() < travel)
    result.warnings.push_back(fmt::format("the block has slid {:.3g} m only at a slope of {:.4g} rad: it creeps",
                                          -x.back(), rate * trial.record.time.back()));
  else
    for (std::size_t i = 1; i < x.size(); ++i)
      if (-x[i] >= travel) {
        end = std::lerp(trial.record.time[i - 1], trial.record.time[i], (travel + x[i - 1]) / (x[i - 1] - x[i]));
        break;
      }
  end = std::min(end, trial.record.time.back());
  record_run(result, task, motion_of(model), start, times_to(end, 2 * settings.count("samples")));
  std::vector<double> slope, slid;
  for (std::size_t i = 0; i < result.record.time.size(); ++i) {
    slope.push_back(rate * result.record.time[i]);
    slid.push_back(-result.record.columns[0][i]);
  }
  result.record.add("slope", "rad", std::move(slope));
  result.record.add("slid", "m", std::move(slid), result.record.errors[0]);
  read_off(result, task.sensor, [&](const Record& seen) { return read_record(seen, gravity, rate, threshold); });

  // A set-valued law slips at a located event, which tells more than samples do.
  const auto slips = std::ranges::find(result.events, "slip", &motion::RunEvent::kind);
  if (law.set_valued() && task.sensor.ideal() && slips != result.events.end()) {
    result.readings[0].value = rate * slips->time;
    result.readings[1].value = std::tan(rate * slips->time);
    // At rest nothing but a state that sets the limit is integrated; tan' = 1 + tan².
    const double error = 1e-14 + (law.has_states() ? result.record.errors[4] : 0);
    result.readings[1].error = error;
    result.readings[0].error = error / (1 + result.readings[1].value * result.readings[1].value);
    result.plan.push_back("start of slip: a located event; least slope: closed form");
  }
  read_curve(result, task);
  const auto& seen = result.record;
  std::vector<double> tangent;
  for (const double alpha : seen.column("slope")) tangent.push_back(std::tan(alpha));
  result.panels = {{.x_label = "slope",
                    .x_unit = "rad",
                    .y_label = "slip rate v",
                    .y_unit = "m/s",
                    .y_decades = law.has_states(),
                    .curves = {{"", seen.column("slope"), seen.column("slip_rate")}}},
                   {.x_label = "slope",
                    .x_unit = "rad",
                    .y_label = "friction coefficient μ",
                    .y_unit = "1",
                    .curves = {{"friction", seen.column("slope"), seen.column("friction_coefficient")},
                               {"tan of the slope", seen.column("slope"), tangent}}}};
  return result;
}

}  // namespace

Experiment inclined_plane() {
  std::vector<Setting> settings = block_settings();
  settings.insert(
      settings.end(),
      {{.quantity = {"angle_rate", "rad/s", {1e-9, 1e3}, "rate at which the table tilts"}, .value = 0.01},
       {.quantity = {"slip_threshold", "m/s", {1e-12, 1e3}, "slip rate that counts as sliding"}, .value = 1e-4},
       {.quantity = {"travel", "m", {1e-9, 1e3}, "length that the block slides before the record ends"}, .value = 0.05},
       {.quantity = {"fastest", "m/s", {1e-9, 1e3}, "fastest sliding of which the table asks"}, .value = 10.0},
       {.quantity = {"samples", "1", {8, 1e6}, "pairs of samples before and after slip"},
        .value = 250.0,
        .whole = true}});
  return {
      .name = "inclined-plane",
      .title = "Inclined plane",
      .settings = std::move(settings),
      .slider = {.mass = 1, .stiffness = 0, .damping = 0},
      .drive = {.speed = 0.0, .normal_load = 1.0, .force = 0.0},
      .extra_columns = {"slope", "slid"},
      .prescribed = {"drive.speed", "drive.normal_load", "drive.force", "oscillator.stiffness", "oscillator.damping"},
      .only_slider = "down a slope a block slides by its own weight, and no frame holds it",
      .protocol = perform_inclined_plane};
}

}  // namespace rosin::analysis::lab
