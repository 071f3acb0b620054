/// Extremes of columns located at the full order of the steps, means by the quadrature of their nodes.
#include "analysis/cycles/period_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rosin::analysis::cycles {

using motion::Follower;
using oscillators::StructureSystem;
using solvers::steps::RadauTableau;

std::string short_name(const std::string& column) {
  const std::string coefficient = "friction_coefficient";
  return column.starts_with(coefficient) ? "friction" + column.substr(coefficient.size()) : column;
}

std::string name_of_stick(const StructureSystem& system, int contact) {
  return motion::numbered(system, "stick_fraction", system.friction_contact(contact));
}

PeriodRecord::PeriodRecord(const StructureSystem& system)
    : record(system), system_(system), steps_(record.names.size()) {
  high_.assign(record.names.size(), -infinity), low_.assign(record.names.size(), infinity);
  mean_.assign(record.names.size(), 0.0);
  stick_.assign(system.contacts(), 0.0);
  force_.resize(system.friction_contacts());
}

void PeriodRecord::add(Follower::Step& step, std::span<const Follower::Event> switches) {
  const auto& tableau = RadauTableau::get();
  constexpr int nodes = Follower::Step::stages + 1;
  std::vector<double> y(system_.size()), row;
  if (time.empty()) time.push_back(0), record.record(step.time_before(), step.state_before().data());
  for (int node = 0; node < nodes; ++node) {
    const double t = node == 0 ? step.time_before() : step.stage_time(node - 1);
    if (node == 0)
      y = step.state_before();
    else
      step.stage(node - 1, y.data());
    record.observe(t, y.data(), row);
    for (std::size_t c = 0; c < row.size(); ++c) steps_[c][node] = row[c];
    if (node == 0) continue;
    for (std::size_t c = 0; c < row.size(); ++c) mean_[c] += tableau.b[node - 1] * step.length() * row[c];
    system_.friction_forces(t, y.data(), force_.data());
    for (int j = 0; j < system_.friction_contacts(); ++j)
      heat_ += tableau.b[node - 1] * step.length() * force_[j] * system_.slip_rate(j, t, y.data());
  }
  for (std::size_t c = 0; c < steps_.size(); ++c) {
    for (const double value : steps_[c]) high_[c] = std::max(high_[c], value), low_[c] = std::min(low_[c], value);
    high_[c] = std::max(high_[c], look_between(step, c, +1));
    low_[c] = std::min(low_[c], -look_between(step, c, -1));
  }
  for (int c = 0; c < system_.contacts(); ++c)
    if (system_.mode(c) == ContactMode::stick) stick_[c] += step.length();
  for (int node = 1; node < nodes; ++node) {
    step.stage(node - 1, y.data());
    time.push_back(moment_ + step.node(node - 1) * step.length());
    record.record(step.stage_time(node - 1), y.data());
  }
  moment_ += step.length();
  for (const auto& event : switches) {
    events.push_back(motion::event_of(system_, event));
    events.back().time = moment_ + (event.time - step.time());
  }
}

/// The largest value of `sign` times a column within the step, at the full order, where it is above what is known.
double PeriodRecord::look_between(Follower::Step& step, std::size_t column, double sign) {
  const auto& tableau = RadauTableau::get();
  constexpr int fine = 16;
  const auto by_polynomial = [&](double theta) { return sign * tableau.interpolate(steps_[column], theta); };
  double at = 0;
  for (int i = 1; i <= fine; ++i)
    if (by_polynomial(double(i) / fine) > by_polynomial(at)) at = double(i) / fine;
  const double known = sign > 0 ? high_[column] : -low_[column];
  const double range = *std::ranges::max_element(steps_[column]) - *std::ranges::min_element(steps_[column]);
  constexpr double counts = 1e-13;
  if (at == 0 || at == 1 || !(by_polynomial(at) + 0.1 * range > known + counts * std::abs(known))) return known;
  double left = at - 1.0 / fine, right = at + 1.0 / fine;
  for (int i = 0; i < 30; ++i) {
    const double a = left + (right - left) / 3, b = right - (right - left) / 3;
    if (by_polynomial(a) > by_polynomial(b))
      right = b;
    else
      left = a;
  }
  std::vector<double> y(system_.size()), row;
  const auto exactly = [&](double theta) {
    step.solve_at(theta, y.data());
    record.observe(step.time_at(theta), y.data(), row);
    return sign * row[column];
  };
  double theta = 0.5 * (left + right), best = exactly(theta);
  for (const double aside : {1e-2, 1e-3}) {  // vertices of parabolas
    const double centre = std::clamp(theta, aside, 1 - aside), a = exactly(centre - aside), b = exactly(centre),
                 c = exactly(centre + aside), bend = a - 2 * b + c;
    best = std::max({best, a, b, c});
    if (!(bend < 0)) break;
    theta = std::clamp(centre + 0.5 * aside * (a - c) / bend, 0.0, 1.0);
    best = std::max(best, b - 0.125 * (a - c) * (a - c) / bend);
  }
  return std::max(best, known);
}

void PeriodRecord::finish(double duration) {
  const auto add = [this](const std::string& name, double value, const std::string& unit) {
    metrics[name] = {value, infinity, unit};
  };
  add("period", duration, "s");
  for (std::size_t c = 0; c < record.names.size(); ++c) {
    const auto name = short_name(record.names[c]);
    const auto& unit = record.units[c];
    add(name + "_max", high_[c], unit), add(name + "_min", low_[c], unit);
    add(name + "_amplitude", 0.5 * (high_[c] - low_[c]), unit), add(name + "_mean", mean_[c] / duration, unit);
  }
  coordinate_max.assign(high_.begin(), high_.begin() + system_.coordinates());
  coordinate_min.assign(low_.begin(), low_.begin() + system_.coordinates());
  for (int c = 0; c < system_.contacts(); ++c) add(name_of_stick(system_, c), stick_[c] / duration, "1");
  for (int j = 0; j < system_.friction_contacts(); ++j)
    if (system_.follows_motion(j) && !system_.structure().contacts[j].frictionless())
      add(motion::numbered(system_, "apparent_friction", j),
          metrics.at(motion::numbered(system_, "friction_force", j) + "_mean").value /
              metrics.at(motion::numbered(system_, "normal_load", j) + "_mean").value,
          "1");
  add("friction_work", heat_, "J");
}

}  // namespace rosin::analysis::cycles
