/// Slip events in a recorded force: falls that are larger than noise and last longer than spikes.
#pragma once
#include <optional>
#include <vector>

namespace rosin::analysis::inference {

struct SlipEvent {
  double onset, duration;  ///< s, from the highest force to the lowest
  double size;             ///< N, between them
};

/// What counts as an event; each is found where it is not given.
struct EventLimits {
  std::optional<double> least_drop = {};  ///< N that force falls, and rises before and behind
  std::optional<double> least_time = {};  ///< s that force stays above and below, which spikes do not
};

struct SlipEvents {
  std::vector<SlipEvent> events;
  double least_drop = 0, least_time = 0;  ///< that were taken
  double noise = 0;                       ///< N, standard deviation about the force without spikes and noise
  long spikes = 0;                        ///< samples that lie off it by more than 8 of these in less than least_time
  double same_from = 0, same_to = 0;      ///< N: any least_drop between them finds as many events
};

/// The events of a record (s, N). The rate of force is halved again and again, each number the median of five before,
/// so that noise shrinks and excursions of few samples vanish. Events at each such level are falls by more than a
/// threshold, between which force rises by as much. The number of events, 3 or more, is the one that most levels and
/// most thresholds between 1e-4 of the range and all of it agree on; with a given threshold, of those found at it.
/// Onset and size come from straight lines through the samples before and behind the fall. Events that the record
/// begins or ends with are left out.
SlipEvents find_slip_events(const std::vector<double>& time, const std::vector<double>& force, const EventLimits& = {});

}  // namespace rosin::analysis::inference
