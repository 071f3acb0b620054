/// The slip events of a run in stick–slip: when each begins, how long it lasts, and by how much force falls in it.
#pragma once
#include <vector>

namespace rosin::analysis::motion {

/// One entry for each event, contact after contact. Of an event that the motion begins or ends with, a part is missing:
/// it is left out. Under set-valued laws slip lasts from the event "slip" to the event "stick". A law that creeps
/// sticks while the slip rate is below `stick_threshold` · V, and slips, after that, while it is above V: the force of
/// a slider's spring then falls. Moments and peaks come from the dense output of the steps. None under a drive whose
/// speed is zero or varies, and where the slip rate is imposed.
struct SlipEvents {
  std::vector<double> contact;         ///< its number, from 1; empty where there is one
  std::vector<double> onset;           ///< s
  std::vector<double> duration;        ///< s
  std::vector<double> force_drop;      ///< N, fall of the force of a slider's spring; empty for structures
  std::vector<double> friction_drop;   ///< the same over the normal load at onset
  std::vector<double> slip;            ///< m, against the surface
  std::vector<double> peak_slip_rate;  ///< m/s
  std::vector<double> recurrence;      ///< s, from the contact's onset before; NaN of the first

  /// The largest absolute error of each column, from the differences of two passes; infinite where these have other
  /// events.
  struct Errors {
    double onset = 0, duration = 0, force_drop = 0, friction_drop = 0, slip = 0, peak_slip_rate = 0, recurrence = 0;
  } error;
};

}  // namespace rosin::analysis::motion
