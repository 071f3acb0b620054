/// Periodic motion of an oscillator that is followed by steps: what it comes to, and what its periods show.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/stepped_oscillator.hpp"

namespace rosin::analysis::cycles {

/// Where a motion ended that is not periodic.
enum class Settled : std::uint8_t {
  no,
  sliding,  ///< steady sliding
  rest,     ///< all sticks for good
  escape    ///< it grows without bound
};

struct SteppedCycle : StructureCycle {
  Settled settled = Settled::no;
  double start_time = 0;  ///< s, of the state `start`, in the phase of the drive
};

/// The metrics of such periods by name: "period"; of each channel "…_max", "…_min", "…_mean" and "…_amplitude"; of
/// parts their mean, and of rates their integral.
std::map<std::string, StructureCycle::Measure> cycle_metrics_of(const motion::SteppedOscillator&);

/// The motion is followed from its start until it recurs after some returns, and again with finer steps. The errors of
/// metrics are twice the difference of the two, the scatter of the last periods, and what the approach to the period
/// leaves. There are no multipliers: the rate of approach is the exponent of lyapunov_spectrum().
/// A motion whose periods stay different, as those about a neutral cycle, ends "tolerance not met" with their scatter.
/// \param errors  false: what finer steps would change is not asked, and errors are too small by that
SteppedCycle find_cycle(const motion::SteppedOscillator&, const StructureCycleOptions&, bool errors = true);

}  // namespace rosin::analysis::cycles
