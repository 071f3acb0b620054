/// The map of a structure from a section to itself, with its derivative exact through stick.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "analysis/motion/follower.hpp"

namespace rosin::analysis::cycles {

/// Under a periodic drive the section is a moment of it, t = 0. Else a motion crosses the section where one coordinate
/// has a maximum, or a minimum where a rigid stop is above it.
class SectionMap {
 public:
  /// \throws InputError where the drive has no period.
  explicit SectionMap(oscillators::Structure);

  oscillators::StructureSystem& system() { return system_; }
  bool driven() const { return drive_period_ > 0; }
  double drive_period() const { return drive_period_; }
  /// The coordinate whose maxima are the section of a structure that is not driven.
  void watch(int coordinate) { coordinate_ = coordinate; }
  int watched() const { return coordinate_; }

  using Observer = decltype(motion::Follower::observe);
  struct Return {
    Outcome outcome;  ///< an event: the section was reached
    double duration = 0;
    std::vector<double> y;
    Eigen::MatrixXd derivative;  ///< of y with respect to the start; empty if not asked
  };
  /// Follows `returns` returns from y, on the section.
  Return follow(const std::vector<double>& y, double tolerance, int returns, bool derivative,
                const Observer& observe = {});
  /// Follows from y until `crossed` of a crossing, numbered from 1, is true, or the motion has gone on for so long that
  /// it comes to none any more.
  Outcome follow_crossings(std::vector<double> y, double tolerance,
                           const std::function<bool(int crossing, double t, const std::vector<double>& y)>& crossed,
                           const Observer& observe = {});
  /// A time in which anything that moves comes to the section (s).
  double patience() const;
  motion::Follower::Count count;
  long most_steps = 5'000'000;

 private:
  motion::Section section() const;
  /// How unknowns without a rate of their own follow the differential ones, δy_a = slopes·δy_d.
  struct Followers {
    std::vector<int> algebraic, differential;
    Eigen::MatrixXd slopes;
  };
  Followers algebraic(const std::vector<double>& y, const std::vector<double>& mass) const;
  Eigen::VectorXd gradient_of_section(const Followers&) const;
  void add_to_count(const motion::Follower&);

  oscillators::StructureSystem system_;
  double drive_period_;
  int coordinate_ = 0;
};

}  // namespace rosin::analysis::cycles
