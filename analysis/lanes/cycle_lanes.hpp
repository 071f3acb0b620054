/// Periodic motion of many sliders at once: the accelerated return map in SIMD lanes, each cycle certified by a second,
/// tighter tolerance.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lanes/neighbours.hpp"
#include "analysis/lanes/passage_lanes.hpp"

namespace rosin::analysis::lanes {

using oscillators::Model;

/// The attracting cycle of one of many sliders.
struct LaneCycle {
  bool found = false;     ///< false: not served by lanes, or not settled; find_cycle() will say more
  bool dies_out = false;  ///< motion from stick, and from longer stick, settles on steady sliding, which attracts
  cycles::Metrics metrics, error;  ///< of the metrics asked for; NaN for others
  bool ill_conditioned_stick = false;
  long tries = 0;            ///< step attempts
  std::vector<double> near;  ///< not found, but it may lie near this point on the section; else empty
};

struct LaneCycleOptions {
  double tolerance = 1e-6;  ///< relative, of every metric asked for
  double stick_threshold = 0.1;
  std::vector<std::string> metrics;  ///< names; the period is always found
};
/// That ask for every metric there is.
LaneCycleOptions every_metric(double tolerance = 1e-6);

/// Cycles reached from stick, or from where neighbours expect them. Results do not depend on which sliders share the
/// lanes, only on what is in their own tile. `places`: one for each slider, or none. \throws InputError
/// for unknown metrics.
std::vector<LaneCycle> find_cycles(std::span<const Model>, const LaneCycleOptions&,
                                   std::span<const GridPlace> places = {});

/// Sliders that are looked for at one tolerance, with what is found once all of them are done.
struct CycleBatch {
  std::size_t label = 0;  ///< for the caller to know it by
  std::vector<Model> models = {};
  std::vector<GridPlace> places = {};  ///< one for each slider, or none
  double tolerance = 1e-6;             ///< relative, of every metric asked for
  std::vector<LaneCycle> cycles = {};
};

/// The same batch by batch: `finished` is called with each batch that is done, and may return one that follows from it.
/// Lanes that one batch leaves idle work on others, which must not share its tiles.
void find_cycles(std::vector<CycleBatch>, double stick_threshold, const std::vector<std::string>& metrics,
                 const std::function<std::optional<CycleBatch>(CycleBatch&)>& finished);

}  // namespace rosin::analysis::lanes
