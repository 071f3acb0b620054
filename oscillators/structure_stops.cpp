/// End stops of a structure: gaps, what presses on them, and coordinates that they hold.
#include <cmath>

#include "oscillators/structure_system.hpp"

namespace rosin::oscillators {

void StructureSystem::set_stop_mode(int stop, StopMode mode) { stop_mode_[stop] = mode; }

double StructureSystem::stop_gap(int stop, const double* y) const {
  const Stop& of = structure_.stops[stop];
  return of.side * (of.at - y[of.coordinate]);
}

double StructureSystem::stop_speed(int stop, double t, const double* y) const {
  const Stop& of = structure_.stops[stop];
  return of.side * (is_diagonal_ ? velocity_of(of.coordinate, t, y) : velocity(t, y)[of.coordinate]);
}

double StructureSystem::stop_push(int stop, double t, const double* y) const {
  const Stop& of = structure_.stops[stop];
  if (!of.rigid()) return -of.stiffness * stop_gap(stop, y) + of.damping * stop_speed(stop, t, y);
  return contact_beside_stop(stop, t) >= 0 ? infinity : of.side * forces_without_stick(t, y, nullptr)[of.coordinate];
}

double StructureSystem::stop_acceleration(int stop, double t, const double* y) const {
  const Stop& of = structure_.stops[stop];
  std::vector<double> f(size_);
  evaluate(t, y, f.data());
  const int i = of.coordinate;
  const double rate = f[n_ + i] / row_mass_[i];
  return of.side * (contact_of_row_[i] >= 0 ? surface_acceleration(i, t) - rate : rate);
}

double StructureSystem::surface_acceleration(int coordinate, double t) const {
  const int j = contact_of_row_[coordinate];
  return j >= 0 ? structure_.contacts[j].speed.rate(t) : 0;
}

void StructureSystem::set_stop_speed(int stop, double t, double speed, double side, double* y) {
  const Stop& of = structure_.stops[stop];
  const int i = of.coordinate, own = contact_of_row_[i];
  double& w = y[n_ + i];
  w = own >= 0 ? structure_.contacts[own].speed.value(t) - of.side * speed : of.side * speed;
  if (own >= 0 && law(own).set_valued() && !at_[own].is_elastic()) at_[own].mode = slip_along(w != 0 ? w : side);
  for (int j = 0; j < friction_contacts(); ++j)
    for (const auto& entry : tangential_[j])
      if (entry.column == i && at_[j].carries_friction() && at_[j].rigid())
        at_[j].make_friction_fit(slip_rate(j, t, y), load(j, t, y).level, y + at_[j].first);
}

void StructureSystem::rest_on_stop(int stop, double t, double* y) {
  const Stop& of = structure_.stops[stop];
  y[of.coordinate] = of.at;
  set_stop_speed(stop, t, 0, of.side, y);
}

int StructureSystem::contact_beside_stop(int stop, double t) const {
  const int j = contact_of_row_[structure_.stops[stop].coordinate];
  if (j < 0 || !law(j).set_valued() || at_[j].is_elastic()) return -1;
  const Signal& speed = structure_.contacts[j].speed;
  if (speed.value(t) != 0 || speed.rate(t) != 0) return -1;
  for (int c = 0; c < contacts(); ++c)
    if (switching_[c] == j) return c;
  return -1;
}

/// Slip on a surface that rests is slip away from the stop.
bool StructureSystem::stop_holds(int stop, double t) const {
  if (stop_mode_[stop] != StopMode::holds) return false;
  const int beside = contact_beside_stop(stop, t);
  return beside < 0 || mode(beside) == ContactMode::stick;
}

double StructureSystem::stop_power(double t, const double* y) const {
  double power = 0;
  for (int s = 0; s < stops(); ++s)
    if (stop_mode_[s] == StopMode::pushes) power -= stop_push(s, t, y) * stop_speed(s, t, y);
  return power;
}

/// Of what no spring holds: that of a servo that samples, or of a spring that the force pushes as far as the nearest
/// stop (N/m); 0: nothing holds it.
double StructureSystem::natural_stiffness(const Eigen::VectorXd& along, double force) const {
  double stiffness = 0;
  for (const auto& [servo, held] : structure_.sampled)
    if (along[servo.coordinate] != 0)
      stiffness = std::max(stiffness, servo.proportional + servo.integral * servo.sampling_time);
  for (const Stop& stop : structure_.stops)
    if (stop.at != 0 && along[stop.coordinate] != 0 && structure_.K(stop.coordinate, stop.coordinate) == 0)
      stiffness = std::max(stiffness, force / std::abs(stop.at));
  return stiffness;
}

}  // namespace rosin::oscillators
