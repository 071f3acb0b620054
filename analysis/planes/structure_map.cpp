/// Points of a structure's plane, shared out to threads.
#include "analysis/planes/structure_map.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/cycles/irregular_motion.hpp"
#include "analysis/cycles/lyapunov.hpp"
#include "analysis/cycles/stepped_cycle.hpp"
#include "analysis/cycles/stepped_exponent.hpp"
#include "analysis/lanes/driven_exponents.hpp"
#include "analysis/planes/map_point.hpp"
#include "analysis/planes/parts.hpp"
#include "analysis/steady/structure_hopf.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::planes {

namespace {

/// Of steady sliding, which take no integration.
constexpr const char *growth_rate = "growth_rate", *unstable_modes = "unstable_modes", *criticality = "criticality",
                     *probability_unstable = "probability_unstable";
constexpr const char *largest_multiplier = "largest_multiplier", *returns = "returns", *lyapunov = "lyapunov";

}  // namespace

bool is_of_sliding(std::string_view name) {
  return name == growth_rate || name == unstable_modes || name == criticality || name == probability_unstable;
}

namespace {

using KnownMeasures = std::map<std::string, cycles::StructureCycle::Measure>;

/// Those of the cycle whatever the oscillator, and the names among them.
std::vector<PlaneMetric> metrics_among(KnownMeasures known, const std::vector<std::string>& names) {
  known[returns] = {NAN, NAN, "1", "returns of the section in a period"};
  known[lyapunov] = {NAN, NAN, "1/s", "largest Lyapunov exponent"};
  std::vector<std::string> all;
  for (const auto& [name, measure] : known) all.push_back(name);
  std::vector<PlaneMetric> metrics;
  for (const auto& name : names) {
    const auto found = known.find(name);
    if (found == known.end()) {
      const auto near = nearest_name(name, all);
      throw InputError(fmt::format(
          "'{}' is no metric of this structure{}", name,
          near.empty() ? fmt::format("; it has {}", fmt::join(all, ", ")) : fmt::format("; did you mean '{}'?", near)));
    }
    metrics.push_back({name, found->second.unit, found->second.meaning, nullptr, metrics.size()});
  }
  return metrics;
}

/// Values go by the names of metrics, where these are asked.
auto setter_of(MapPoint& point, const std::vector<PlaneMetric>& metrics) {
  return [&point, &metrics](std::string_view name, double value, double error) {
    for (const auto& metric : metrics)
      if (metric.name == name) metric.value(point) = value, metric.error(point) = error;
  };
}

bool is_asked(const std::vector<PlaneMetric>& metrics, std::string_view name) {
  return std::ranges::any_of(metrics, [&](const auto& metric) { return metric.name == name; });
}

MapPoint blank_point(const std::vector<PlaneMetric>& metrics) {
  auto blank = undecided_point();
  blank.measures.assign(metrics.size(), NAN), blank.measure_errors.assign(metrics.size(), NAN);
  return blank;
}

}  // namespace

std::vector<PlaneMetric> metrics_of_structure(const oscillators::Structure& structure,
                                              const std::vector<std::string>& names) {
  auto known = cycles::cycle_metrics_of(structure);
  known[growth_rate] = {NAN, NAN, "1/s", "largest growth rate of steady sliding"};
  known[unstable_modes] = {NAN, NAN, "1", "unstable modes of steady sliding"};
  known[criticality] = {NAN, NAN, "1", "criticality of the nearest Hopf point"};
  known[probability_unstable] = {NAN, NAN, "1", "share of draws in which steady sliding is unstable"};
  known[largest_multiplier] = {NAN, NAN, "1", "modulus of the largest multiplier of the cycle"};
  return metrics_among(std::move(known), names);
}

std::vector<PlaneMetric> metrics_of_stepped(const motion::SteppedOscillator& oscillator,
                                            const std::vector<std::string>& names) {
  return metrics_among(cycles::cycle_metrics_of(oscillator), names);
}

MapPoint compute_structure_point(const motion::StructureModel& model, double tolerance,
                                 const std::vector<PlaneMetric>& metrics, const cycles::LyapunovOptions& exponents,
                                 double stick_threshold, std::vector<double>* end, const Draws& draws) {
  MapPoint point = blank_point(metrics);
  const auto set = setter_of(point, metrics);
  const bool driven = common_period(model.structure) > 0;
  const bool slides =
      std::ranges::all_of(model.structure.contacts, [](const auto& contact) { return contact.speed.level() != 0; });
  bool stable = false;
  if (slides) {
    const auto sliding = steady::stability(model.structure);
    stable = sliding.stable || sliding.marginal;
    set(growth_rate, sliding.modes.front().growth_rate(), sliding.modes.front().error);
    set(unstable_modes, sliding.unstable_modes(), 0);
    const auto oscillates = [](const auto& mode) { return mode.eigenvalue.imag() > 0; };
    const auto leading = std::ranges::find_if(sliding.modes, oscillates);
    if (is_asked(metrics, criticality) && leading != sliding.modes.end())
      if (const auto form = steady::normal_form(model.structure, leading->eigenvalue))
        set(criticality, form->value, form->error);
    if (is_asked(metrics, probability_unstable) && draws.count > 0) {
      int unstable = 0;
      for (int draw = 0; draw < draws.count; ++draw) {
        end_if_stopped();
        unstable += steady::stability(draws.structure(draw)).unstable_modes() > 0;
      }
      const double share = double(unstable) / draws.count;
      set(probability_unstable, share, error_of_share(share, draws.count));
    }
  }
  point.done = true;
  if (std::ranges::all_of(metrics, [](const auto& metric) { return is_of_sliding(metric.name); })) {
    point.regime = stable ? Regime::stable : Regime::cycle;
    return point;
  }
  std::optional<cycles::LyapunovSpectrum> spectrum;
  cycles::StructureCycle cycle;
  if (is_asked(metrics, lyapunov)) {
    auto how = exponents;
    how.accuracy = tolerance, how.stick_threshold = stick_threshold;
    spectrum = cycles::lyapunov_spectrum(model, how);
    cycle = spectrum->cycle;
  } else {
    cycles::StructureCycleOptions how;
    how.tolerance = tolerance, how.stick_threshold = stick_threshold;
    cycle = cycles::find_cycle(model, how);
  }
  end_if_stopped();  // a part of an average is no value of the plane
  if (end) *end = cycle.start;
  point.origin = Origin::computed;
  if (cycle.returns > 0) {
    point.regime = stable && !driven ? Regime::bistable : Regime::cycle;
    for (const auto& [name, measure] : cycle.metrics) set(name, measure.value, measure.error);
    set(returns, cycle.returns, 0);
    if (!cycle.multipliers.empty())
      set(largest_multiplier, std::abs(cycle.multipliers.front()), cycle.multiplier_errors.front());
  }
  if (!cycle.outcome.complete()) {
    point.regime = cycle.outcome.ending == Ending::none_exists && !driven ? Regime::stable : Regime::failed;
    point.why = fmt::format("{}: {}", name(cycle.outcome.ending), cycle.outcome.detail);
  }
  if (spectrum && spectrum->outcome.complete()) {
    const auto telling = std::ranges::find_if(spectrum->exponents, [](const auto& e) { return !e.trivial; });
    if (telling != spectrum->exponents.end() && std::isfinite(telling->value))
      set(lyapunov, telling->value, telling->error);
    if (spectrum->from == "average") point.regime = stable && !driven ? Regime::bistable : Regime::cycle;
  }
  return point;
}

MapPoint compute_stepped_point(const motion::SteppedOscillator& oscillator, double tolerance,
                               const std::vector<PlaneMetric>& metrics, const cycles::LyapunovOptions& exponents,
                               std::vector<double>* end) {
  MapPoint point = blank_point(metrics);
  const auto set = setter_of(point, metrics);
  cycles::StructureCycleOptions how;
  how.tolerance = tolerance;
  const auto cycle = cycles::find_cycle(oscillator, how);
  if (end) *end = cycle.start;
  point.done = true, point.origin = Origin::computed;
  if (cycle.returns > 0) {
    point.regime = Regime::cycle;
    for (const auto& [name, measure] : cycle.metrics) set(name, measure.value, measure.error);
    set(returns, cycle.returns, 0);
  }
  if (!cycle.outcome.complete()) {
    const bool stands = cycle.settled == cycles::Settled::sliding || cycle.settled == cycles::Settled::rest;
    point.regime = stands ? Regime::stable : Regime::failed;
    point.why = fmt::format("{}: {}", name(cycle.outcome.ending), cycle.outcome.detail);
  }
  if (!is_asked(metrics, lyapunov)) return point;
  auto average = exponents;
  average.accuracy = tolerance;
  const auto spectrum = cycles::lyapunov_spectrum(oscillator, average);
  end_if_stopped();  // a part of an average is no value of the plane
  if (!spectrum.exponents.empty() && std::isfinite(spectrum.exponents.front().value))
    set(lyapunov, spectrum.exponents.front().value, spectrum.exponents.front().error);
  if (spectrum.outcome.complete() && point.regime == Regime::failed) point.regime = Regime::cycle;
  return point;
}

namespace {
/// A forced block that lanes have followed.
MapPoint point_of(const lanes::DrivenExponent& exponent, MapPoint point, const std::vector<PlaneMetric>& metrics) {
  point.done = true, point.regime = Regime::cycle, point.origin = Origin::computed;
  for (const auto& metric : metrics) {
    if (metric.name == lyapunov) metric.value(point) = exponent.value, metric.error(point) = exponent.error;
    if (metric.name == returns && exponent.returns > 0) metric.value(point) = exponent.returns, metric.error(point) = 0;
  }
  return point;
}

/// Points of some places that are computed together, as far as they are.
using PointsAhead = std::function<std::vector<std::optional<MapPoint>>(const std::vector<std::size_t>&)>;

/// The points of a plane, each computed by itself where it was not computed ahead with others of its part.
Map compute_points(const MapOptions& options, const std::vector<PlaneMetric>& metrics, const MapHooks& hooks,
                   const Partition& partition, const std::function<MapPoint(double x, double y)>& compute,
                   const PointsAhead& ahead) {
  require(options.threads, {1, 4096}, "threads", "number of threads", "1");
  Map map;
  map.x = options.x, map.y = options.y, map.metrics = metrics;
  const std::size_t width = map.x.values.size(), total = width * map.y.values.size();
  const bool leads = !hooks.crew || hooks.crew->leads();
  if (leads) map.points.assign(total, blank_point(metrics));
  try {
    compute_parts(partition, {}, options, hooks, map, [&](const std::vector<std::size_t>& parts, Desk& desk) {
      std::vector<std::size_t> places, part_of;
      for (const std::size_t part : parts)
        partition.for_each(part, [&](std::size_t i, int, int) { places.push_back(i), part_of.push_back(part); });
      std::vector<std::optional<MapPoint>> known(places.size());
      if (ahead) known = ahead(places);
      for (std::size_t k = 0; k < places.size(); ++k) {
        end_if_stopped();
        const std::size_t i = places[k];
        MapPoint point = blank_point(metrics);
        try {
          point = known[k] ? std::move(*known[k]) : compute(map.x.values[i % width], map.y.values[i / width]);
        } catch (const InputError& error) {
          point.done = true, point.regime = Regime::failed, point.why = error.what();
        }
        FinishedPoints finished;
        finished.emplace_back(i, std::move(point));
        desk.work(part_of[k], 1);
        desk.points(finished);
      }
    });
  } catch (const Stopped&) {
    map.outcome = {Ending::interrupted,
                   fmt::format("{} of {} points are done", std::ranges::count_if(map.points, &MapPoint::done), total)};
    return map;
  }
  if (!leads || options.share.count > 1) return map;
  for (const auto& point : map.points) (point.origin == Origin::computed ? map.integrated : map.skipped) += 1;
  if (std::ranges::all_of(map.points, [](const auto& p) { return p.regime == Regime::failed; }))
    map.outcome = {Ending::none_exists, "every point failed; the first: " + map.points.front().why};
  return map;
}
}  // namespace

Map compute_structure_map(const StructureFamily& family, const MapOptions& options,
                          const std::vector<PlaneMetric>& metrics, const MapHooks& hooks, const DrawnFamily& drawn) {
  const std::size_t width = options.x.values.size();
  const auto model_at = [&](std::size_t i) { return family(options.x.values[i % width], options.y.values[i / width]); };
  const bool only_exponents = std::ranges::all_of(
      metrics, [](const auto& metric) { return metric.name == lyapunov || metric.name == returns; });
  const auto first_is_served = [&] {
    try {
      return lanes::serves_exponents(model_at(0), options.lyapunov);
    } catch (const InputError&) {
      return false;  // told where the point is computed
    }
  };
  const bool in_lanes = only_exponents && options.lyapunov.duration > 0 && first_is_served();
  auto exponents = options.lyapunov;
  exponents.accuracy = options.tolerance;
  PointsAhead ahead;
  if (in_lanes)
    ahead = [&](const std::vector<std::size_t>& places) {
      std::vector<std::optional<MapPoint>> known(places.size());
      std::vector<motion::StructureModel> models;
      std::vector<std::size_t> place_of;
      for (std::size_t k = 0; k < places.size(); ++k) try {
          models.push_back(model_at(places[k]));
          place_of.push_back(k);
        } catch (const InputError&) {
          continue;  // told where the point is computed by itself
        }
      const auto found = lanes::driven_exponents(models, exponents);
      for (std::size_t m = 0; m < models.size(); ++m)
        if (found[m]) known[place_of[m]] = point_of(*found[m], blank_point(metrics), metrics);
      return known;
    };
  return compute_points(
      options, metrics, hooks, partition_of(options, true, in_lanes),
      [&](double x, double y) {
        return compute_structure_point(family(x, y), options.tolerance, metrics, options.lyapunov,
                                       options.stick_threshold, nullptr, drawn ? drawn(x, y) : Draws{});
      },
      ahead);
}

Map compute_stepped_map(const SteppedFamily& family, const MapOptions& options, const std::vector<PlaneMetric>& metrics,
                        const MapHooks& hooks) {
  return compute_points(options, metrics, hooks, partition_of(options, true),
                        [&](double x, double y) {
                          return compute_stepped_point(family(x, y), options.tolerance, metrics, options.lyapunov);
                        },
                        {});
}

std::string motion_of(const MapPoint& point, const std::vector<PlaneMetric>& metrics, double mean_return) {
  double period = NAN;
  std::optional<cycles::Exponent> exponent;
  for (const auto& metric : metrics) {
    if (metric.name == returns) period = metric.value(point);
    if (metric.name == lyapunov && std::isfinite(metric.value(point)))
      exponent = {metric.value(point), metric.error(point)};
  }
  if (std::isfinite(period)) return fmt::format("period {}", std::lround(period));
  if (point.regime == Regime::stable) return "steady";
  if (!exponent) return "";
  return exponent->value < 0 && !exponent->is_zero() ? "periodic" : cycles::regime_of(*exponent, mean_return);
}

}  // namespace rosin::analysis::planes
