/// Weight resolved along and across the table; contacts prepared by sliding and rest.
#include "analysis/lab/block.hpp"

#include <cmath>
#include <numbers>

#include "core/stop.hpp"

namespace rosin::analysis::lab {

Model block(const Task& task, double slope, double rate) {
  Model model = task.model;
  if (!(model.slider.mass > 0)) throw InputError("oscillator.mass = 0: a block on a slope needs a mass (kg)");
  const double weight = model.slider.mass * task.settings.number("gravity");
  model.slider.stiffness = model.slider.damping = 0;
  model.drive.speed = 0.0;
  if (rate == 0) {
    model.drive.force = -weight * std::sin(slope);
    model.drive.normal_load = weight * std::cos(slope);
  } else {
    model.drive.force = Signal(Signal::Harmonics{0, {{weight, rate, slope + std::numbers::pi / 2}}});
    model.drive.normal_load = Signal(Signal::Harmonics{0, {{weight, rate, slope}}});
  }
  return model;
}

motion::Start rested(const Task& task) {
  const auto& law = *task.model.law;
  const Model level = block(task, 0);
  motion::Start start{motion::Start::Kind::given, {}, {}, 0.0, {}};
  const double N = level.drive.normal_load.level(), rest = task.settings.number("rest_time");
  if (memoryless(task.model)) return start;
  auto states = law.steady({task.settings.number("prior_speed"), N});
  if (law.set_valued()) states = law.after_stop(states);
  if (law.deflects()) states = law.rest(N);  // let go of what sliding bent
  const auto put = [&](auto value_of) {
    for (std::size_t i = 0; i < states.size(); ++i) start.states[law.states()[i].name] = value_of(i);
  };
  put([&](std::size_t i) { return states[i]; });
  if (rest == 0) return start;
  motion::RunOptions options;
  options.duration = rest;
  options.times = {rest};
  options.start = start;
  options.tolerance = task.tolerance;
  const auto held = analysis::motion::run(level, options);
  end_if_stopped();
  // Nothing moves, so that the tolerance, which asks also for the speed of what does not, says nothing.
  if (held.time.empty() || (!held.outcome.complete() && held.outcome.ending != Ending::tolerance_not_met))
    throw InputError("lab.rest_time: the rest could not be computed: " + held.outcome.detail);
  put([&](std::size_t i) { return held.columns[5 + i].back(); });
  return start;
}

std::vector<double> states_of(const FrictionLaw& law, const motion::Start& start) {
  std::vector<double> states;
  for (const auto& s : law.states())
    if (start.states.contains(s.name)) states.push_back(start.states.at(s.name));
  return states;
}

double balance_slope(const Task& task, const std::function<double(double)>& coefficient_at_load) {
  const double weight = task.model.slider.mass * task.settings.number("gravity");
  double slope = 0;
  for (int i = 0; i < 100; ++i) {
    const double next = std::atan(coefficient_at_load(weight * std::cos(slope)));
    if (next == slope) break;
    slope = next;
  }
  return slope;
}

std::vector<Setting> block_settings() {
  return {{.quantity = {"gravity", "m/s2", {1e-6, 1e6}, "acceleration of gravity"}, .value = standard_gravity},
          {.quantity = {"rest_time", "s", {0, 1e12}, "rest of the block before it is let go"}, .value = 10.0},
          {.quantity = {"prior_speed", "m/s", {1e-14, 1e3}, "sliding that made the contacts before the rest"},
           .value = 1e-6}};
}

}  // namespace rosin::analysis::lab
