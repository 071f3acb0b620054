/// A parameter plane: the regime and the metrics at every point, and the threshold line of steady sliding.
#pragma once
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "analysis/cycle.hpp"

namespace rosin::analysis {

/// One axis of the plane.
struct Axis {
  std::string parameter;       ///< path
  std::vector<double> values;  ///< as drawn; `extra` values (such as λ = 0) stand last
  int regular = 0;             ///< how many of the values belong to the regular scale
  bool logarithmic = true;
};
/// \throws InputError: points < 2, from or to not usable on the scale, equal ends.
Axis make_axis(std::string parameter, double from, double to, int points, bool logarithmic,
               const std::vector<double>& extra);

enum class Regime : std::uint8_t { stable, cycle, bistable, failed };
std::string name(Regime);

struct MapOptions {
  Axis x, y;
  std::vector<std::string> metrics;  ///< names; see metric_names()
  double tolerance = 1e-6;           ///< relative, of every metric
  double stick_threshold = 0.1;
  int threads = 1;
};

/// What is known of one point.
struct MapPoint {
  Regime regime = Regime::failed;
  bool integrated = false;  ///< false: decided by linear stability and the fold bounds alone
  bool done = false;
  Metrics metrics, error;  ///< NaN where there is no cycle
  std::string why;         ///< of a failure
};

struct Map {
  Axis x, y;
  std::vector<MapPoint> points;  ///< row by row: [iy * x.size + ix]
  /// Threshold of steady sliding as polylines, NaN between separate lines; located to rounding on the grid lines.
  std::vector<double> threshold_x, threshold_y;
  Outcome outcome;
  long integrated = 0, skipped = 0;
  std::vector<std::string> notes;  ///< what was decided without integration, and why
};

/// Hooks for the caller; all may be empty. Called from one thread at a time.
struct MapHooks {
  std::function<const MapPoint*(std::size_t)> known;           ///< a point computed earlier, or nullptr
  std::function<void(std::size_t, const MapPoint&)> finished;  ///< a point is done: keep it safe
  std::function<void(std::size_t done, std::size_t total)> progress;
  std::stop_token stop;  ///< asks for an early, orderly end
};

/// Computes the plane. Results do not depend on the number of threads. \throws InputError for unknown paths or metrics
/// and for axis values outside the parameters' ranges.
Map compute_map(const Model&, const MapOptions&, const MapHooks& = {});

}  // namespace rosin::analysis
