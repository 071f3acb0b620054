/// What is recorded of the motion of a structure: coordinates, velocities, each contact's slip rate and forces, and
/// accelerations of what has a mass.
#pragma once
#include <string>
#include <vector>

#include "analysis/motion/run.hpp"
#include "analysis/motion/stop_watch.hpp"
#include "oscillators/structure_system.hpp"

namespace rosin::analysis::motion {

/// Names of the columns of velocities and accelerations: "second_velocity" for the coordinate "second_displacement".
std::string velocity_name(const std::string& coordinate);
std::string acceleration_name(const std::string& coordinate);

/// The name, with the number of the contact where there are several.
std::string numbered(const oscillators::StructureSystem&, const char* name, int friction_contact);

/// Names and units of the columns, and their values at moments.
class StructureRecord {
 public:
  explicit StructureRecord(const oscillators::StructureSystem&);
  /// The columns at (t, y).
  void observe(double t, const double* y, std::vector<double>& row);
  /// Adds them to `values`.
  void record(double t, const double* y);

  std::vector<std::string> names, units;
  std::vector<std::vector<double>> values;  ///< [column][moment]

 private:
  bool shows_load(int contact) const;
  const oscillators::StructureSystem& system_;
  std::vector<double> force_, row_;
  bool has_mass_;
};

/// As a record numbers it: contacts only where there are several.
RunEvent event_of(const oscillators::StructureSystem&, const MotionEvent&);

}  // namespace rosin::analysis::motion
