/// Parameter planes: points decided by linear stability where that suffices, cycles elsewhere, threshold traced.
#include "analysis/planes/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>

#include "analysis/planes/adaptive_map.hpp"
#include "analysis/planes/borders.hpp"
#include "analysis/planes/forecast.hpp"
#include "analysis/planes/map_point.hpp"
#include "analysis/planes/parts.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::planes {

std::vector<PlaneMetric> metrics_of_slider(const std::vector<std::string>& names) {
  std::vector<PlaneMetric> metrics;
  for (const auto& wanted : names) {
    const auto& metric = cycles::find_metric(wanted);
    metrics.push_back({metric.name, metric.unit, metric.meaning, metric.member});
  }
  return metrics;
}

std::string name(Regime regime) {
  switch (regime) {
    case Regime::stable:
      return "stable";
    case Regime::cycle:
      return "cycle";
    case Regime::bistable:
      return "bistable";
    case Regime::failed:
      return "failed";
  }
  return "failed";
}

Axis make_axis(std::string parameter, double from, double to, int points, bool logarithmic,
               const std::vector<double>& extra) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("map axis '{}': {}", parameter, why));
  };
  if (points < 2) refuse(fmt::format("points = {} must be at least 2", points));
  if (!std::isfinite(from) || !std::isfinite(to)) refuse(fmt::format("from = {} and to = {} must be finite", from, to));
  if (from == to) refuse(fmt::format("from and to are both {}", from));
  if (logarithmic && !(from > 0 && to > 0))
    refuse(fmt::format("from = {} and to = {} must be positive on a logarithmic scale", from, to));
  Axis axis{std::move(parameter), {}, points, logarithmic};
  for (int i = 0; i < points; ++i) {
    const double w = double(i) / (points - 1);
    axis.values.push_back(i == 0            ? from
                          : i == points - 1 ? to
                          : logarithmic     ? from * std::pow(to / from, w)
                                            : from + (to - from) * w);
  }
  axis.values.insert(axis.values.end(), extra.begin(), extra.end());
  return axis;
}

namespace {

/// Every point by itself, in tiles: neighbours help each other to a start.
void compute_every_point(const Model& model, const MapOptions& options, cycles::CoexistenceSearch& coexistence,
                         const MapHooks& hooks, Map& map) {
  const std::size_t nx = options.x.values.size();
  const auto model_at = [&](std::size_t i) {
    return model.with(options.x.parameter, options.x.values[i % nx])
        .with(options.y.parameter, options.y.values[i / nx]);
  };
  const Partition tiles = partition_of(options, false);
  std::optional<Forecast> forecast;
  const auto expected = [&](std::size_t tile) {
    double work = 0;
    tiles.for_each(tile, [&](std::size_t i, int column, int row) {
      constexpr int every = 4;  // point along both axes is judged
      if (column % every != 0 || row % every != 0) return;
      work += Forecast::judging;
      try {
        if (judge(model_at(i), coexistence) != PointVerdict::stable)
          work += forecast->attempts_at(int(i % nx), int(i / nx));
      } catch (const InputError&) {  // it will be said of the point
      }
    });
    return work;
  };
  Expectation expectation;
  if (hooks.progress) {
    forecast.emplace(model, options, options.tolerance, options.metrics, coexistence);
    expectation.attempts = expected;
    expectation.usual = 7;  // a sixteenth of the points is foretold, and most start beside others
  }
  constexpr int coarsest_stride = 8;  // of points that start from stick
  const lanes::LaneCycleOptions lane_options{options.tolerance, options.stick_threshold, options.metrics};
  compute_parts(tiles, expectation, options, hooks, map, [&](const std::vector<std::size_t>& group, Desk& desk) {
    std::vector<Model> models;
    std::vector<lanes::GridPlace> places;
    std::deque<lanes::Tile> known;
    std::vector<std::size_t> indices, parts;
    std::vector<bool> attracted;  // by steady sliding, beside the cycle
    FinishedPoints finished;
    for (const std::size_t part : group) {
      lanes::Tile& tile = known.emplace_back();
      const auto [columns, rows] = tiles.size(part);
      // The far edges belong to the first grid too, so that nothing is told from one side alone.
      const auto phase_at = [columns, rows](int column, int row) {
        return lanes::phase_of(column == columns - 1 ? 0 : column, row == rows - 1 ? 0 : row, coarsest_stride);
      };
      tiles.for_each(part, [&](std::size_t i, int column, int row) {
        try {
          Model here = model_at(i);
          const PointVerdict verdict = judge(here, coexistence);
          if (verdict == PointVerdict::stable) return void(finished.emplace_back(i, stable_point()));
          models.push_back(std::move(here));
          places.push_back({&tile, column, row, phase_at(column, row)});
          indices.push_back(i), parts.push_back(part);
          attracted.push_back(verdict == PointVerdict::look_beside_steady);
        } catch (const InputError& e) {
          finished.emplace_back(i, failed_point(e.what()));
        }
      });
    }
    desk.points(finished);
    const auto cycles = lanes::find_cycles(models, lane_options, places);
    for (std::size_t k = 0; k < cycles.size(); ++k) desk.work(parts[k], Forecast::attempts_of(cycles[k]));
    desk.points(finished);
    for (std::size_t k = 0; k < cycles.size(); ++k) {
      const std::size_t i = indices[k];
      // Known from before: only its neighbours needed it again.
      if (i < map.points.size() && map.points[i].done) continue;
      if (const auto point = point_of(cycles[k], attracted[k])) {
        finished.emplace_back(i, *point);
      } else {
        desk.points(finished);  // by itself a point takes long
        finished.emplace_back(
            i, compute_point(models[k], options.tolerance, options.stick_threshold, attracted[k], cycles[k].near));
      }
    }
    desk.points(finished);
  });
}

constexpr std::string_view load_path = "drive.normal_load";
constexpr double fold_tolerance = 1e-6;  ///< decades of load

const Axis* load_axis(const Map& map) {
  return map.x.parameter == load_path ? &map.x : map.y.parameter == load_path ? &map.y : nullptr;
}

/// The folds of cycles along the axis beside that of the load.
cycles::FoldLine trace_folds_of(const Model& model, const Axis& along) {
  constexpr int samples = 49;  // stretches narrower than their distance may be missed
  return cycles::trace_folds(model, along.parameter, along.values[0], along.values[along.regular - 1],
                             along.logarithmic, samples, fold_tolerance * std::numbers::ln10);
}

/// The folds as lines, as far as they lie within the plane.
void draw_folds(const Model& model, const cycles::FoldLine& folds, const Axis& load, const Axis& along, Map& map) {
  constexpr int vertices = 65;
  const auto [low, high] = std::minmax(load.values[0], load.values[load.regular - 1]);
  for (const auto& stretch : folds.stretches) {
    map.fold_error = std::max(map.fold_error, stretch.error / std::numbers::ln10);
    bool begun = false;
    for (int i = 0; i < vertices; ++i) {
      const double w = stretch.begin + (stretch.end - stretch.begin) * i / (vertices - 1);
      const double value = folds.logarithmic ? std::exp(w) : w;
      const Model here = model.with(along.parameter, value);
      const auto closed = steady::critical_load(here);
      const auto border = closed ? std::nullopt : cycles::border_in_load(here);
      const double hopf = closed ? closed->normal_load : border ? border->value : 0;
      const double N = hopf * std::exp(stretch.log_ratio(w));
      if (!(N >= low && N <= high)) {
        begun = false;
        continue;
      }
      if (!begun && !map.fold.x.empty())
        for (auto* list : {&map.fold.x, &map.fold.y}) list->push_back(std::numeric_limits<double>::quiet_NaN());
      begun = true;
      map.fold.x.push_back(&load == &map.x ? N : value);
      map.fold.y.push_back(&load == &map.x ? value : N);
    }
  }
}

void compute(const Model& model, const MapOptions& options, const MapHooks& hooks, Map& map) {
  map.x = options.x;
  map.y = options.y;
  if (map.x.parameter == map.y.parameter) throw InputError(fmt::format("both map axes are '{}'", map.x.parameter));
  map.metrics = metrics_of_slider(options.metrics);
  if (!model.drive.constant())
    throw InputError(
        "a map is computed under a constant drive, but drive.speed, drive.normal_load or drive.force varies");
  for (const Axis* axis : {&map.x, &map.y})
    for (const double v : axis->values) (void)model.with(axis->parameter, v);  // refuses values out of range
  require(options.threads, {1, 4096}, "threads", "number of threads", "1");

  const bool leads = !hooks.crew || hooks.crew->leads();
  if (leads) map.points.resize(map.x.values.size() * map.y.values.size());
  std::optional<cycles::CoexistenceSearch> coexistence;
  if (const Axis* load = load_axis(map)) {
    const Axis& along = load == &map.x ? map.y : map.x;
    cycles::FoldLine folds = trace_folds_of(model, along);
    for (const auto& problem : folds.problems) map.notes.push_back(problem);
    draw_folds(model, folds, *load, along, map);
    coexistence.emplace(along.parameter, std::move(folds));
  } else {
    coexistence.emplace();
  }
  const bool adaptive = interpolates(options);
  if (adaptive)
    compute_adaptively(model, options, *coexistence, hooks, map);
  else
    compute_every_point(model, options, *coexistence, hooks, map);
  if (!leads || options.share.count > 1) return;
  std::vector<Side> sides;
  std::size_t failed = 0;
  for (const auto& point : map.points) {
    (point.origin == Origin::computed       ? map.integrated
     : point.origin == Origin::interpolated ? map.interpolated
                                            : map.skipped) += 1;
    failed += point.regime == Regime::failed;
    sides.push_back(point.regime == Regime::failed  ? Side::unknown
                    : point.regime == Regime::cycle ? Side::unstable
                                                    : Side::stable);
  }
  map.threshold = threshold_of_sliding(model, map.x, map.y, sides);
  map.notes.push_back(fmt::format(
      "{} of {} points were decided without integration: steady sliding is stable there and no cycle can coexist, "
      "because the border in normal load is supercritical, or the load lies below the fold of cycles, or friction "
      "strengthens everywhere",
      map.skipped, map.points.size()));
  if (adaptive)
    map.notes.push_back(fmt::format(
        "{} of {} points were interpolated between computed ones, in patches refined until held-out points, and the "
        "errors of the nodes, left no metric an error above the tolerance; --exact computes every point",
        map.interpolated, map.points.size()));
  if (failed > 0)
    map.outcome = {Ending::budget_spent, fmt::format("{} of {} points failed", failed, map.points.size())};
}

}  // namespace

Map compute_map(const Model& model, const MapOptions& options, const MapHooks& hooks) {
  Map map;
  try {
    compute(model, options, hooks, map);
  } catch (const Stopped&) {
    map.outcome = {
        Ending::interrupted,
        fmt::format("{} of {} points are done", std::ranges::count_if(map.points, &MapPoint::done), map.points.size())};
  }
  return map;
}

}  // namespace rosin::analysis::planes
