/// Following a motion from value to value of a parameter.
#include "analysis/planes/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "analysis/cycles/section_map.hpp"
#include "analysis/cycles/stepped_returns.hpp"
#include "analysis/lanes/driven_lanes.hpp"
#include "analysis/motion/recurrence.hpp"
#include "analysis/motion/structure_record.hpp"
#include "analysis/planes/map_point.hpp"
#include "analysis/planes/structure_map.hpp"
#include "analysis/steady/mode_windows.hpp"
#include "core/workers.hpp"

namespace rosin::analysis::planes {

using cycles::SectionMap;
using motion::Follower;
using motion::StructureModel;
using motion::StructureRecord;
using Record = SweepOptions::Record;

namespace {

/// Records the columns where the velocity of a coordinate passes through 0.
class Extrema {
 public:
  Extrema(const oscillators::StructureSystem& system, int coordinate, StructureRecord& record)
      : system_(system), coordinate_(coordinate), record_(record) {}

  void look(Follower::Step& step) {
    const auto velocity = [this](double t, const double* y) { return system_.velocity(t, y)[coordinate_]; };
    std::vector<double> y = step.state_before();
    double low = 0, before = velocity(step.time_before(), y.data());
    for (int i = 0; i < Follower::Step::stages; ++i) {
      step.stage(i, y.data());
      const double now = velocity(step.stage_time(i), y.data());
      if ((before > 0 && now <= 0) || (before < 0 && now >= 0)) {
        const auto theta = step.locate(velocity, low, step.node(i), before, now);
        if (theta && step.solve_at(*theta, y.data())) record_.record(step.time_at(*theta), y.data());
      }
      low = step.node(i), before = now;
    }
  }

 private:
  const oscillators::StructureSystem& system_;
  int coordinate_;
  StructureRecord& record_;
};

int recurrence(const std::vector<std::vector<double>>& columns) {
  return motion::recurrence_of(columns, int(columns.front().size()) / 2);
}

/// One value: the motion from the model's start.
/// \returns where it ended
std::vector<double> record_point(const StructureModel& model, const SweepOptions& options, SweepPoint& point) {
  SectionMap map(model.structure);
  map.watch(options.watch);
  std::vector<double> y = motion::starting_point(map.system(), model.start);
  StructureRecord record(map.system());
  Extrema extrema(map.system(), options.watch, record);
  bool recording = options.transient == 0;
  std::vector<double> end = y;
  double time = 0;
  const auto observe = [&](Follower::Step& step, std::span<const Follower::Event>) {
    if (recording && options.record == Record::extrema) extrema.look(step);
    end = step.state(), time = step.time();
  };
  const auto outcome = map.follow_crossings(
      y, 0.1 * options.tolerance,
      [&](int crossing, double t, const std::vector<double>& there) {
        if (crossing > options.transient && options.record == Record::section) {
          record.record(map.driven() ? 0 : t, there.data());
          // The section is where the watched velocity is 0: what rounding leaves of it is no difference of two returns.
          if (!map.driven()) record.values[std::size_t(map.system().coordinates() + options.watch)].back() = 0;
        }
        recording = crossing >= options.transient;
        end = there;
        return crossing >= options.transient + options.keep;
      },
      observe);
  if (!outcome.complete()) point.why = fmt::format("{}: {}", name(outcome.ending), outcome.detail);
  if (record.values.front().empty() && outcome.complete()) record.record(map.driven() ? 0 : time, end.data());
  point.columns = std::move(record.values);
  if (!point.columns.front().empty()) point.recurrence = recurrence(point.columns);
  point.done = true;
  return end;
}

/// No contact touches a surface at rest.
bool slides(const oscillators::Structure& structure) {
  return std::ranges::all_of(structure.contacts, [](const auto& contact) { return contact.speed.level() != 0; });
}

std::string thresholds_left_out(const InputError& error) {
  return fmt::format("thresholds of steady sliding are not marked: {}", error.what());
}

/// Counts the values that are done, and tells of them.
class Progress {
 public:
  Progress(const SweepHooks& hooks, std::size_t total) : hooks_(hooks), total_(total) {}
  void finished(bool up, std::size_t value, const SweepPoint& point) {
    const std::scoped_lock lock(mutex_);
    if (hooks_.finished) hooks_.finished(up, value, point);
  }
  void advance() {
    const std::scoped_lock lock(mutex_);
    ++done_;
    if (hooks_.progress) hooks_.progress(done_, total_);
  }
  std::size_t done() const { return done_; }

 private:
  const SweepHooks& hooks_;
  std::size_t total_, done_ = 0;
  std::mutex mutex_;
};

/// A value to compute; the point's `end` is that of the value before it.
struct Due {
  std::size_t value;
  SweepPoint* point;
};

/// Blocks under a periodic force, each from its start, whose sections are followed in lanes.
class Batch {
 public:
  static constexpr std::size_t size = 4 * lane_count;

  explicit Batch(const SweepOptions& options) : options_(options) {}
  /// Leaves undone what is no such block, or could not be followed so.
  void run(const std::function<StructureModel(double)>& family, std::span<const Due> due) {
    for (const auto& [i, point] : due) try {
        take(family(options_.axis.values[i]), *point);
      } catch (const InputError&) {
        continue;  // told where the value is computed by itself
      }
    if (!motions_.empty()) lanes::DrivenLanes(motions_.front().block).run(motions_);
    for (std::size_t m = 0; m < motions_.size(); ++m)
      if (motions_[m].why.empty()) record(motions_[m], of_[m].structure, *of_[m].point);
  }

 private:
  void take(const StructureModel& model, SweepPoint& point) {
    auto block = lanes::DrivenBlock::of(model.structure);
    if (!block || (!motions_.empty() && !lanes::DrivenLanes::alike(motions_.front().block, *block))) return;
    const auto y = motion::starting_point(oscillators::StructureSystem(model.structure), model.start);
    motions_.push_back({.block = std::move(*block),
                        .displacement = y[0],
                        .slip_rate = y[1],
                        .tolerance = 0.1 * options_.tolerance,
                        .transient = options_.transient,
                        .keep = options_.keep});
    of_.push_back({model.structure, &point});
  }
  static void record(const lanes::DrivenMotion& motion, const oscillators::Structure& structure, SweepPoint& point) {
    oscillators::StructureSystem system(structure);
    StructureRecord record(system);
    for (const auto& [displacement, slip_rate, contact] : motion.moments) {
      system.set_mode(0, contact);
      const double y[] = {displacement, slip_rate};
      record.record(0, y);
    }
    point.columns = std::move(record.values);
    point.recurrence = recurrence(point.columns);
    point.end = {motion.displacement, motion.slip_rate};
    point.done = true;
  }

  struct Taken {
    oscillators::Structure structure;
    SweepPoint* point;
  };
  const SweepOptions& options_;
  std::vector<lanes::DrivenMotion> motions_;
  std::vector<Taken> of_;
};

/// Calls compute(values that are due) for all values of all directions: one by one in a direction, and `group` at a
/// time where all begin anew.
template <class Compute>
void for_each_value(const SweepOptions& options, Sweep& sweep, const SweepHooks& hooks, std::size_t group,
                    Compute compute) {
  require(options.threads, {1, 4096}, "threads", "number of threads", "1");
  const std::size_t n = options.axis.values.size();
  if (options.up) sweep.up.resize(n);
  if (options.down) sweep.down.resize(n);
  const std::size_t directions = std::size_t(options.up) + std::size_t(options.down);
  const std::size_t total = options.anew ? n : directions * n;
  Progress progress(hooks, total);
  const auto along = [&](bool up, std::size_t k) { return up ? k : n - 1 - k; };
  const auto settle = [&](bool up, std::size_t first, std::size_t count, const std::vector<double>& before) {
    auto& points = up ? sweep.up : sweep.down;
    std::vector<Due> due;
    for (std::size_t i = first; i < first + count; ++i) {
      if (auto known = hooks.known ? hooks.known(up, i) : std::nullopt) {
        points[i] = std::move(*known);
        progress.advance();
      } else {
        points[i].end = before;
        due.push_back({i, &points[i]});
      }
    }
    if (!due.empty()) compute(std::span<const Due>(due));
    for (const auto& [i, point] : due) {
      progress.finished(up, i, *point);
      progress.advance();
    }
  };
  try {
    if (options.anew) {  // directions do not differ
      in_parallel(options.threads, (n + group - 1) / group, [&](std::size_t g) {
        const std::size_t first = g * group, count = std::min(group, n - first);
        settle(options.up, first, count, {});
        if (options.up && options.down)
          std::copy_n(sweep.up.begin() + long(first), count, sweep.down.begin() + long(first));
      });
    } else {
      in_parallel(options.threads, directions, [&](std::size_t d) {
        const bool up = options.up && d == 0;
        for (std::size_t k = 0; k < n; ++k) {
          end_if_stopped();
          settle(up, along(up, k), 1,
                 k == 0 ? std::vector<double>() : (up ? sweep.up : sweep.down)[along(up, k - 1)].end);
        }
      });
    }
  } catch (const Stopped&) {
    sweep.outcome = {Ending::interrupted, fmt::format("{} of {} values are done", progress.done(), total)};
    return;
  }
  std::size_t failed = 0;
  std::string first;
  for (const auto* direction : {&sweep.up, &sweep.down})
    for (const auto& point : *direction)
      if (!point.why.empty() && failed++ == 0) first = point.why;
  if (failed == directions * n)
    sweep.outcome = {Ending::none_exists, fmt::format("every value failed; the first: {}", first)};
}

/// One value where it can be computed; else the reason why not.
template <class Compute>
void compute_value(const Sweep& sweep, SweepPoint& point, Compute compute) {
  try {
    compute();
    point.done = true;
  } catch (const InputError& error) {
    point.done = true, point.why = error.what();
    point.columns.assign(sweep.column_names.size(), {});
    point.metrics = undecided_point();
    point.metrics.measures.assign(sweep.metrics.size(), NAN), point.metrics.measure_errors = point.metrics.measures;
  }
}

/// The channels of a motion by steps at its returns, or at the extrema of the watched coordinate.
/// \returns the state in which it ended
std::vector<double> record_point(const motion::SteppedOscillator& oscillator, const SweepOptions& options,
                                 SweepPoint& point) {
  cycles::SteppedReturns returns(oscillator, 0.1 * options.tolerance);
  returns.watch(options.watch);
  point.columns.assign(oscillator.channels.size(), {});
  const auto record = [&](const std::vector<double>& row) {
    for (std::size_t c = 0; c < row.size(); ++c) point.columns[c].push_back(row[c]);
  };
  cycles::SteppedReturn one;
  Outcome outcome;
  for (int k = 0; k < options.transient + options.keep; ++k) {
    if (k == options.transient && options.record == Record::extrema) returns.extremum = record;
    outcome = returns.next(one);
    if (outcome.ending != Ending::event) break;
    if (k >= options.transient && options.record == Record::section) record(one.row);
  }
  // A motion that comes to no return any more, in rest or steady sliding, has one moment: its last.
  if (outcome.ending == Ending::none_exists) outcome = {};
  if (!outcome.complete()) point.why = fmt::format("{}: {}", name(outcome.ending), outcome.detail);
  if (point.columns.front().empty() && !one.row.empty()) record(one.row);
  if (!point.columns.front().empty()) point.recurrence = recurrence(point.columns);
  return returns.state();
}

}  // namespace

Sweep sweep(const std::function<StructureModel(double)>& family, const SweepOptions& options, const SweepHooks& hooks) {
  Sweep result;
  const auto first = family(options.axis.values.front());
  {
    const oscillators::StructureSystem system(first.structure);
    const StructureRecord record(system);
    result.column_names = record.names, result.column_units = record.units;
  }
  if (options.record == Record::metrics) result.metrics = metrics_of_structure(first.structure, options.metrics);
  if (first.structure.constant()) {
    try {
      std::vector<double> sliding;
      for (const double value : options.axis.values)
        if (slides(family(value).structure)) sliding.push_back(value);
      result.thresholds =
          steady::scan([&](double value) { return steady::stability(family(value).structure); }, sliding).thresholds;
    } catch (const InputError& error) {
      result.thresholds_left_out = thresholds_left_out(error);
    }
  }
  const auto compute = [&](std::size_t i, SweepPoint& point) {
    compute_value(result, point, [&] {
      auto model = family(options.axis.values[i]);
      const auto size = std::size_t(oscillators::StructureSystem(model.structure).size());
      // Where a parameter changes which unknowns there are, the motion begins anew.
      if (point.end.size() == size) model.start.unknowns = point.end;
      if (options.record == Record::metrics) {
        std::vector<double> reached;
        point.metrics = compute_structure_point(model, options.tolerance, result.metrics, options.lyapunov,
                                                options.stick_threshold, &reached);
        point.why = point.metrics.regime == Regime::failed ? point.metrics.why : "";
        if (!reached.empty()) point.end = reached;
      } else {
        point.end = record_point(model, options, point);
      }
    });
  };
  const bool in_lanes =
      options.anew && options.record == Record::section && lanes::DrivenBlock::of(first.structure).has_value();
  for_each_value(options, result, hooks, in_lanes ? Batch::size : 1, [&](std::span<const Due> due) {
    if (in_lanes) Batch(options).run(family, due);
    for (const auto& [i, point] : due)
      if (!point->done) compute(i, *point);
  });
  return result;
}

Sweep sweep(const std::function<motion::SteppedOscillator(double)>& family, const SweepOptions& options,
            const SweepHooks& hooks) {
  Sweep result;
  const auto first = family(options.axis.values.front());
  for (const auto& channel : first.channels)
    result.column_names.push_back(channel.name), result.column_units.push_back(channel.unit);
  if (options.record == Record::metrics) result.metrics = metrics_of_stepped(first, options.metrics);
  if (!first.driven())
    result.thresholds_left_out = "thresholds of steady sliding are those of 'stability', value by value";
  for_each_value(options, result, hooks, 1, [&](std::span<const Due> due) {
    for (const auto& [i, point] : due)
      compute_value(result, *point, [&, i = i, point = point] {
        auto oscillator = family(options.axis.values[i]);
        if (point->end.size() == oscillator.start.size()) oscillator.start = point->end;
        if (options.record == Record::metrics) {
          point->metrics =
              compute_stepped_point(oscillator, options.tolerance, result.metrics, options.lyapunov, &point->end);
          point->why = point->metrics.regime == Regime::failed ? point->metrics.why : "";
        } else {
          point->end = record_point(oscillator, options, *point);
        }
      });
  });
  return result;
}

}  // namespace rosin::analysis::planes
