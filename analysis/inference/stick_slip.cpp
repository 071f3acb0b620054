/// Cycles of the slider, computed once for each speed however many events were recorded at it.
#include "analysis/inference/stick_slip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/cycles/cycle.hpp"

namespace rosin::analysis::inference {

namespace {

/// The range of the displacement in a cycle, between whose points it is the cubic that has their rates, ± (V − v).
double displacement_range(const std::vector<cycles::CyclePoint>& orbit, double V) {
  double way = 0;  // tells the sign: displacement grows while the slider is slower than the drive, or falls
  for (std::size_t i = 0; i + 1 < orbit.size(); ++i)
    way += (orbit[i + 1].displacement - orbit[i].displacement) * (2 * V - orbit[i].slip_rate - orbit[i + 1].slip_rate);
  const double sign = way < 0 ? -1 : 1;
  double low = orbit.front().displacement, high = low;
  const auto reach = [&](double x) { low = std::min(low, x), high = std::max(high, x); };
  for (std::size_t i = 0; i + 1 < orbit.size(); ++i) {
    const auto &p = orbit[i], &q = orbit[i + 1];
    reach(q.displacement);
    const double h = q.time - p.time, a = sign * (V - p.slip_rate) * h, b = sign * (V - q.slip_rate) * h;
    if (!(a * b < 0)) continue;
    // x = x₀ + a θ + (3 d − 2 a − b) θ² + (a + b − 2 d) θ³, whose slope changes sign once
    const double d = q.displacement - p.displacement, second = 3 * d - 2 * a - b, third = a + b - 2 * d;
    double from = 0, to = 1;
    for (int k = 0; k < 60; ++k) {
      const double theta = (from + to) / 2, slope = a + theta * (2 * second + theta * 3 * third);
      (slope * a > 0 ? from : to) = theta;
    }
    reach(p.displacement + from * (a + from * (second + from * third)));
  }
  return high - low;
}

/// \throws InputError where there is no stick–slip.
double observed(const Model& model, Measurement::Event event, const std::string& name) {
  cycles::CycleOptions options;
  options.tolerance = 1e-9;
  options.multipliers = false;
  const auto cycle = cycles::find_cycle(model, options);
  const double V = model.drive.speed.level();
  if (cycle.outcome.ending != Ending::reached_end)
    throw InputError(fmt::format("{}: no stick–slip at a drive speed of {:.6g} m/s: {}", name, V,
                                 cycle.outcome.detail.empty() ? "sliding is steady" : cycle.outcome.detail));
  switch (event) {
    case Measurement::Event::recurrence:
      return cycle.metrics.period;
    case Measurement::Event::peak_slip_rate:
      return cycle.metrics.slip_rate_max;
    case Measurement::Event::force_range:
      return model.slider.stiffness * displacement_range(cycle.orbit, V);
    case Measurement::Event::force_drop:  // the spring is loaded again while the contact sticks
      return model.slider.stiffness * (model.law->set_valued() ? V * cycle.metrics.stick_fraction * cycle.metrics.period
                                                               : displacement_range(cycle.orbit, V));
  }
  return 0;
}

}  // namespace

Prediction predict_stick_slip(const Model& given, const Measurement& m, const std::vector<std::string>& paths) {
  Prediction prediction{std::vector<double>(m.x.size()),
                        std::vector<std::vector<double>>(paths.size(), std::vector<double>(m.x.size()))};
  if (given.law->set_valued() && given.contact_stiffness.present() && m.event == Measurement::Event::force_drop)
    throw InputError(
        fmt::format("{}: law '{}' that sticks to a contact spring has no force drop here; fit recurrence or "
                    "peak_slip_rate",
                    m.name, given.law->card().name));
  std::map<double, std::vector<std::size_t>> at;  // points by speed
  for (std::size_t k = 0; k < m.x.size(); ++k) at[m.x[k]].push_back(k);
  for (const auto& [speed, points] : at) {
    Model model = given;
    model.drive = {speed, m.normal_load, 0.0};
    const double y = observed(model, m.event, m.name);
    for (const auto k : points) prediction.y[k] = y;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      constexpr double part = 3e-4;
      const double value = model.get(paths[i]), step = part * std::abs(value);
      const auto at_value = [&](double p) { return observed(model.with(paths[i], p), m.event, m.name); };
      const double slope = [&] {
        try {
          return (at_value(value + step) - y) / step;
        } catch (const InputError&) {  // stick–slip ends on this side
          return (y - at_value(value - step)) / step;
        }
      }();
      for (const auto k : points) prediction.slopes[i][k] = slope;
    }
  }
  return prediction;
}

}  // namespace rosin::analysis::inference
