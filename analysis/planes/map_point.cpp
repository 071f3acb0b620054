/// Judging and computing single points of a plane.
#include "analysis/planes/map_point.hpp"

#include <fmt/format.h>

#include <limits>

#include "analysis/steady/stability.hpp"

namespace rosin::analysis::planes {

PointVerdict judge(const Model& model, cycles::CoexistenceSearch& coexistence) {
  const auto unstable = [&] {
    if (const auto stable = steady::surely_stable(model)) return !*stable;
    const steady::Stability sliding = steady::stability(model);
    return !sliding.stable && !sliding.marginal;
  };
  if (unstable()) return PointVerdict::look_for_cycle;
  return coexistence.ask(model).answer == cycles::Coexistence::Answer::none ? PointVerdict::stable
                                                                            : PointVerdict::look_beside_steady;
}

MapPoint undecided_point() {
  MapPoint point;
  for (const auto& metric : cycles::metric_names())
    point.metrics.*metric.member = point.error.*metric.member = std::numeric_limits<double>::quiet_NaN();
  return point;
}

MapPoint stable_point() {
  MapPoint point = undecided_point();
  point.done = true;
  point.regime = Regime::stable;
  return point;
}

MapPoint failed_point(std::string why) {
  MapPoint point = stable_point();
  point.regime = Regime::failed;
  point.why = std::move(why);
  return point;
}

std::optional<MapPoint> point_of(const lanes::LaneCycle& cycle, bool attracts) {
  MapPoint point = stable_point();
  point.origin = Origin::computed;
  if (!cycle.found) return attracts && cycle.dies_out ? std::optional(point) : std::nullopt;
  point.regime = attracts ? Regime::bistable : Regime::cycle;
  point.metrics = cycle.metrics;
  point.error = cycle.error;
  return point;
}

MapPoint compute_point(const Model& model, double tolerance, double stick_threshold, bool attracts,
                       const std::vector<double>& near) {
  MapPoint point = stable_point();
  point.origin = Origin::computed;
  point.regime = Regime::failed;
  try {
    const cycles::Cycle cycle = cycles::find_cycle(
        model, {.tolerance = tolerance, .stick_threshold = stick_threshold, .multipliers = false, .near = near});
    if (cycle.metrics.period > 0 && cycle.stable) {
      point.regime = attracts ? Regime::bistable : Regime::cycle;
      point.metrics = cycle.metrics;
      point.error = cycle.error;
      if (!cycle.outcome.complete()) point.why = cycle.outcome.detail;  // found, less accurately than asked
    } else if (attracts && cycle.outcome.ending == Ending::none_exists) {
      point.regime = Regime::stable;
    } else if (cycle.metrics.period > 0) {
      point.why = fmt::format("the cycle found does not attract: of a change {:.6g} is left after a period",
                              cycle.multipliers.empty() ? infinity : std::abs(cycle.multipliers.front()));
    } else {
      point.why = fmt::format("{}: {}", name(cycle.outcome.ending), cycle.outcome.detail);
    }
  } catch (const InputError& e) {
    point.why = e.what();
  }
  return point;
}

}  // namespace rosin::analysis::planes
