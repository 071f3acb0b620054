/// What experiments share: records of runs, times that resolve a step, readings with errors, small reading methods.
#pragma once
#include <utility>

#include "analysis/lab/experiment.hpp"
#include "analysis/lab/machine.hpp"

namespace rosin::analysis::lab {

inline constexpr double standard_gravity = 9.80665;  ///< m/s²

/// An extreme of friction that a reading asks for: the highest or the lowest at begin <= t < end.
struct Sought {
  double begin, end;
  bool maximum;
};

/// A motion by the options of a run, and whether friction in it may jump at its events.
struct Motion {
  std::function<motion::Run(const motion::RunOptions&)> run;
  bool friction_may_jump;
};
/// That of a model, and that of a machine whose load point moves at `speed`.
Motion motion_of(Model);
Motion motion_of(const Machine&, Signal speed);

/// Runs the motion over the times and makes the result's record of it, with outcome and events. A run that ends short
/// leaves what it reached; one whose error exceeds the tolerance is taken with that error, and a warning. Extremes that
/// are sought may fall between samples: without a sensor the run is repeated with samples closer to them.
/// \throws NothingRecorded where that is less than two samples, of which nothing can be read.
void record_run(Result&, const Task&, const Motion&, const motion::Start&, const std::vector<double>& times,
                const std::vector<Sought>& = {});

/// The record of a memoryless law at an imposed slip rate (m/s, one for each time): nothing is integrated.
void record_curve(Result&, const Model&, const std::vector<double>& times, const std::vector<double>& slip_rates);

/// True where friction follows the slip rate at once: no states, or states in equilibrium.
bool memoryless(const Model&);

/// Appends times after `begin`, `count` of them even in the logarithm of the time since, one just before the end and
/// one at it, `begin + duration`.
void append_times(std::vector<double>& times, double begin, double duration, int count);

/// How far a drive whose speed jumps only at sample times has moved since the first, at each of them, m.
std::vector<double> driven_way(const std::vector<double>& time, const Signal& speed);

/// Extremes of the steady coefficient for slip rates in [low, high].
struct SteadyRange {
  double least, most;                      ///< ends included
  std::optional<double> minimum, maximum;  ///< the lowest and the highest within; a curve that is flat is its minimum
  double maximum_at;                       ///< slip rate of the maximum, m/s
};
SteadyRange steady_range(const FrictionLaw&, double normal_load, double low, double high);

/// Largest tangential over normal force that rest bears, of a set-valued law. State: default that of long rest.
std::optional<double> static_limit(const FrictionLaw&, double normal_load, std::span<const double> state = {});

/// The reader's numbers on the measured record, put into the result together with it. Errors: those of the true record,
/// which are its own, what every second sample alone would read (the odd or the even), and what the errors of columns
/// make of it; with a sensor also the rms deviation from the true reading over repeated measurements with other noise.
using Reader = std::function<std::vector<Reading>(const Record&)>;
void read_off(Result&, const Sensor&, const Reader&);

/// Samples [first, last) with begin <= t < end.
std::pair<std::size_t, std::size_t> between(const std::vector<double>& time, double begin, double end);
/// Mean of the last tenth of the samples' time in [begin, end).
double level(const std::vector<double>& time, const std::vector<double>& x, double begin, double end);
/// What such a level still is from the steady value that x tends to with time constant `settling`: transients that
/// decay by e in that time, and change x by so much in the last tenth, have no more left. All of that change where
/// nothing settles.
double unsettled(const std::vector<double>& time, const std::vector<double>& x, double begin, double end,
                 double settling);
/// Extreme of a column at begin <= t < end, a parabola through its sample and the two beside it; at an end the sample
/// as it is, and beside a break of the record a straight line up to it.
struct Extreme {
  double time, value;
};
Extreme extreme(const Record&, const std::vector<double>& x, const Sought&);
/// The straight line y = offset + slope·x by least squares, with standard errors.
struct Line {
  double offset, slope, slope_error;
};
Line fit_line(const std::vector<double>& x, const std::vector<double>& y);

/// Value of x at time t, linear between samples.
double at_time(const std::vector<double>& time, const std::vector<double>& x, double t);

}  // namespace rosin::analysis::lab
