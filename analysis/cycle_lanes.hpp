/// Periodic motion of many sliders at once: the accelerated return map in SIMD lanes, each cycle certified by a second,
/// tighter tolerance.
#pragma once
#include <span>
#include <vector>

#include "analysis/cycle.hpp"
#include "analysis/neighbours.hpp"
#include "analysis/passage_lanes.hpp"

namespace rosin::analysis {

/// The attracting cycle of one of many sliders.
struct LaneCycle {
  bool found = false;      ///< false: not served by lanes, or not settled; find_cycle() will say more
  bool dies_out = false;   ///< motion from stick, and from longer stick, settles on steady sliding, which attracts
  Metrics metrics, error;  ///< of the metrics asked for; NaN for others
  bool ill_conditioned_stick = false;
  long tries = 0;            ///< step attempts
  std::vector<double> near;  ///< not found, but it may lie near this point on the section; else empty
};

struct LaneCycleOptions {
  double tolerance = 1e-6;  ///< relative, of every metric asked for
  double stick_threshold = 0.1;
  std::vector<std::string> metrics;  ///< names; the period is always found
};

/// Cycles reached from stick, or from where neighbours expect them. Results do not depend on which sliders share the
/// lanes, only on what is in their own tile. `places`: one for each slider, or none. \throws InputError
/// for unknown metrics.
std::vector<LaneCycle> find_cycles(std::span<const Model>, const LaneCycleOptions&,
                                   std::span<const GridPlace> places = {});

}  // namespace rosin::analysis
