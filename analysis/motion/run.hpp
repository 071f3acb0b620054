/// Motion from a given start: an initial-value problem with its record, events and error estimate.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/motion/slip_events.hpp"
#include "analysis/motion/start.hpp"
#include "analysis/motion/stepping.hpp"
#include "core/error.hpp"
#include "solvers/force_algorithms/options.hpp"

namespace rosin::analysis::motion {

struct RunOptions {
  double duration = 1;        ///< s
  std::vector<double> times;  ///< sample times, ascending; empty: `samples` equal intervals from 0 to duration
  int samples = 1000;
  Start start;
  double tolerance = 1e-8;
  bool once = false;  ///< a structure in one pass whose errors are not measured, with a tenth of the tolerance
  long most_steps = 5'000'000;                   ///< steps of one pass
  std::string solver = "auto";                   ///< one of solver_names()
  solvers::force_algorithms::Options algorithm;  ///< options of the force algorithms
  std::optional<Stepping> stepping = {};         ///< of structures, by steps of a given length in place of `solver`
  /// Called after each step with the completed part, 0 … 1, of the present pass.
  std::function<void(double part)> progress = {};
};

struct RunEvent {
  double time;
  std::string kind;                         ///< "stick", "slip", "reversal"; of stops as in MotionEvent
  double displacement, displacement_y = 0;  ///< m; displacement_y in the plane
  int contact = 0;                          ///< number of the contact in a structure with several, from 1; else 0
  int coordinate = 0;                       ///< of a stop: the number of its coordinate, from 1; else 0
  double speed = 0;                         ///< m/s, before an impact
  double error = infinity;                  ///< s, of the time, from the difference of two passes
};

struct Frames;

struct Run {
  Outcome outcome;
  std::vector<double> time;
  std::vector<std::string> column_names;  ///< displacement, velocity, slip_rate, friction_force,
                                          ///< friction_coefficient, then states, and of a mass its acceleration
  std::vector<std::string> column_units;
  std::vector<std::vector<double>> columns;  ///< [column][sample]
  std::vector<double> column_error;          ///< largest absolute difference to a run at a smaller tolerance
  std::vector<double> column_size;  ///< reference size of column_error, for a run at two tolerances; else empty
  std::vector<RunEvent> events;
  /// Of the whole motion: extremes of the columns from the dense output of the steps, whatever the samples are, stick
  /// time, works.
  std::map<std::string, double> metrics;
  std::map<std::string, double> metric_error;  ///< of those that have one: from the difference of two passes
  SlipEvents slips;
  std::shared_ptr<const Frames> oscillation = {};  ///< of a motion by steps, its last whole one (last_oscillation.hpp)
  std::string solver;                              ///< the solver used
  std::string why;                                 ///< reason for this solver; time of a handover to another
  std::string remark;                              ///< a remark on the motion; mostly empty
  struct Cost {
    long steps = 0, evaluations = 0;
  } cost;
};

/// The sample times of a run. \throws InputError for times that do not ascend from 0 or later.
std::vector<double> sample_times(const RunOptions&);

/// "auto", then the solvers by name.
std::vector<std::string> solver_names();

/// The slip rate, over the drive's speed, below which a law that creeps sticks (SlipEvents).
inline constexpr double usual_stick_threshold = 0.1;

/// \throws InputError for a start that does not fit the model or an unknown solver.
Run run(const Model&, const RunOptions&, double stick_threshold = usual_stick_threshold);

}  // namespace rosin::analysis::motion
