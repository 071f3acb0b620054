/// The slip events of a run in stick–slip: when each begins, how long it lasts, and by how much force falls in it.
#pragma once
#include <vector>

#include "analysis/motion/run.hpp"

namespace rosin::analysis::motion {

/// One entry for each event. Of an event that the record begins or ends with, a part is missing: it is left out.
struct SlipEvents {
  std::vector<double> onset;           ///< s
  std::vector<double> duration;        ///< s
  std::vector<double> force_drop;      ///< N, fall of the spring's force
  std::vector<double> friction_drop;   ///< the same over the normal load at onset
  std::vector<double> slip;            ///< m, of the slider against the drive
  std::vector<double> peak_slip_rate;  ///< m/s, through the samples around the highest; NaN where there are none
  std::vector<double> recurrence;      ///< s, from the onset before; NaN of the first
  int fewest_samples = 0;              ///< of the record in an event

  /// The largest absolute error of each column: its change where only every second sample is looked at, and what the
  /// run states of its columns and of the times of its events. Infinite where half the samples show other events.
  struct Errors {
    double onset = 0, duration = 0, force_drop = 0, friction_drop = 0, slip = 0, peak_slip_rate = 0, recurrence = 0;
  } error;
};

/// Under set-valued laws slip lasts from the event "slip" to the event "stick". A law that creeps sticks while the slip
/// rate is below `stick_threshold` · V, and slips, after that, while it is above V: the spring's force then falls.
/// None under a drive whose speed is zero or varies, and where the slip rate is imposed.
SlipEvents slip_events(const Model&, const Run&, double stick_threshold = 0.1);

}  // namespace rosin::analysis::motion
