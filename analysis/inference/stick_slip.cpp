/// Cycles of the slider or of another machine, computed once for each speed however many events were recorded at it.
#include "analysis/inference/stick_slip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/structure_extremes.hpp"
#include "oscillators/structure_at_contact.hpp"

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

/// Of the slider. \throws InputError where there is no stick–slip.
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

/// The spring force at a moment of the cycle, N.
double force_at(const Machine::Cycle& seen, const Eigen::VectorXd& weights, double time) {
  const auto& moments = seen.cycle.time;
  std::size_t nearest = 0;
  for (std::size_t k = 0; k < moments.size(); ++k)
    if (std::abs(moments[k] - time) < std::abs(moments[nearest] - time)) nearest = k;
  double force = 0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) force += weights[i] * seen.cycle.columns[std::size_t(i)][nearest];
  return force;
}

/// \throws InputError where there is no stick–slip, or events differ.
double observed(const Machine& machine, const MachineNumbers& numbers, Measurement::Event event) {
  const auto seen = machine.cycle(numbers);
  const auto& [structure, cycle] = *seen;
  const double V = numbers.at("drive.speed");
  constexpr double rough = 1e-5;
  if (cycle.returns == 0 || !(cycle.metrics.at("period").error < rough * cycle.metrics.at("period").value))
    throw InputError(fmt::format("{}: no stick–slip at a drive speed of {:.6g} m/s: {}", machine.name(), V,
                                 cycle.outcome.detail.empty() ? "sliding is steady" : cycle.outcome.detail));
  std::map<int, std::vector<double>> sticks, slips;  // s, by contact
  for (const auto& event_of_contact : cycle.events)
    if (event_of_contact.kind == "stick" || event_of_contact.kind == "slip")
      (event_of_contact.kind == "stick" ? sticks : slips)[event_of_contact.contact].push_back(event_of_contact.time);
  for (const auto& [contact, times] : slips)
    if (times.size() > 1)
      throw InputError(fmt::format(
          "{}: the contact slips {} times in a period at a drive speed of {:.6g} m/s, and its events differ; "
          "fit the motion, type = \"motion\"",
          machine.name(), times.size(), V));
  const auto range = [&] {
    const auto force = cycles::extremes_of(cycle, oscillators::spring_force(structure));
    return force.high - force.low;
  };
  switch (event) {
    case Measurement::Event::recurrence:
      return cycle.metrics.at("period").value;
    case Measurement::Event::peak_slip_rate: {
      double fastest = -infinity;
      for (const auto& [name, measure] : cycle.metrics)
        if (name.starts_with("slip_rate") && name.ends_with("_max")) fastest = std::max(fastest, measure.value);
      return fastest;
    }
    case Measurement::Event::force_range:
      return range();
    case Measurement::Event::force_drop: {
      if (slips.empty()) return range();
      if (slips.size() > 1)
        throw InputError(
            fmt::format("{}: {} contacts stick and slip, each at its own time: no force drop is that of an event; fit "
                        "recurrence or peak_slip_rate",
                        machine.name(), slips.size()));
      const auto& [contact, onset] = *slips.begin();
      const auto weights = oscillators::spring_force(structure);
      return force_at(*seen, weights, onset.front()) - force_at(*seen, weights, sticks[contact].front());
    }
  }
  return 0;
}

/// The event at a drive speed, of the subject's slider or of the measurement's machine.
double observed(const Subject& subject, const Measurement& m, double speed) {
  if (!m.machine) {
    auto model = subject.model;
    model.drive = {speed, m.normal_load, 0.0};
    return observed(model, m.event, m.name);
  }
  auto numbers = subject.changed;
  numbers["drive.speed"] = speed, numbers["drive.normal_load"] = m.normal_load;
  return observed(*subject.machines.at(*m.machine), numbers, m.event);
}

}  // namespace

Prediction predict_stick_slip(const Subject& given, const Measurement& m, const std::vector<std::string>& paths) {
  Prediction prediction{std::vector<double>(m.x.size()),
                        std::vector<std::vector<double>>(paths.size(), std::vector<double>(m.x.size()))};
  const auto& law = *given.model.law;
  if (law.set_valued() && given.model.contact_stiffness.present() && m.event == Measurement::Event::force_drop)
    throw InputError(
        fmt::format("{}: law '{}' that sticks to a contact spring has no force drop here; fit recurrence or "
                    "peak_slip_rate",
                    m.name, law.card().name));
  std::map<double, std::vector<std::size_t>> at;  // points by speed
  for (std::size_t k = 0; k < m.x.size(); ++k) at[m.x[k]].push_back(k);
  for (const auto& [speed, points] : at) {
    const double y = observed(given, m, speed);
    for (const auto k : points) prediction.y[k] = y;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      constexpr double part = 3e-4;
      const double value = given.get(paths[i]), step = part * std::abs(value);
      const auto at_value = [&](double p) { return observed(given.with(paths[i], p), m, speed); };
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
