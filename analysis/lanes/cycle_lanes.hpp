/// Periodic motion of many sliders at once: the fixed point of the return map, computed in SIMD lanes. A second,
/// tighter tolerance gives the errors of each cycle.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lanes/neighbours.hpp"
#include "analysis/lanes/return_lanes.hpp"

namespace rosin::analysis::lanes {

using oscillators::Model;

/// The attracting cycle of one of many sliders.
struct LaneCycle {
  bool found = false;  ///< false: lanes do not handle this slider, or its motion has not settled; find_cycle() decides
  bool dies_out = false;           ///< motion from stick, and from longer stick, settles on stable steady sliding
  cycles::Metrics metrics, error;  ///< the requested metrics; NaN for others
  bool ill_conditioned_stick = false;
  long tries = 0;            ///< step attempts
  std::vector<double> near;  ///< point on the section: of the cycle, or near which one may lie; empty: none known
};

struct LaneCycleOptions {
  double tolerance = 1e-6;  ///< relative, of every requested metric
  double stick_threshold = 0.1;
  std::vector<std::string> metrics;  ///< names; the period is always found
};
/// Options that request every metric.
LaneCycleOptions every_metric(double tolerance = 1e-6);

/// Cycles reached from stick, or from a start predicted by neighbours. Results do not depend on which sliders share the
/// lanes, only on the points of their own tile. `places`: one for each slider, or none. \throws InputError
/// for unknown metrics.
std::vector<LaneCycle> find_cycles(std::span<const Model>, const LaneCycleOptions&,
                                   std::span<const GridPlace> places = {});

/// The cycle of one slider, without its orbit and its multipliers. A lane finds loosely known ones in a fraction of the
/// time that cycles::find_cycle takes, which answers where tolerances are tight and where lanes do not serve.
/// Metrics that the options do not request are NaN, or known all the same. \throws InputError as cycles::find_cycle,
/// and for unknown metrics.
cycles::Cycle find_cycle(const Model&, const LaneCycleOptions&);

/// Sliders whose cycles are searched for at one tolerance, and the cycles once all are done.
struct CycleBatch {
  std::size_t label = 0;  ///< identifies the batch to the caller
  std::vector<Model> models = {};
  std::vector<GridPlace> places = {};  ///< one for each slider, or none
  double tolerance = 1e-6;             ///< relative, of every requested metric
  std::vector<LaneCycle> cycles = {};
};

/// The same batch by batch. `finished` receives each completed batch and may return another that follows from it. Lanes
/// that are idle in one batch work on others, which must not share its tiles.
void find_cycles(std::vector<CycleBatch>, double stick_threshold, const std::vector<std::string>& metrics,
                 const std::function<std::optional<CycleBatch>(CycleBatch&)>& finished);

}  // namespace rosin::analysis::lanes
