/// What one period of a structure shows: extremes and means of each column of the record, time at rest, heat.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/follower.hpp"
#include "analysis/motion/structure_record.hpp"

namespace rosin::analysis::cycles {

class PeriodRecord {
 public:
  explicit PeriodRecord(const oscillators::StructureSystem&);
  /// Values of all columns at the start and the stages of the step, their extremes and means.
  void add(motion::Follower::Step&, std::span<const motion::Follower::Event> switches);
  /// Of a period of this duration (s), all of whose steps were added.
  void finish(double duration);

  std::map<std::string, StructureCycle::Measure> metrics;
  std::vector<double> coordinate_max, coordinate_min;
  std::vector<motion::RunEvent> events;  ///< by the time since the start
  std::vector<double> time;
  motion::StructureRecord record;

 private:
  double look_between(motion::Follower::Step&, std::size_t column, double sign);

  const oscillators::StructureSystem& system_;
  std::vector<std::array<double, motion::Follower::Step::stages + 1>> steps_;
  std::vector<double> high_, low_, mean_, stick_, force_;
  double heat_ = 0, moment_ = 0;
};

/// Names of a column and of a contact's rest as metrics have them.
std::string short_name(const std::string& column);
std::string name_of_stick(const oscillators::StructureSystem&, int contact);

}  // namespace rosin::analysis::cycles
