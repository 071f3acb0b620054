/// What changes along one parameter: sections or extrema of the motion, or metrics, upwards and downwards.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/motion/stepped_oscillator.hpp"
#include "analysis/motion/structure_start.hpp"
#include "analysis/planes/map.hpp"
#include "analysis/steady/thresholds.hpp"

namespace rosin::analysis::planes {

struct SweepOptions {
  enum class Record : std::uint8_t {
    section,  ///< the columns at each return: a moment of a periodic drive, else a maximum of the watched coordinate
    extrema,  ///< the columns at each maximum and minimum of the watched coordinate
    metrics   ///< of the periodic motion
  };
  Axis axis;  ///< ascending
  Record record = Record::section;
  bool up = true, down = false;
  bool anew = false;        ///< each value from the scene's own start; else from the motion at the value before
  int transient = 200;      ///< returns that are not recorded
  int keep = 100;           ///< returns that are
  int watch = 0;            ///< coordinate
  double tolerance = 1e-8;  ///< relative
  std::vector<std::string> metrics;
  double stick_threshold = 0.1;      ///< of the metrics
  cycles::LyapunovOptions lyapunov;  ///< of that metric of structures
  int threads = 1;
};

struct SweepPoint {
  bool done = false;
  std::string why;  ///< of a value that ended short
  /// [column][moment]. A motion that comes to no return any more, in rest or steady sliding, has one moment: its last.
  std::vector<std::vector<double>> columns;
  int recurrence = 0;  ///< returns after which the motion recurs; 0: not among those kept
  MapPoint metrics;
  std::vector<double> end;  ///< unknowns from which the motion goes on at the next value
};

struct Sweep {
  Outcome outcome;
  std::vector<std::string> column_names, column_units;
  std::vector<PlaneMetric> metrics;
  std::vector<SweepPoint> up, down;           ///< one for each value, in the order of the axis; empty: not asked
  std::vector<steady::Threshold> thresholds;  ///< of steady sliding, where the drive is constant
  std::string thresholds_left_out;            ///< the reason why they are not known; empty: they are
};

/// Hooks for the caller; all may be empty. Called from one thread at a time, but for `known`.
struct SweepHooks {
  std::function<void(std::size_t done, std::size_t total)> progress = nullptr;
  /// A value of a direction as an earlier run left it, or nothing.
  std::function<std::optional<SweepPoint>(bool up, std::size_t value)> known = nullptr;
  /// A value is done: keep it safe. Where values begin anew and both directions are asked for, it is told of one.
  std::function<void(bool up, std::size_t value, const SweepPoint&)> finished = nullptr;
};

/// A structure along the parameter. Directions run in threads of their own, and so do values that begin anew: the
/// result does not depend on the number of threads. Asked to stop, it ends "interrupted" with the values that are done.
/// \throws InputError for unknown metrics, and where the drive has no period
Sweep sweep(const std::function<motion::StructureModel(double)>&, const SweepOptions&, const SweepHooks& = {});
/// The same of oscillators that are followed by steps, whose columns are their channels.
Sweep sweep(const std::function<motion::SteppedOscillator(double)>&, const SweepOptions&, const SweepHooks& = {});

}  // namespace rosin::analysis::planes
