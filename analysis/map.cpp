/// Parameter planes: points decided by linear stability where that suffices, cycles elsewhere, threshold traced.
#include "analysis/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>

#include "analysis/coexistence.hpp"
#include "analysis/cycle_lanes.hpp"
#include "analysis/stability.hpp"

namespace rosin::analysis {

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

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

Metrics no_metrics() {
  Metrics m;
  for (const auto& metric : metric_names()) m.*metric.member = nothing;
  return m;
}

/// What linear stability and the folds of cycles say of a point before any integration.
enum class Verdict { stable, look_for_cycle, look_beside_steady };
Verdict judge(const Model& model, CoexistenceSearch& coexistence) {
  const Stability sliding = stability(model);
  if (!sliding.stable && !sliding.marginal) return Verdict::look_for_cycle;
  return coexistence.ask(model).answer == Coexistence::Answer::none ? Verdict::stable : Verdict::look_beside_steady;
}

MapPoint stable_point() {
  MapPoint point;
  point.done = true;
  point.regime = Regime::stable;
  point.metrics = point.error = no_metrics();
  return point;
}

/// A point by itself, at the full order of the collocation.
MapPoint compute_point(const Model& model, const MapOptions& options, bool attracts) {
  MapPoint point = stable_point();
  point.integrated = true;
  point.regime = Regime::failed;
  try {
    const Cycle cycle = find_cycle(
        model, {.tolerance = options.tolerance, .stick_threshold = options.stick_threshold, .multipliers = false});
    if (cycle.metrics.period > 0 && cycle.stable) {
      point.regime = attracts ? Regime::bistable : Regime::cycle;
      point.metrics = cycle.metrics;
      point.error = cycle.error;
      if (!cycle.outcome.complete()) point.why = cycle.outcome.detail;  // found, less accurately than asked
    } else if (attracts && cycle.outcome.ending == Ending::none_exists) {
      point.regime = Regime::stable;
    } else {
      point.why = fmt::format("{}: {}", name(cycle.outcome.ending), cycle.outcome.detail);
    }
  } catch (const InputError& e) {
    point.why = e.what();
  }
  return point;
}

/// The plane in tiles: what is computed together, so that neighbours help each other to a start.
class Tiles {
 public:
  static constexpr int edge = 32;  ///< most points of a tile along one axis
  Tiles(const Axis& x, const Axis& y) : columns_(cut(x)), rows_(cut(y)), width_(x.values.size()) {}
  int count() const { return int(columns_.size() * rows_.size()); }
  /// Calls f(index of the point, its place) for each point of a tile.
  template <class F>
  void for_each(int tile, F f) const {
    const auto [x0, x1] = columns_[tile % columns_.size()];
    const auto [y0, y1] = rows_[tile / columns_.size()];
    for (int iy = y0; iy < y1; ++iy)
      for (int ix = x0; ix < x1; ++ix) f(std::size_t(iy) * width_ + ix, GridPlace{tile, ix - x0, iy - y0});
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

/// The border of stability on the grid lines, joined to polylines.
class Threshold {
 public:
  Threshold(const Model& model, const Axis& x, const Axis& y) : model_(model), x_(x), y_(y) {}

  void trace(std::vector<double>& line_x, std::vector<double>& line_y) {
    const int nx = x_.regular, ny = y_.regular;
    std::vector<double> growth(nx * ny);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) growth[j * nx + i] = growth_at(x_.values[i], y_.values[j]);
    // Zeros on the edges of the grid: horizontal edges first, then vertical ones.
    std::vector<std::optional<Point>> crossing(nx * ny * 2);
    const auto edge = [&](int i, int j, bool vertical) { return (j * nx + i) * 2 + vertical; };
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (i + 1 < nx) crossing[edge(i, j, false)] = locate(growth[j * nx + i], growth[j * nx + i + 1], i, j, false);
        if (j + 1 < ny) crossing[edge(i, j, true)] = locate(growth[j * nx + i], growth[(j + 1) * nx + i], i, j, true);
      }
    // Within each cell the line runs from crossing to crossing.
    std::vector<std::vector<int>> neighbours(crossing.size());
    for (int j = 0; j + 1 < ny; ++j)
      for (int i = 0; i + 1 < nx; ++i) {
        std::vector<int> met;  // around the cell
        for (const int e : {edge(i, j, false), edge(i + 1, j, true), edge(i, j + 1, false), edge(i, j, true)})
          if (crossing[e]) met.push_back(e);
        for (std::size_t k = 0; k + 1 < met.size(); k += 2) {
          neighbours[met[k]].push_back(met[k + 1]);
          neighbours[met[k + 1]].push_back(met[k]);
        }
      }
    std::vector<bool> used(crossing.size());
    const auto follow = [&](int first) {
      if (!line_x.empty()) line_x.push_back(nothing), line_y.push_back(nothing);
      for (int at = first; at >= 0;) {
        used[at] = true;
        line_x.push_back(crossing[at]->x);
        line_y.push_back(crossing[at]->y);
        int next = -1;
        for (const int n : neighbours[at])
          if (!used[n]) next = n;
        at = next;
      }
    };
    for (const bool ends_only : {true, false})  // open lines from an end, then closed ones
      for (int e = 0; e < int(crossing.size()); ++e)
        if (crossing[e] && !used[e] && (!ends_only || neighbours[e].size() < 2)) follow(e);
  }

 private:
  struct Point {
    double x, y;
  };
  /// Largest real part of the eigenvalues; NaN where sliding has none or it is within rounding of zero.
  double growth_at(double x, double y) const {
    try {
      const auto s = stability(model_.with(x_.parameter, x).with(y_.parameter, y));
      return s.eigenvalues.empty() || s.marginal ? nothing : s.eigenvalues.front().real();
    } catch (const InputError&) {
      return nothing;
    }
  }
  std::optional<Point> locate(double low, double high, int i, int j, bool vertical) const {
    if (!std::isfinite(low) || !std::isfinite(high) || (low > 0) == (high > 0)) return std::nullopt;
    const Axis& axis = vertical ? y_ : x_;
    const int first = vertical ? j : i;
    const double a = axis.values[first], b = axis.values[first + 1];
    const auto value = [&](double w) { return axis.logarithmic ? std::exp(w) : w; };
    const auto coordinate = [&](double v) { return axis.logarithmic ? std::log(v) : v; };
    const auto point = [&](double v) { return vertical ? Point{x_.values[i], v} : Point{v, y_.values[j]}; };
    std::uintmax_t iterations = 100;
    const auto rate = [&](double w) {
      const Point p = point(value(w));
      const double g = growth_at(p.x, p.y);
      return std::isfinite(g) ? g : 0.0;  // within rounding of zero: found
    };
    const bool ascending = a < b;  // as the root finder wants it, whichever way the axis runs
    const auto [l, h] = boost::math::tools::toms748_solve(
        rate, coordinate(ascending ? a : b), coordinate(ascending ? b : a), ascending ? low : high,
        ascending ? high : low, boost::math::tools::eps_tolerance<double>(52), iterations);
    const Point numeric = point(value(0.5 * (l + h)));
    // Where the load is one of the axes, its closed form is free of the eigenvalues' rounding.
    for (const bool load_is_y : {false, true}) {
      if ((load_is_y ? y_ : x_).parameter != "drive.normal_load") continue;
      const auto closed = critical_load(model_.with(x_.parameter, numeric.x).with(y_.parameter, numeric.y));
      const double here = load_is_y ? numeric.y : numeric.x;
      if (closed && std::abs(closed->normal_load / here - 1) < 1e-6)
        return load_is_y ? Point{numeric.x, closed->normal_load} : Point{closed->normal_load, numeric.y};
    }
    return numeric;
  }

  const Model& model_;
  const Axis &x_, &y_;
};

}  // namespace

Map compute_map(const Model& model, const MapOptions& options, const MapHooks& hooks) {
  Map map;
  map.x = options.x;
  map.y = options.y;
  if (map.x.parameter == map.y.parameter) throw InputError(fmt::format("both map axes are '{}'", map.x.parameter));
  for (const auto& metric : options.metrics) find_metric(metric);
  if (!model.drive.constant())
    throw InputError(
        "a map is computed under a constant drive, but drive.speed, drive.normal_load or drive.force varies");
  for (const Axis* axis : {&map.x, &map.y})
    for (const double v : axis->values) (void)model.with(axis->parameter, v);  // refuses values out of range
  require(options.threads, {1, 4096}, "threads", "number of threads", "1");

  const std::size_t nx = map.x.values.size(), total = nx * map.y.values.size();
  map.points.resize(total);
  CoexistenceSearch coexistence;
  std::mutex hook_mutex;
  std::size_t done = 0;
  for (std::size_t i = 0; i < total; ++i)
    if (const MapPoint* known = hooks.known ? hooks.known(i) : nullptr) {
      map.points[i] = *known;
      ++done;
    }
  const auto model_at = [&](std::size_t i) {
    return model.with(map.x.parameter, map.x.values[i % nx]).with(map.y.parameter, map.y.values[i / nx]);
  };
  const auto finish = [&](std::size_t i, MapPoint point) {
    const std::scoped_lock lock(hook_mutex);
    if (map.points[i].done) return;  // known from before
    map.points[i] = std::move(point);
    ++done;
    if (hooks.finished) hooks.finished(i, map.points[i]);
    if (hooks.progress) hooks.progress(done, total);
  };
  // Tiles are independent of each other, so that neither threads nor an interruption show in the result. Several at a
  // time keep the lanes full.
  const Tiles tiles(map.x, map.y);
  std::vector<int> open;
  for (int tile = 0; tile < tiles.count(); ++tile) {
    bool missing = false;
    tiles.for_each(tile, [&](std::size_t i, GridPlace) { missing |= !map.points[i].done; });
    if (missing) open.push_back(tile);
  }
  const std::size_t together = std::clamp<std::size_t>(open.size() / options.threads, 1, 4);
  const LaneCycleOptions lane_options{options.tolerance, options.stick_threshold, options.metrics};
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    while (!hooks.stop.stop_requested()) {
      const std::size_t first = next.fetch_add(together);
      if (first >= open.size()) return;
      std::vector<Model> models;
      std::vector<GridPlace> places;
      std::vector<std::size_t> indices, alone;
      for (std::size_t k = first; k < std::min(first + together, open.size()); ++k)
        tiles.for_each(open[k], [&](std::size_t i, GridPlace place) {
          try {
            Model here = model_at(i);
            const Verdict verdict = judge(here, coexistence);
            if (verdict == Verdict::stable) return finish(i, stable_point());
            if (verdict == Verdict::look_beside_steady) return alone.push_back(i);
            models.push_back(std::move(here));
            places.push_back(place);
            indices.push_back(i);
          } catch (const InputError& e) {
            MapPoint point = stable_point();
            point.regime = Regime::failed;
            point.why = e.what();
            finish(i, std::move(point));
          }
        });
      const auto cycles = find_cycles(models, lane_options, places);
      for (std::size_t k = 0; k < cycles.size() && !hooks.stop.stop_requested(); ++k) {
        MapPoint point = stable_point();
        point.integrated = true;
        point.regime = Regime::cycle;
        point.metrics = cycles[k].metrics;
        point.error = cycles[k].error;
        finish(indices[k], cycles[k].found ? std::move(point) : compute_point(models[k], options, false));
      }
      for (std::size_t k = 0; k < alone.size() && !hooks.stop.stop_requested(); ++k)
        if (!map.points[alone[k]].done) finish(alone[k], compute_point(model_at(alone[k]), options, true));
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int t = 1; t < options.threads; ++t) threads.emplace_back(work);
    work();
  }
  if (done < total) {
    map.outcome = {Ending::interrupted, fmt::format("{} of {} points are done", done, total)};
    return map;
  }
  Threshold(model, map.x, map.y).trace(map.threshold_x, map.threshold_y);
  std::size_t failed = 0;
  for (const auto& point : map.points) {
    (point.integrated ? map.integrated : map.skipped) += 1;
    failed += point.regime == Regime::failed;
  }
  map.notes.push_back(fmt::format(
      "{} of {} points were decided without integration: steady sliding is stable there and no cycle can coexist, "
      "because the border in normal load is supercritical, or the load lies below the fold of cycles, or friction "
      "strengthens everywhere",
      map.skipped, total));
  if (failed > 0) map.outcome = {Ending::budget_spent, fmt::format("{} of {} points failed", failed, total)};
  return map;
}

}  // namespace rosin::analysis
