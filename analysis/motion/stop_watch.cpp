/// Location of impacts, contact and release of end stops within steps, and rest after bouncing.
#include "analysis/motion/stop_watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rosin::analysis::motion {

using oscillators::Stop;
using oscillators::StopMode;

namespace {
constexpr double digits = std::numeric_limits<double>::epsilon();
}

std::vector<int> StopWatch::begin(double t, const std::vector<double>& y) {
  std::vector<int> may_hold;
  std::vector<double> scale(y.size());
  system_.scale(y.data(), scale.data());
  for (int s = 0; s < system_.stops(); ++s) {
    const Stop& stop = system_.structure().stops[s];
    constexpr double at_rest = 1e-11;
    const double gap = system_.stop_gap(s, y.data()), speed = system_.stop_speed(s, t, y.data());
    system_.set_stop_mode(s, StopMode::open);
    if (!stop.rigid() && gap < 0 && system_.stop_push(s, t, y.data()) > 0) system_.set_stop_mode(s, StopMode::pushes);
    if (stop.rigid() && std::abs(gap) <= at_rest * scale[stop.coordinate] &&
        std::abs(speed) <= at_rest * scale[system_.coordinates() + stop.coordinate])
      may_hold.push_back(s);
  }
  return may_hold;
}

/// Positive while the present mode of the stop lasts.
double StopWatch::margin(int stop, double t, const double* y) const {
  const Stop& of = system_.structure().stops[stop];
  if (system_.stop_mode(stop) == StopMode::holds) return system_.stop_push(stop, t, y);
  const double gap = system_.stop_gap(stop, y);
  if (of.rigid()) return gap;
  const double open = std::max(gap, -system_.stop_push(stop, t, y) / of.stiffness);
  return system_.stop_mode(stop) == StopMode::open ? open : -open;
}

/// Rounding beside a stop that was just left is no switch.
bool StopWatch::switches(int stop, double t, const double* y, double value, double before) const {
  if (!(value < 0)) return false;
  if (system_.stop_mode(stop) == StopMode::holds) return true;
  return system_.structure().stops[stop].rigid() ? system_.stop_speed(stop, t, y) > 0 : value < before;
}

int StopWatch::find(Step& step) {
  constexpr int nodes = Step::stages + 1;
  std::fill(bounced_.begin(), bounced_.end(), false);
  std::vector<double> y(step.state().size());
  int first = -1;
  double first_part = infinity;
  for (int s = 0; s < system_.stops(); ++s) {
    const auto value = [&](double t, const double* at) { return margin(s, t, at); };
    std::array<double, nodes> values;
    values[0] = value(step.time_before(), step.state_before().data());
    double low = 0, high = -1, low_value = values[0], high_value = 0;
    for (int i = 1; i < nodes && high < 0; ++i) {
      step.stage(i - 1, y.data());
      const double t = step.stage_time(i - 1);
      values[i] = value(t, y.data());
      if (switches(s, t, y.data(), values[i], values[i - 1]))
        high = step.node(i - 1), high_value = values[i];
      else
        low = step.node(i - 1), low_value = values[i];
    }
    if (high < 0 && system_.stop_mode(s) == StopMode::open) {  // a touch between two nodes
      const auto between = [&](double theta) { return solvers::steps::RadauTableau::get().interpolate(values, theta); };
      constexpr int fine = 32;
      int lowest = 0;
      for (int i = 1; i <= fine; ++i)
        if (between(double(i) / fine) < between(double(lowest) / fine)) lowest = i;
      const double theta = double(lowest) / fine;
      constexpr double rounding = 1e-12;
      if (lowest > 0 && lowest < fine && between(theta) < -rounding * *std::ranges::max_element(values) &&
          step.solve_at(theta, y.data())) {
        high_value = value(step.time_at(theta), y.data());
        low = 0, low_value = values[0];
        for (int i = 1; i < nodes; ++i)
          if (step.node(i - 1) < theta) low = step.node(i - 1), low_value = values[i];
        if (high_value < 0) high = theta;
      }
    }
    if (high < 0 || low > first_part) continue;
    const auto theta = step.locate(value, low, high, std::max(low_value, 0.0), high_value);
    if (theta && *theta < first_part) first = s, first_part = *theta;
  }
  constexpr double at_once = 1e-9;  // part of a step that began behind the switch, as where forces jump
  if (first >= 0 && !step.shorten(std::max(first_part, at_once))) return -1;
  return first;
}

std::vector<int> StopWatch::together_with(int stop, double t, const std::vector<double>& y) const {
  std::vector<int> list = {stop};
  std::vector<double> scale(y.size());
  system_.scale(y.data(), scale.data());
  for (int s = 0; s < system_.stops(); ++s) {
    const Stop& of = system_.structure().stops[s];
    constexpr double same = 1e-13;
    if (s != stop && of.rigid() && system_.stop_mode(s) == StopMode::open &&
        system_.stop_gap(s, y.data()) <= same * scale[of.coordinate] && system_.stop_speed(s, t, y.data()) > 0)
      list.push_back(s);
  }
  return list;
}

MotionEvent StopWatch::pass(int stop, double t, std::vector<double>& y) {
  const Stop& of = system_.structure().stops[stop];
  MotionEvent event{.kind = {}, .time = t, .contact = -1, .stop = stop, .displacement = y[of.coordinate], .speed = 0};
  const StopMode mode = system_.stop_mode(stop);
  if (!of.rigid()) {
    event.kind = mode == StopMode::open ? "contact" : "free";
    system_.set_stop_mode(stop, mode == StopMode::open ? StopMode::pushes : StopMode::open);
  } else if (mode == StopMode::holds) {
    event.kind = "leave";
    system_.set_stop_mode(stop, StopMode::open);
  } else {
    event.kind = "impact";
    event.speed = system_.stop_speed(stop, t, y.data());
    hardest_[stop] = std::max(hardest_[stop], event.speed);
    bounced_[stop] = true;
    event.displacement = y[of.coordinate] = of.at;
    system_.set_stop_speed(stop, t, -of.restitution * event.speed, of.side, y.data());
  }
  return event;
}

/// Acceleration into the stop at another speed towards it.
double StopWatch::inward(int stop, double t, std::vector<double> y, double speed) const {
  const int side = system_.structure().stops[stop].side;
  system_.set_stop_speed(stop, t, speed, speed > 0 ? -side : side, y.data());
  return system_.stop_acceleration(stop, t, y.data());
}

bool StopWatch::comes_to_rest(int stop, double t, std::vector<double>& y, MotionEvent& event) {
  const Stop& of = system_.structure().stops[stop];
  std::vector<ContactMode> modes(system_.contacts());
  for (int c = 0; c < system_.contacts(); ++c) modes[c] = system_.mode(c);
  const double u = std::max(-system_.stop_speed(stop, t, y.data()), 0.0);
  // Away, then back: of a coordinate that does not move at all friction has either sign.
  const double away = inward(stop, t, y, -u), back = inward(stop, t, y, u > 0 ? u : 1e-300);
  for (int c = 0; c < system_.contacts(); ++c) system_.set_mode(c, modes[c]);
  if (!(away > 0)) return false;
  const double part = back > 0 ? of.restitution * std::sqrt(back / away) : 0;
  const double flight = u / away + (back > 0 ? u / std::sqrt(away * back) : 0), rise = 0.5 * u * u / away;
  constexpr double slow = 1e-7, flat = 1e5, short_flight = 0.3;
  const bool rests = u <= slow * hardest_[stop] || rise <= flat * digits * std::abs(of.at) || flight <= 4 * digits * t;
  if (!rests || part >= 1) {
    first_step_end_ = std::min(horizon(t), t + short_flight * flight);
    return false;
  }
  system_.rest_on_stop(stop, t, y.data());
  system_.set_stop_mode(stop, StopMode::holds);
  hardest_[stop] = 0;
  event = {
      .kind = "rest", .time = t + flight / (1 - part), .contact = -1, .stop = stop, .displacement = of.at, .speed = 0};
  return true;
}

}  // namespace rosin::analysis::motion
