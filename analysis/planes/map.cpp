/// Parameter planes: points decided by linear stability where that suffices, cycles elsewhere, threshold traced.
#include "analysis/planes/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <mutex>
#include <numbers>
#include <optional>

#include "analysis/planes/adaptive_map.hpp"
#include "analysis/planes/borders.hpp"
#include "analysis/planes/forecast.hpp"
#include "analysis/planes/map_jobs.hpp"
#include "analysis/planes/map_point.hpp"

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

/// The plane in tiles: what is computed together, so that neighbours help each other to a start.
class Tiles {
 public:
  static constexpr int edge = 32;  ///< most points of a tile along one axis
  Tiles(const Axis& x, const Axis& y) : columns_(cut(x)), rows_(cut(y)), width_(x.values.size()) {}
  int count() const { return int(columns_.size() * rows_.size()); }
  /// Columns and rows of a tile.
  std::array<int, 2> size(int tile) const {
    const auto [x0, x1] = columns_[tile % columns_.size()];
    const auto [y0, y1] = rows_[tile / columns_.size()];
    return {x1 - x0, y1 - y0};
  }
  /// Calls f(index of the point, column, row) for each point of a tile.
  template <class F>
  void for_each(int tile, F f) const {
    const auto [x0, x1] = columns_[tile % columns_.size()];
    const auto [y0, y1] = rows_[tile / columns_.size()];
    for (int iy = y0; iy < y1; ++iy)
      for (int ix = x0; ix < x1; ++ix) f(std::size_t(iy) * width_ + ix, ix - x0, iy - y0);
  }

 private:
  /// Even pieces of the regular scale, then each extra value by itself.
  static std::vector<std::pair<int, int>> cut(const Axis& axis) {
    std::vector<std::pair<int, int>> pieces;
    const int n = axis.regular, parts = (n + edge - 1) / edge;
    for (int k = 0; k < parts; ++k) pieces.emplace_back(n * k / parts, n * (k + 1) / parts);
    for (int i = n; i < int(axis.values.size()); ++i) pieces.emplace_back(i, i + 1);
    return pieces;
  }
  std::vector<std::pair<int, int>> columns_, rows_;
  std::size_t width_;
};

/// What comes out of the workers: points, taken over in the order in which they are finished.
class Collected {
 public:
  Collected(Map& map, const MapHooks& hooks) : map_(map), hooks_(hooks) {
    for (std::size_t i = 0; i < map.points.size(); ++i)
      if (const MapPoint* known = hooks.known ? hooks.known(i) : nullptr) {
        map.points[i] = *known;
        ++done_;
      }
  }
  /// `done`: as a part of all work; 0: not known.
  void finish(std::vector<std::pair<std::size_t, MapPoint>>& found, double done) {
    std::vector<std::size_t> fresh;
    const std::scoped_lock lock(mutex_);
    for (auto& [i, point] : found) {
      if (map_.points[i].done) continue;  // known from before
      map_.points[i] = std::move(point);
      fresh.push_back(i);
    }
    found.clear();
    done_ += fresh.size();
    if (hooks_.finished && !fresh.empty()) hooks_.finished(fresh, map_.points);
    work_ = std::max(work_, done);
    if (hooks_.progress) hooks_.progress({done_, map_.points.size(), work_});
  }

 private:
  Map& map_;
  const MapHooks& hooks_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  double work_ = 0;
};

/// Every point by itself, in tiles. Work is weighed beforehand if `foretell`.
void compute_every_point(const Model& model, const MapOptions& options, cycles::CoexistenceSearch& coexistence,
                         const Map& map, bool foretell, const std::function<void(FinishedPoints&, double)>& finish) {
  const std::size_t nx = options.x.values.size();
  const auto model_at = [&](std::size_t i) {
    return model.with(options.x.parameter, options.x.values[i % nx])
        .with(options.y.parameter, options.y.values[i / nx]);
  };
  // Tiles are independent of each other, so that neither threads nor an interruption show in the result. Several at a
  // time keep the lanes full.
  const Tiles tiles(options.x, options.y);
  std::vector<Job<int>> open;
  for (int tile = 0; tile < tiles.count(); ++tile) {
    bool missing = false;
    tiles.for_each(tile, [&](std::size_t i, int, int) { missing |= !map.points[i].done; });
    if (missing) open.push_back({tile});
  }
  if (foretell) {
    const Forecast forecast(model, options, options.tolerance, options.metrics, coexistence);
    in_parallel(options.threads, open.size(), [&](std::size_t k) {
      open[k].expected = 0;
      tiles.for_each(open[k].what, [&](std::size_t i, int column, int row) {
        constexpr int every = 4;  // point along both axes is judged
        if (column % every != 0 || row % every != 0) return;
        open[k].expected += Forecast::judging;
        try {
          if (judge(model_at(i), coexistence) != PointVerdict::stable)
            open[k].expected += forecast.attempts_at(int(i % nx), int(i / nx));
        } catch (const InputError&) {  // it will be said of the point
        }
      });
    });
  }
  const std::size_t together = std::clamp<std::size_t>(open.size() / options.threads, 1, 4);
  constexpr int coarsest_stride = 8;  // of points that start from stick
  constexpr double usual = 7;         // a sixteenth of the points is foretold, and most start beside others
  const lanes::LaneCycleOptions lane_options{options.tolerance, options.stick_threshold, options.metrics};
  work_in_groups(
      open, together, options.threads, usual, finish,
      [&](const std::vector<const Job<int>*>& group, const auto& advanced) {
        std::vector<Model> models;
        std::vector<lanes::GridPlace> places;
        std::deque<lanes::Tile> known;
        std::vector<std::size_t> indices;
        std::vector<bool> attracted;  // by steady sliding, beside the cycle
        FinishedPoints finished;
        for (const auto* job : group) {
          lanes::Tile& tile = known.emplace_back();
          const auto [columns, rows] = tiles.size(job->what);
          // The far edges belong to the first grid too, so that nothing is told from one side alone.
          const auto phase_at = [&](int column, int row) {
            return lanes::phase_of(column == columns - 1 ? 0 : column, row == rows - 1 ? 0 : row, coarsest_stride);
          };
          tiles.for_each(job->what, [&](std::size_t i, int column, int row) {
            try {
              Model here = model_at(i);
              const PointVerdict verdict = judge(here, coexistence);
              if (verdict == PointVerdict::stable) return void(finished.emplace_back(i, stable_point()));
              models.push_back(std::move(here));
              places.push_back({&tile, column, row, phase_at(column, row)});
              indices.push_back(i);
              attracted.push_back(verdict == PointVerdict::look_beside_steady);
            } catch (const InputError& e) {
              finished.emplace_back(i, failed_point(e.what()));
            }
          });
        }
        finish(finished, 0);
        const auto cycles = lanes::find_cycles(models, lane_options, places);
        double attempts = 0;
        for (const auto& cycle : cycles) attempts += Forecast::attempts_of(cycle);
        advanced(attempts);
        for (std::size_t k = 0; k < cycles.size(); ++k) {
          if (map.points[indices[k]].done) continue;  // known from before: only its neighbours needed it again
          if (const auto point = point_of(cycles[k], attracted[k])) {
            finished.emplace_back(indices[k], *point);
          } else {
            finish(finished, 0);  // by itself a point takes long
            finished.emplace_back(indices[k], compute_point(models[k], options.tolerance, options.stick_threshold,
                                                            attracted[k], cycles[k].near));
          }
        }
        return finished;
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

  map.points.resize(map.x.values.size() * map.y.values.size());
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
  Collected collected(map, hooks);
  const auto finish = [&](FinishedPoints& found, double work) { collected.finish(found, work); };
  const bool adaptive = interpolates(options), foretell = bool(hooks.progress);
  if (adaptive)
    compute_adaptively(model, options, *coexistence, map.points, foretell, finish);
  else
    compute_every_point(model, options, *coexistence, map, foretell, finish);
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
