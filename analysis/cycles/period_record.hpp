/// Metrics of one period of any oscillator: the list of them, and their values from the steps that solve the period.
#pragma once
#include <array>
#include <complex>
#include <map>
#include <string>
#include <vector>

#include "analysis/cycles/slip_record.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/follower.hpp"
#include "analysis/motion/structure_record.hpp"

namespace rosin::analysis::cycles {

class PeriodRecord {
 public:
  /// \param tolerance  of the steps that will be recorded
  explicit PeriodRecord(const oscillators::StructureSystem&, double tolerance = 1e-8,
                        double stick_threshold = CycleOptions().stick_threshold);
  /// Values of all columns at the start and the stages of the step, their extremes and means.
  void add(motion::Follower::Step&, std::span<const motion::Follower::Event> switches);
  /// Steady sliding at y in place of the steps of a period.
  void stand(const double* y);
  /// Of a period of this duration (s), all of whose steps were added.
  void finish(double duration);

  std::map<std::string, StructureCycle::Measure> metrics;
  std::vector<double> coordinate_max, coordinate_min;
  std::vector<motion::RunEvent> events;  ///< by the time since the start
  std::vector<double> time;
  motion::StructureRecord record;

 private:
  double wear_rate(int contact, double t, const double* y) const;
  static constexpr int parts = 16;
  using Between = std::array<double, parts + 1>;  ///< a column's polynomial at the ends of equal parts of a step
  double look_between(motion::Follower::Step&, std::size_t column, const Between&, double sign);
  void add_slip(motion::Follower::Step&);
  void add_metric(std::string name, double value, std::string unit, std::string meaning);
  void add_slip_metrics(int friction_contact, double duration);
  void add_friction_drops();
  /// A place of Gauss's rule in a part of a step, for integrals over the period.
  struct Place {
    std::size_t step;
    double theta, weight;
    std::complex<double> turned;  ///< e^(iωt)
  };
  std::vector<Place> places(double duration) const;
  void add_harmonics(int coordinate, double duration, const std::vector<Place>&);

  const oscillators::StructureSystem& system_;
  std::vector<std::array<double, motion::Follower::Step::stages + 1>> steps_;
  std::vector<double> high_, low_, mean_, stick_, force_;
  std::vector<SlipRecord> slip_;  ///< of the contacts with friction
  std::vector<int> slips_;        ///< the contact of each
  std::vector<double> distance_;  ///< slipped by each, m
  std::vector<double> wear_;      ///< ∫ N |v| dt of each, J
  std::vector<double> length_;    ///< of the steps, s
  double heat_ = 0, moment_ = 0;
};

/// The name of a column in those of metrics: "friction" of a friction coefficient.
std::string metric_name(const std::string& column);

/// The metrics in steady sliding: extremes and means are its values, and ranges, times at low slip rates, harmonics and
/// loops 0. Periods, phases and what adds up over a period have no value. \throws InputError without steady sliding
std::map<std::string, double> metrics_of_sliding(const oscillators::Structure&);

}  // namespace rosin::analysis::cycles
