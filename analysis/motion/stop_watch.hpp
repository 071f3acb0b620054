/// Impacts of a structure on its end stops, the end of bouncing in rest, and the moments that stops let go.
#pragma once
#include <string>
#include <vector>

#include "oscillators/structure_system.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::motion {

/// What a motion meets: a switch of a contact, or of a stop.
struct MotionEvent {
  std::string kind;  ///< "stick", "slip", "reversal"; of stops "impact", "rest", "leave", "contact", "free"
  double time = 0;
  int contact = -1;  ///< among those that switch; −1: of a stop
  int stop = -1;
  double displacement = 0;  ///< m, of the coordinate of a stop, or along the direction of a contact
  double speed = 0;         ///< before an impact, m/s
};

/// Bounces on a rigid stop become ever shorter and end in rest after infinitely many. Rest is taken where the rebound
/// is below 1e-7 of the hardest impact since the last rest, where the flight rises less than 1e5 last digits of the
/// coordinate, or where it is too short for the clock. What is left of the bouncing is then a geometric series:
/// friction that turns with the velocity makes the acceleration into the stop a₁ on the way out and a₂ on the way back,
/// and each rebound e √(a₂/a₁) times the last.
class StopWatch {
 public:
  using Step = solvers::steps::Collocation;

  explicit StopWatch(oscillators::StructureSystem& system)
      : system_(system), hardest_(system.stops()), bounced_(system.stops()) {}

  /// Modes at the start of a motion: of stops that push by the unknowns; \returns those that may hold, whose
  /// coordinates are on them at rest.
  std::vector<int> begin(double t, const std::vector<double>& y);
  /// Looks for the first switch within the last step, and shortens the step to it. \returns the stop, or −1.
  int find(Step&);
  /// The stops that switch with it at the same instant, itself first.
  std::vector<int> together_with(int stop, double t, const std::vector<double>& y) const;
  /// Takes the stop through its switch: an impact changes the unknowns, all else the mode.
  MotionEvent pass(int stop, double t, std::vector<double>& y);
  /// Of a stop that was just hit, once contacts have their modes: does the coordinate come to rest there? Then `event`
  /// tells when, and the unknowns are those of rest.
  bool comes_to_rest(int stop, double t, std::vector<double>& y, MotionEvent& event);
  /// No step may go on beyond: flights after an impact are seen.
  double horizon(double t) const { return t < first_step_end_ ? first_step_end_ : infinity; }
  bool bounced(int stop) const { return bounced_[stop]; }

 private:
  double margin(int stop, double t, const double* y) const;
  bool switches(int stop, double t, const double* y, double value, double before) const;
  double inward(int stop, double t, std::vector<double> y, double speed) const;

  oscillators::StructureSystem& system_;
  std::vector<double> hardest_;  ///< m/s
  std::vector<bool> bounced_;    ///< since steps were last looked at
  double first_step_end_ = -infinity;
};

}  // namespace rosin::analysis::motion
