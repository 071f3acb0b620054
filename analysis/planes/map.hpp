/// A parameter plane: the regime and the metrics at every point, and the threshold line of steady sliding.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/lyapunov.hpp"
#include "core/uncertain.hpp"

namespace rosin::analysis::planes {

using oscillators::Model;

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

/// What one process computes of a plane if others, which it knows nothing of, compute the rest.
struct Share {
  int index = 0, count = 1;
};

struct MapOptions {
  Axis x, y;
  std::vector<std::string> metrics;  ///< names; see metric_names()
  double tolerance = 1e-6;           ///< relative, of every metric, computed or interpolated
  double stick_threshold = 0.1;
  int threads = 1;
  cycles::LyapunovOptions lyapunov;  ///< of that metric of structures
  bool exact = false;  ///< compute every point; otherwise large planes are interpolated between computed points
  Share share;
  std::vector<Uncertain> uncertain = {};  ///< inputs that "probability_unstable" draws
  int samples = 200;                      ///< draws of them, the same ones at each point
  std::uint64_t seed = 1;
};

/// Where the numbers of a point come from.
enum class Origin : std::uint8_t {
  decided,      ///< by linear stability and the fold bounds alone
  computed,     ///< by integration
  interpolated  ///< between computed points, with an error seen at held-out ones
};

/// True where some points are computed and the others interpolated, because that costs less than all of them.
bool interpolates(const MapOptions&);

/// What is known of one point.
struct MapPoint {
  Regime regime = Regime::failed;
  Origin origin = Origin::decided;
  bool done = false;
  cycles::Metrics metrics, error;  ///< NaN where there is no cycle
  /// The same for structures, in the order of the map's metrics.
  std::vector<double> measures = {}, measure_errors = {};
  std::string why;  ///< of a failure
};

/// A metric of a plane: a member of a slider's metrics, or one of the measures of a structure.
struct PlaneMetric {
  std::string name, unit, meaning;
  double cycles::Metrics::*member = nullptr;
  std::size_t place = 0;  ///< among the measures, where there is no member
  double& value(MapPoint& point) const { return member ? point.metrics.*member : point.measures[place]; }
  double& error(MapPoint& point) const { return member ? point.error.*member : point.measure_errors[place]; }
  double value(const MapPoint& point) const { return member ? point.metrics.*member : point.measures[place]; }
  double error(const MapPoint& point) const { return member ? point.error.*member : point.measure_errors[place]; }
};
/// Of a slider's cycles, by their names. \throws InputError for an unknown name.
std::vector<PlaneMetric> metrics_of_slider(const std::vector<std::string>& names);

/// A point of which nothing is known yet.
MapPoint undecided_point();

/// Lines in the plane, NaN between separate ones.
struct Polyline {
  std::vector<double> x, y;
};

struct Map {
  Axis x, y;
  std::vector<PlaneMetric> metrics;
  std::vector<MapPoint> points;  ///< row by row: [iy * x.size + ix]
  Polyline threshold;            ///< of steady sliding, located to rounding on the grid lines
  /// Folds of cycles below the border where it is subcritical in normal load and the load is one of the axes: between
  /// the two lines cycles coexist with stable sliding. Within `fold_error` decades of load.
  Polyline fold;
  double fold_error = 0;
  Outcome outcome;
  long integrated = 0, interpolated = 0, skipped = 0;  ///< number of points; skipped: decided without integration
  std::vector<std::string> notes;                      ///< what was decided without integration, and why
};

class Crew;
struct PartCost;

struct MapProgress {
  std::size_t done = 0, total = 0;  ///< points
  double work = 0;                  ///< done now as a part of all that was missing, 0 … 1
};

/// Hooks for the caller; all may be empty. Called from one thread at a time.
struct MapHooks {
  std::function<std::optional<MapPoint>(std::size_t)> known;  ///< a point computed earlier, or nothing
  /// Some points are done: keep them safe. Patches that are interpolated are known whole or computed again.
  std::function<void(std::span<const std::size_t>, const std::vector<MapPoint>&)> finished;
  std::function<void(const MapProgress&)> progress = nullptr;
  std::function<void(const std::vector<PartCost>&)> costs = nullptr;  ///< parts of the plane that are done
  Crew* crew = nullptr;  ///< the processes that compute the plane; none: this one alone
};

/// Computes the plane. Results do not depend on the number of threads. \throws InputError for unknown paths or metrics
/// and for axis values outside the parameters' ranges. Asked to stop (core/stop.hpp), it ends "interrupted" with the
/// points that are done. Of a share the other points are not done, and there are no lines; the same where another
/// process leads, which knows the plane.
Map compute_map(const Model&, const MapOptions&, const MapHooks& = {});

}  // namespace rosin::analysis::planes
