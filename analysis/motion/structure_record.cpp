/// Columns of a structure's record.
#include "analysis/motion/structure_record.hpp"

#include <fmt/format.h>

#include "oscillators/profile.hpp"

namespace rosin::analysis::motion {

using oscillators::Structure;
using oscillators::StructureSystem;

namespace {
std::string name_of(const std::string& rate, const std::string& coordinate) {
  const std::string word = "displacement";
  const auto at = coordinate.find(word);
  return at == std::string::npos ? rate + "_of_" + coordinate
                                 : coordinate.substr(0, at) + rate + coordinate.substr(at + word.size());
}
}  // namespace

std::string velocity_name(const std::string& coordinate) { return name_of("velocity", coordinate); }
std::string acceleration_name(const std::string& coordinate) { return name_of("acceleration", coordinate); }

StructureRecord::StructureRecord(const StructureSystem& system) : system_(system), force_(system.friction_contacts()) {
  const Structure& structure = system.structure();
  const auto add = [&](std::string name, std::string unit) {
    names.push_back(std::move(name));
    units.push_back(std::move(unit));
  };
  for (std::size_t i = 0; i < structure.names.size(); ++i) add(structure.names[i], structure.unit(int(i)));
  for (std::size_t i = 0; i < structure.names.size(); ++i)
    add(velocity_name(structure.names[i]), structure.unit(int(i)) + "/s");
  const int contacts = system.friction_contacts();
  for (int j = 0; j < contacts; ++j) {
    const std::string number = contacts > 1 ? fmt::format("_{}", j + 1) : "";
    if (!structure.contacts[j].frictionless()) {
      add("slip_rate" + number, "m/s");
      add("friction_force" + number, "N");
      add("friction_coefficient" + number, "1");
    }
    if (shows_load(j)) add("normal_load" + number, "N");
    if (system.follows_motion(j)) add("open_fraction" + number, "1");
    if (oscillators::profile_under(structure.contacts[j].normal_law.get())) add("profile_height" + number, "m");
    for (const auto& state : structure.contacts[j].law->states()) add(state.name + number, state.unit);
  }
  for (std::size_t i = 0; i < structure.names.size(); ++i)
    if (has_mass(int(i))) add(acceleration_name(structure.names[i]), structure.unit(int(i)) + "/s^2");
  for (const auto& functional : structure.functionals) add(functional.name, functional.unit);
  values.resize(names.size());
}

void StructureRecord::observe(double t, const double* y, std::vector<double>& row) {
  row.clear();
  const int n = system_.coordinates(), contacts = system_.friction_contacts();
  row.insert(row.end(), y, y + n);
  for (const double v : system_.velocity(t, y)) row.push_back(v);
  system_.friction_forces(t, y, force_.data());
  for (int j = 0; j < contacts; ++j) {
    const double N = system_.normal_load(j, t, y);
    if (!system_.structure().contacts[j].frictionless()) {
      row.push_back(system_.slip_rate(j, t, y));
      row.push_back(force_[j]);
      row.push_back(N > 0 ? force_[j] / N : 0);
    }
    if (shows_load(j)) row.push_back(N);
    if (system_.follows_motion(j)) row.push_back(system_.open_fraction(j, t, y));
    if (const auto* profile = oscillators::profile_under(system_.structure().contacts[j].normal_law.get()))
      row.push_back(profile->height().value(t));
    for (const double state : system_.states(j, t, y)) row.push_back(state);
  }
  if ((system_.structure().M.diagonal().array() > 0).any()) {
    const auto acceleration = system_.acceleration(t, y);
    for (int i = 0; i < n; ++i)
      if (has_mass(i)) row.push_back(acceleration[i]);
  }
  for (const auto& functional : system_.structure().functionals)
    row.push_back(functional.row.dot(Eigen::Map<const Eigen::VectorXd>(y, n)));
}

void StructureRecord::record(double t, const double* y) {
  observe(t, y, row_);
  for (std::size_t c = 0; c < row_.size(); ++c) values[c].push_back(row_[c]);
}

bool StructureRecord::shows_load(int contact) const {
  return system_.friction_contacts() > 1 || system_.follows_motion(contact);
}

std::string numbered(const StructureSystem& system, const char* name, int friction_contact) {
  return system.friction_contacts() > 1 ? fmt::format("{}_{}", name, friction_contact + 1) : name;
}

RunEvent event_of(const StructureSystem& system, const MotionEvent& event) {
  const bool numbered = event.contact >= 0 && system.friction_contacts() > 1;
  return {.time = event.time,
          .kind = event.kind,
          .displacement = event.displacement,
          .contact = numbered ? system.friction_contact(event.contact) + 1 : 0,
          .coordinate = event.stop >= 0 ? system.structure().stops[event.stop].coordinate + 1 : 0,
          .speed = event.speed};
}

}  // namespace rosin::analysis::motion
