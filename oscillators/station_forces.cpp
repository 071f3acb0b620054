/// Friction and normal forces of contacts on the rows that they feel.
#include "oscillators/station_forces.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "oscillators/profile.hpp"

namespace rosin::oscillators {

using Eigen::VectorXd;

StationForces::StationForces(const Structure& structure) : structure_(structure) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> area, gap;
  const auto add_row = [&](const VectorXd& row) {
    for (Eigen::Index i = 0; i < row.size(); ++i)
      if (row[i] != 0) entries.emplace_back(int(area.size()), int(i), row[i]);
    area.push_back(0), gap.push_back(0);
    return int(area.size()) - 1;
  };
  for (std::size_t j = 0; j < structure.contacts.size(); ++j) {
    const FrictionContact& from = structure.contacts[j];
    law_.push_back(from.law->contact({.lambda = from.lambda, .unknowns = Unknowns::states}));
    if (law_.back()->unknowns() > 0 || from.stiffness.present() || from.load_memory > 0)
      throw InputError(fmt::format(
          "contact {}: steps of a given length and the lowest modes alone serve friction laws without states "
          "(not law '{}'), without contact stiffness and load memory",
          j + 1, from.law->card().name));
    Contact& contact = contacts_.emplace_back();
    contact.slip = add_row(from.tangential);
    contact.first = int(area.size()), contact.stations = int(from.normal.cols());
    for (int s = 0; s < contact.stations; ++s) {
      const int row = add_row(from.normal.col(s));
      area[row] = from.area.size() > 0 ? from.area[s] : 1;
      gap[row] = from.gap.size() > 0 ? from.gap[s] : 0;
    }
    if (from.area.size() > 0) contact.area = from.area.sum();
  }
  std::vector<Eigen::Triplet<double>> of_loads;
  for (std::size_t j = 0; j < contacts_.size(); ++j) {
    if (!contacts_[j].presses()) continue;
    const FrictionContact& from = structure.contacts[j];
    const VectorXd along = from.load_along.size() > 0 ? from.load_along : VectorXd(from.normal.col(0));
    for (Eigen::Index i = 0; i < along.size(); ++i)
      if (along[i] != 0) of_loads.emplace_back(int(i), int(pressing_.size()), along[i]);
    pressing_.push_back(int(j));
  }
  directions_.resize(structure.size(), Eigen::Index(pressing_.size()));
  directions_.setFromTriplets(of_loads.begin(), of_loads.end());
  B_.resize(Eigen::Index(area.size()), structure.size());
  B_.setFromTriplets(entries.begin(), entries.end());
  area_ = Eigen::Map<VectorXd>(area.data(), Eigen::Index(area.size()));
  gap_ = Eigen::Map<VectorXd>(gap.data(), Eigen::Index(gap.size()));
}

double StationForces::speed(int contact, double t) const { return structure_.contacts[contact].speed.value(t); }

double StationForces::load(int contact, double t) const {
  const FrictionContact& of = structure_.contacts[contact];
  return of.load_factor * of.normal_load.value(t);
}

VectorXd StationForces::dead_load(double t) const {
  VectorXd loads(Eigen::Index(pressing_.size()));
  for (std::size_t i = 0; i < pressing_.size(); ++i) loads[Eigen::Index(i)] = load(pressing_[i], t);
  return directions_ * loads;
}

void StationForces::evaluate(double t, const VectorXd& place, const VectorXd& rate, Forces& forces,
                             double friction) const {
  const auto size = B_.rows();
  forces.value.setZero(size);
  forces.by_place.setZero(size, size), forces.by_rate.setZero(size, size);
  for (std::size_t j = 0; j < contacts_.size(); ++j) {
    const auto& [slip, first, stations, whole] = contacts_[j];
    const FrictionContact& of = structure_.contacts[j];
    const double load = this->load(int(j), t), preload = load / whole;
    const auto* profile = profile_under(of.normal_law.get());
    double N = contacts_[j].presses() ? 0 : load;
    for (int s = first; s < first + stations; ++s) {
      const auto [level, rise] = profile ? profile->under(s - first, t) : OverProfile::Height{0, 0};
      const auto answer = of.normal_law->at(approach(s, place) + level, rate[s] + rise, preload);
      forces.value[s] = -area_[s] * answer.pressure;
      forces.by_place(s, s) = -area_[s] * answer.pressure_by_approach;
      forces.by_rate(s, s) = -area_[s] * answer.pressure_by_rate;
      N += area_[s] * answer.bound;
      forces.by_place(slip, s) = area_[s] * answer.bound_by_approach;
      forces.by_rate(slip, s) = area_[s] * answer.bound_by_rate;
    }
    const double u = of.speed.value(t) - rate[slip], side = u != 0 ? u : of.speed.value(t);
    double F;
    Slopes<double> slopes;
    law_[j]->linearise({u, N, 0, side < 0 ? -1.0 : 1.0}, nullptr, nullptr, F, slopes);
    forces.value[slip] = friction * F;
    forces.by_place.row(slip).segment(first, stations) *= friction * slopes.F_N;
    forces.by_rate.row(slip).segment(first, stations) *= friction * slopes.F_N;
    forces.by_rate(slip, slip) -= friction * slopes.F_u;
  }
}

}  // namespace rosin::oscillators
