/// The metrics of a cycle by name, and the search that fits the law.
#include "analysis/cycles/cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/cycles/smooth_cycle.hpp"
#include "analysis/cycles/stick_slip_cycle.hpp"
#include "analysis/steady/curve.hpp"

namespace rosin::analysis::cycles {

const std::vector<MetricName>& metric_names() {
  static const std::vector<MetricName> list = {
      {"period", "s", "period of the motion", &Metrics::period},
      {"slip_rate_max", "m/s", "largest slip rate", &Metrics::slip_rate_max},
      {"slip_rate_min", "m/s", "smallest slip rate", &Metrics::slip_rate_min},
      {"friction_max", "1", "largest coefficient of friction", &Metrics::friction_max},
      {"friction_min", "1", "smallest coefficient of friction", &Metrics::friction_min},
      {"friction_mean", "1", "mean coefficient of friction", &Metrics::friction_mean},
      {"stick_fraction", "1", "part of the period with |v| <= threshold * V; at exact rest under set-valued laws",
       &Metrics::stick_fraction},
      {"slow_fraction", "1", "part of the period with |v| <= threshold * V, under every law", &Metrics::slow_fraction},
      {"stick_fraction_001", "1", "part of the period with |v| <= 0.01 V", &Metrics::stick_fraction_001},
      {"stick_fraction_05", "1", "part of the period with |v| <= 0.5 V", &Metrics::stick_fraction_05},
      {"loop_area", "m/s", "area enclosed by the friction-velocity loop", &Metrics::loop_area},
      {"loop_area_normalised", "1", "loop area over largest slip rate and friction", &Metrics::loop_area_normalised},
      {"slip_rate_mean", "m/s", "mean slip rate (the drive speed, on a true cycle)", &Metrics::slip_rate_mean},
  };
  return list;
}

const MetricName& find_metric(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& metric : metric_names()) {
    if (name == metric.name) return metric;
    known.emplace_back(metric.name);
  }
  const auto near = nearest_name(name, known);
  throw InputError(fmt::format("unknown metric '{}'{}", name,
                               near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
}

double size_of(const MetricName& metric, const Metrics& m, double V) {
  const double value = std::abs(m.*metric.member);
  if (metric.member == &Metrics::slip_rate_min || metric.member == &Metrics::slip_rate_max) {
    constexpr double digits = 1e-8;  // of the fastest slip, whose rounding error carries over to the slowest
    return std::max({value, V, digits * std::max(std::abs(m.slip_rate_min), std::abs(m.slip_rate_max))});
  }
  if (metric.member == &Metrics::slip_rate_mean) {
    constexpr double digits = 1e-3;  // of reversing slip, whose mean nearly cancels
    return std::max({value, V, digits * std::min(-m.slip_rate_min, m.slip_rate_max)});
  }
  if (metric.member == &Metrics::friction_min || metric.member == &Metrics::friction_max)
    return std::max({1.0, std::abs(m.friction_min), std::abs(m.friction_max)});
  if (metric.member == &Metrics::friction_mean) return std::max(1.0, value);
  if (is_stick(metric)) return 1;
  constexpr double all_but_gone = 0.01;  // coefficient, below which the loop's accuracy is relative to friction
  if (metric.member == &Metrics::loop_area)
    return std::max(value, 0.1 * m.slip_rate_max * std::max(m.friction_max, all_but_gone));
  if (metric.member == &Metrics::loop_area_normalised)
    return std::max(value, 0.1 * std::max(1.0, all_but_gone / std::abs(m.friction_max)));
  return value;
}

bool is_loop(const MetricName& metric) {
  return metric.member == &Metrics::loop_area || metric.member == &Metrics::loop_area_normalised;
}
bool is_stick(const MetricName& metric) {
  return metric.member == &Metrics::stick_fraction || metric.member == &Metrics::slow_fraction ||
         metric.member == &Metrics::stick_fraction_001 || metric.member == &Metrics::stick_fraction_05;
}

std::optional<Model> without_clock(const Model& model) {
  if (model.lambda != 0 || !(model.slider.mass > 0) || model.contact_stiffness.present()) return std::nullopt;
  auto curve = model.law->without_clock(model.drive.normal_load.level());
  if (!curve) return std::nullopt;
  Model same = model;
  same.law = std::move(curve);
  same.lambda = 1;
  return same;
}

namespace {

/// Adds the states, which the set-valued law does not have.
void add_states(Cycle& cycle, const FrictionLaw& law, double normal_load) {
  cycle.section_state = law.steady({0, normal_load});
  for (auto& point : cycle.orbit) point.state = law.steady({point.slip_rate, normal_load});
}

/// The mirror image: drive, force, displacement, slip rate, friction and odd states with the other sign.
void mirror(Cycle& cycle, const FrictionLaw& law) {
  const auto mirror_states = [&](std::vector<double>& state) {
    for (std::size_t i = 0; i < state.size(); ++i)
      if (law.states()[i].parity == Parity::odd) state[i] = -state[i];
  };
  for (Metrics* m : {&cycle.metrics, &cycle.error}) {
    std::swap(m->slip_rate_max, m->slip_rate_min);
    std::swap(m->friction_max, m->friction_min);
  }
  Metrics& m = cycle.metrics;
  for (auto member : {&Metrics::slip_rate_max, &Metrics::slip_rate_min, &Metrics::friction_max, &Metrics::friction_min,
                      &Metrics::friction_mean, &Metrics::slip_rate_mean})
    m.*member = -(m.*member);
  cycle.section_displacement = -cycle.section_displacement;
  mirror_states(cycle.section_state);
  for (auto& p : cycle.orbit) {
    p.displacement = -p.displacement, p.slip_rate = -p.slip_rate, p.friction_coefficient = -p.friction_coefficient;
    p.acceleration = -p.acceleration;
    mirror_states(p.state);
  }
}

}  // namespace

bool only_rings(const Model& model) {
  return model.law->deflects() && !steady::weakens_somewhere(*model.law, model.drive.normal_load.level());
}

Cycle find_cycle(const Model& model, const CycleOptions& options) {
  model.check();
  require(options.tolerance, {1e-13, 0.1}, "tolerance", "relative accuracy of a cycle", "1");
  require(options.stick_threshold, {1e-6, 0.999}, "cycle.stick_threshold", "stick threshold over the drive speed", "1");
  const auto& drive = model.drive;
  if (!drive.constant())
    throw InputError(
        "a cycle is sought under a constant drive, but drive.speed, drive.normal_load or drive.force varies");
  const double V = drive.speed.level();
  Cycle cycle;
  if (V == 0) {
    cycle.outcome = {Ending::none_exists, "drive.speed = 0: without a drive the slider comes to rest"};
  } else if (drive.normal_load.level() == 0) {
    cycle.outcome = {Ending::none_exists, "drive.normal_load = 0: there is no friction"};
  } else if (!(model.slider.stiffness > 0) || !std::isfinite(model.slider.stiffness)) {
    cycle.outcome = {Ending::none_exists, "without a spring of finite stiffness there is no oscillation"};
  } else if (V < 0) {
    Model mirrored = model;
    mirrored.drive.speed = -V;
    mirrored.drive.force = -drive.force.level();
    CycleOptions elsewhere = options;
    elsewhere.near.clear();
    cycle = find_cycle(mirrored, elsewhere);
    mirror(cycle, *model.law);
  } else if (only_rings(model)) {
    cycle.outcome = {Ending::none_exists, "friction nowhere falls with slip rate: nothing feeds an oscillation"};
  } else {
    const auto curve = without_clock(model);
    const Model& searched = curve ? *curve : model;
    cycle =
        searched.law->set_valued() ? find_stick_slip_cycle(searched, options) : find_smooth_cycle(searched, options);
    if (curve) add_states(cycle, *model.law, model.drive.normal_load.level());
    const auto forget = [&](Outcome outcome) {
      const auto cost = cycle.cost;
      cycle = {};
      cycle.cost = cost;
      cycle.outcome = std::move(outcome);
    };
    for (const auto& metric : metric_names())
      if (!std::isfinite(cycle.metrics.*metric.member) || !std::isfinite(cycle.error.*metric.member)) {
        forget({Ending::not_finite, fmt::format("in {}", metric.name)});
        break;
      }
    // Ringing that has not settled may seem to come round, but is no period.
    constexpr double hardly = 0.1;
    if (const double known = cycle.error.period / cycle.metrics.period; known > hardly)
      forget({Ending::tolerance_not_met, fmt::format("period is known to {:.1e} only: none is known", known)});
  }
  return cycle;
}

}  // namespace rosin::analysis::cycles
