/// The one loop that follows an oscillator: from break to break of its drive, from switch to switch of its contacts,
/// and to a section; with the derivative of the motion with respect to its start, if asked.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "analysis/motion/growth.hpp"
#include "analysis/motion/reversal_steps.hpp"
#include "analysis/motion/stop_watch.hpp"
#include "oscillators/structure_system.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace rosin::analysis::motion {

/// A surface in the space of unknowns. A motion crosses it where the value falls through 0.
struct Section {
  std::function<double(double t, const double* y)> value;
  double scale = 1;  ///< a size of the value, > 0
  /// Called at each crossing. True: the motion ends there.
  std::function<bool(double t, const std::vector<double>& y)> crossed;
};

class Follower {
 public:
  using Step = solvers::steps::Collocation;
  using Event = MotionEvent;

  /// \param system  outlives this; its modes are set
  Follower(SwitchingSystem& system, double tolerance) : system_(system), tolerance_(tolerance) {}
  Follower(oscillators::StructureSystem& system, double tolerance)
      : system_(system), structure_(&system), reversal_steps_(system), tolerance_(tolerance), growth_(system) {
    if (system.stops() > 0) stops_.emplace(system);
  }

  /// Called after each step, while the system is still in the modes of it: the step, the switches that it ended in (and
  /// before it, what stops have come to since the last).
  std::function<void(Step&, std::span<const Event>)> observe;
  /// Carries the columns of `tangent` (size × columns, row-major): a disturbance of the start at fixed time becomes
  /// that of the end. At a switch it jumps by the saltation matrix (Aizerman & Gantmakher 1958; Leine & Nijmeijer 2004,
  /// chapter 7): the time of the switch depends on the disturbance, and stick forgets that of the slip rate. Drives
  /// with breaks are not for this. \throws InputError for a servo that samples, which turns a disturbance at its
  /// samples
  void carry(std::vector<double>* tangent, int columns);
  /// The last column of the tangent is the derivative with respect to a parameter, by which these systems differ from
  /// the one that is followed: it is larger by `step` in one and smaller in the other. Not for systems with stops.
  struct Varied {
    SwitchingSystem* system = nullptr;
    double period = 1;  ///< of its drive, over that of the one that is followed: times are compared as parts of it
  };
  void vary(Varied larger, Varied smaller, double step) { varied_ = {larger, smaller, step}; }

  /// Follows from (t, y) to `end` or to where the section says; then y is there, and time() too. Ends `unbounded` where
  /// the coordinates of a structure grow exponentially to a trillion of their natural sizes.
  Outcome follow(double t, std::vector<double>& y, double end, const Section* section = nullptr);
  double time() const { return time_; }

  long most_steps = 5'000'000;  ///< of all that this follows
  struct Count {
    long steps = 0, evaluations = 0, choices = 0;
  };
  const Count& count() const { return count_; }

 private:
  void propagate(Step&);
  int stop_count() const { return stops_ ? structure_->stops() : 0; }
  bool cross_section(Step&, const Section&);
  bool start(solvers::stick_slip::StickSlip&, double t, const std::vector<double>& y);
  bool start_on_stops(solvers::stick_slip::StickSlip&, double t, std::vector<double>& y);
  void settle_modes(double t, const std::vector<double>& y);
  void note_stop(const char* kind, int stop, double t, const std::vector<double>& y);
  void note_contact(solvers::stick_slip::Switch, int contact, double t, const std::vector<double>& y);
  void note_switches(const solvers::stick_slip::StickSlip&);
  void let_go_where_contacts_slip(const solvers::stick_slip::StickSlip&);
  void forget_motion_of(int stop);
  struct Modes {
    std::vector<ContactMode> contacts;
    std::vector<oscillators::StopMode> stops;
  };
  Modes modes_now() const;
  void set_modes(const Modes&);
  void note_changes(const Modes& until, double t, const std::vector<double>& y);
  bool pass_stops(solvers::stick_slip::StickSlip&, int first);
  void carry_across_stop(const MotionEvent&, const std::vector<double>& before, const std::vector<double>& after,
                         const std::vector<double>& y);
  void carry_across_switches(const solvers::stick_slip::StickSlip&);
  /// \param by_parameter  of h, explicitly
  void jump(const std::vector<double>& before, const std::vector<double>& after, const std::vector<double>& gradient,
            double rate, double by_parameter, int ended, const std::vector<double>& y);
  /// Rates of the differential unknowns in the system's present modes.
  std::vector<double> rates(double t, const std::vector<double>& y) const;

  SwitchingSystem& system_;
  oscillators::StructureSystem* structure_ = nullptr;  ///< the system, if it is one that may have stops
  std::optional<ReversalSteps> reversal_steps_;
  double tolerance_, time_ = 0;
  std::vector<double>* tangent_ = nullptr;
  int columns_ = 0;
  struct {
    Varied larger, smaller;
    double step = 0;
  } varied_;
  std::optional<Growth> growth_;    ///< of a structure
  std::optional<StopWatch> stops_;  ///< where there are stops
  std::vector<Event> events_;       ///< that were not told yet
  bool armed_ = false;              ///< the section may be crossed: the motion has left it since its start
  double section_value_ = 0;        ///< at the end of the last step
  Count count_;
};

}  // namespace rosin::analysis::motion
