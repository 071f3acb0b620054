/// Recurrence of a structure's motion, Newton's method on its return map, and what is measured on the period.
#include "analysis/cycles/structure_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "analysis/cycles/lyapunov.hpp"
#include "analysis/cycles/motion_range.hpp"
#include "analysis/cycles/multipliers.hpp"
#include "analysis/cycles/period_record.hpp"
#include "analysis/cycles/section_map.hpp"
#include "analysis/motion/structure_record.hpp"
#include "core/linear_solve.hpp"

namespace rosin::analysis::cycles {

using Eigen::MatrixXd, Eigen::VectorXd;
using motion::Follower;
using oscillators::Structure;
using oscillators::StructureSystem;

namespace {

constexpr int most_returns = 32;  ///< in a period that is looked for
constexpr const char* at_rest_or_sliding = "from this start steady sliding is reached, or rest";

/// A point of the section that returns to itself, by Newton's method: found where the last correction is small by the
/// tolerance, or below `asked`.
struct Closed {
  bool found = false;
  double change = infinity;  ///< the last correction, in sizes
  std::vector<double> y;
  MatrixXd derivative;
};

Closed close(SectionMap& map, std::vector<double> y, int returns, double tolerance, const VectorXd& size,
             double asked = 0) {
  constexpr int most_iterations = 12;
  constexpr double near = 0.3, enough = 1e3;  // corrections: of a start that is near, and tolerances that may be left
  Closed best;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    auto arrived = map.follow(y, tolerance, returns, true);
    if (arrived.outcome.ending != Ending::event || !arrived.derivative.allFinite()) break;
    const Eigen::Index n = arrived.derivative.rows();
    VectorXd residual(n);
    for (Eigen::Index i = 0; i < n; ++i) residual[i] = (arrived.y[std::size_t(i)] - y[std::size_t(i)]) / size[i];
    const MatrixXd slopes = size.cwiseInverse().asDiagonal() * arrived.derivative * size.asDiagonal();
    // A contact that never slips may rest anywhere, and stays where it is.
    const VectorXd correction = solve_within_range(MatrixXd::Identity(n, n) - slopes, residual);
    if (!correction.allFinite()) break;
    const double change = correction.cwiseAbs().maxCoeff();
    const bool better = change < 0.5 * best.change;
    if (change < best.change) best = {false, change, y, arrived.derivative};
    if (iteration == 0 && change > near) break;
    if (change < 0.1 * tolerance || (iteration > 1 && !better)) break;
    for (Eigen::Index i = 0; i < n; ++i) y[std::size_t(i)] += size[i] * correction[i];
  }
  best.found = best.change < std::max(enough * tolerance, asked);
  return best;
}

/// What one period shows, at one tolerance.
struct Period : PeriodRecord {
  Closed closed;
  double duration = 0;
  std::vector<std::complex<double>> multipliers;

  Period(SectionMap& map, Closed at, int returns, double tolerance, double stick_threshold)
      : PeriodRecord(map.system(), tolerance, stick_threshold), closed(std::move(at)) {
    const auto arrived =
        map.follow(closed.y, tolerance, returns, false,
                   [this](Follower::Step& step, std::span<const Follower::Event> switches) { add(step, switches); });
    duration = arrived.duration;
    finish(duration);
    const Eigen::Index wanted = Eigen::Index(moving_unknowns(map.system()).size()) - (map.driven() ? 0 : 1);
    auto values = by_modulus(closed.derivative);
    values.resize(std::size_t(std::min<Eigen::Index>(wanted, Eigen::Index(values.size()))));
    multipliers = values;
  }
};

/// What recurs: a point of the section and the returns after which the motion is near it again.
struct Recurrence {
  Outcome outcome;
  int returns = 0;
  Closed closed;
  VectorXd size;
};

/// Whether no coordinate moves but by rounding, which crosses a section as well.
bool stands_still(const PeriodRecord& period) {
  constexpr double rounding = 1e-11;  // of a coordinate
  for (std::size_t i = 0; i < period.coordinate_max.size(); ++i) {
    const double high = period.coordinate_max[i], low = period.coordinate_min[i];
    if (!(high - low <= rounding * std::max(std::abs(high), std::abs(low)))) return false;
  }
  return true;
}

class RecurrenceSearch {
 public:
  RecurrenceSearch(SectionMap& map, const motion::StructureModel& model, const StructureCycleOptions& options)
      : map_(map), model_(model), options_(options), range_(map.system()) {}

  Recurrence search() {
    std::vector<double> y = motion::starting_point(map_.system(), model_.start);
    range_.begin(y);
    const auto observe = [this](Follower::Step& step, std::span<const Follower::Event>) {
      range_.add(step.state());
      if (map_.driven()) return;
      for (int c = 0; c < map_.system().contacts(); ++c)
        if (map_.system().mode(c) == ContactMode::stick) sticks_ = true;
    };
    if (!map_.driven()) {
      try {
        steady_ = map_.system().steady(0);
      } catch (const InputError&) {  // a structure that no spring holds
      }
      choose_section(y, observe);
    }
    Outcome outcome;
    do {
      refine_ = false;
      const int before = crossings_;
      outcome = map_.follow_crossings(
          y, tolerance_,
          [&](int crossing, double t, const std::vector<double>& there) {
            mean_return_ = t / crossing;
            if (look(before + crossing, there)) return true;
            if (refine_ = steps_hide_recurrence(there); refine_) y = there;
            return refine_;
          },
          observe);
      if (refine_) tolerance_ *= finer_;
    } while (refine_);
    if (result_.returns > 0) return result_;
    if (outcome.ending == Ending::reached_end || (outcome.ending == Ending::event && settled_))
      outcome = {Ending::none_exists, at_rest_or_sliding};
    else if (unbounded_)
      outcome = {Ending::unbounded,
                 fmt::format("by as much in each return, to {:.3g} m after {}", ranges_.back(), crossings_)};
    else if (outcome.ending == Ending::event)
      outcome = {Ending::budget_spent,
                 fmt::format("no period within {} returns: the motion is irregular, or settles slowly (the nearest "
                             "return is {:.1e} of its range away)",
                             crossings_, nearest_)};
    result_.outcome = outcome;
    return result_;
  }
  long crossings() const { return crossings_; }
  double mean_return() const { return mean_return_; }  ///< s
  /// The last point of the section that was reached; empty: none was.
  std::vector<double> last() const { return past_.empty() ? std::vector<double>() : past_.back(); }

 private:
  /// The coordinate that moves most in the first returns.
  void choose_section(std::vector<double>& y, const SectionMap::Observer& observe) {
    Follower follower(map_.system(), tolerance_);
    follower.observe = observe;
    constexpr double of_patience = 0.02;
    std::vector<double> ahead = y;
    follower.follow(0, ahead, of_patience * map_.patience());
    map_.watch(range_.widest());
    range_.begin(y);
  }

  /// True where the search ends.
  bool look(int crossing, const std::vector<double>& y) {
    crossings_ = crossing;
    past_.push_back(y);
    if (int(past_.size()) > most_returns + 1) past_.pop_front();
    if (crossing % renewal == 0) {  // what the transient went through is forgotten
      size_ = range_.size();
      ranges_.push_back(size_.head(map_.system().coordinates()).maxCoeff());
      range_.begin(y);
      if (grows_without_bound()) return true;
      if (rests(y)) return settled_ = true;
    }
    if (crossing >= options_.max_cycles) return true;
    if (crossing < 2) return false;
    if (crossing < renewal) size_ = range_.size();
    if (settles(y)) return settled_ = true;
    if (crossing < next_try_) return false;
    const int last = int(past_.size()) - 1;
    nearest_ = infinity;
    int returns = 0;
    for (int m = 1; m <= last; ++m) {
      const double apart = distance(past_[last], past_[last - m], size_);
      nearest_ = std::min(nearest_, apart);
      if (apart < near_) {
        returns = m;
        break;
      }
    }
    if (returns == 0) return false;
    auto closed = close(map_, y, returns, tolerance_, size_);
    // An alternating transient is nearer after two returns, although one would close it.
    for (int part = 1; closed.found && part <= returns / 2; ++part) {
      if (returns % part != 0) continue;
      const auto there = map_.follow(closed.y, tolerance_, part, false);
      constexpr double same = 1e-4;
      if (there.outcome.ending != Ending::event || distance(there.y, closed.y, size_) > same) continue;
      if (auto shorter = close(map_, closed.y, part, tolerance_, size_); shorter.found)
        closed = std::move(shorter), returns = part;
    }
    constexpr double neutral = 1 + 1e-3;
    const auto attracts = [&] {
      const auto multipliers = by_modulus(closed.derivative);
      return multipliers.empty() || std::abs(multipliers.front()) < neutral;
    };
    if (closed.found && moves(closed.y) && (attracts() || recurs(returns))) {
      result_.returns = returns, result_.closed = std::move(closed), result_.size = size_;
      return true;
    }
    // Further on the motion is nearer to what it settles on.
    next_try_ = crossing + std::max(2, crossing / 4);
    near_ = std::max(0.5 * std::min(near_, nearest_), 1e-12);
    return false;
  }

  /// The errors of the steps in one return are as large as what a recurrence is known by: breakaway may amplify them a
  /// hundred thousand times.
  bool steps_hide_recurrence(const std::vector<double>& y) {
    constexpr double least = 1e-11, seen = 1e-4;
    if (crossings_ < next_check_ || finer_ * tolerance_ < least) return false;
    next_check_ = 2 * crossings_;
    const auto loosely = map_.follow(y, tolerance_, 1, false), closely = map_.follow(y, finer_ * tolerance_, 1, false);
    return loosely.outcome.ending == Ending::event && closely.outcome.ending == Ending::event &&
           distance(loosely.y, closely.y, size_) > seen;
  }

  /// Twice to rounding: by a symmetry a motion may stay on a cycle that does not attract.
  bool recurs(int returns) const {
    constexpr double rounding = 1e-11;
    const int last = int(past_.size()) - 1;
    return last >= 2 * returns && distance(past_[last], past_[last - returns], size_) < rounding &&
           distance(past_[last - returns], past_[last - 2 * returns], size_) < rounding;
  }

  /// At a resonance that friction does not hold the range grows by as much in each renewal. Without a varying force
  /// friction feeds the motion, and bounds it.
  bool grows_without_bound() {
    constexpr std::size_t renewals = 20;
    constexpr double as_much = 0.97;
    if (!map_.driven() || ranges_.size() <= renewals) return false;
    const auto last = ranges_.end() - 1, first = last - long(renewals), middle = last - long(renewals / 2);
    if (!std::is_sorted(first, ranges_.end()) || *last < 2 * *first) return false;
    unbounded_ = *last - *middle > as_much * (*middle - *first);
    return unbounded_;
  }

  /// An oscillation about steady sliding that dies out.
  bool settles(const std::vector<double>& y) {
    if (steady_.empty()) return false;
    const double away = away_from_steady(y);
    const bool smaller = away < last_away_ && !std::exchange(sticks_, false);
    last_away_ = away;
    decays_ = smaller ? decays_ + 1 : 0;
    constexpr int long_enough = 10;
    return away < small && decays_ >= long_enough;
  }
  /// No coordinate moves any more, whichever contacts stick.
  bool rests(const std::vector<double>& y) const {
    if (map_.driven()) return false;
    std::vector<double> natural(y.size());
    map_.system().scale(y.data(), natural.data());
    for (int i = 0; i < map_.system().coordinates(); ++i)
      if (size_[i] > small * natural[i]) return false;
    return true;
  }
  /// Not steady sliding itself.
  bool moves(const std::vector<double>& y) const {
    constexpr double least = 1e-5;
    return steady_.empty() || away_from_steady(y) > least;
  }
  /// The largest distance of a coordinate from steady sliding, in natural sizes.
  double away_from_steady(const std::vector<double>& y) const {
    std::vector<double> natural(y.size());
    map_.system().scale(steady_.data(), natural.data());
    double away = 0;
    for (int i = 0; i < map_.system().coordinates(); ++i)
      away = std::max(away, std::abs(y[i] - steady_[i]) / natural[i]);
    return away;
  }

  static constexpr int renewal = 8;
  static constexpr double small = 1e-6;  ///< in natural sizes: what counts as rest
  static constexpr double finer_ = 1e-2;
  double tolerance_ = 1e-7;  ///< of the steps
  bool refine_ = false;      ///< the motion goes on by finer steps
  int next_check_ = 24;      ///< crossing, at which the errors of steps are looked at again
  SectionMap& map_;
  const motion::StructureModel& model_;
  const StructureCycleOptions& options_;
  MotionRange range_;
  VectorXd size_;
  std::deque<std::vector<double>> past_;
  std::vector<double> steady_;
  double near_ = 1e-3, nearest_ = infinity, last_away_ = infinity;
  int next_try_ = 3, decays_ = 0;
  int crossings_ = 0;
  double mean_return_ = 0;
  bool settled_ = false, sticks_ = false, unbounded_ = false;
  std::vector<double> ranges_;  ///< of the widest coordinate, one for each renewal
  Recurrence result_;
};

/// Does the drive reverse after half its period, and has each stop a mirror image?
bool drive_is_antisymmetric(const Structure& structure, double period) {
  constexpr int moments = 37;
  constexpr double rounding = 1e-9;
  const auto reverses = [&](const Signal& signal, double sign) {
    double size = 0, left = 0;
    for (int i = 0; i < moments; ++i) {
      const double t = period * i / moments, a = signal.value(t), b = signal.value(t + period / 2);
      size = std::max(size, std::abs(a)), left = std::max(left, std::abs(a - sign * b));
    }
    return left <= rounding * size;
  };
  return std::ranges::all_of(structure.force, [&](const Signal& f) { return reverses(f, -1); }) &&
         std::ranges::all_of(structure.limited,
                             [&](const oscillators::LimitedForce& of) { return reverses(of.command, -1); }) &&
         std::ranges::all_of(structure.contacts,
                             [&](const oscillators::FrictionContact& c) {
                               return reverses(c.speed, -1) && reverses(c.normal_load, 1) && c.normal.size() == 0;
                             }) &&
         std::ranges::all_of(structure.stops, [&](const oscillators::Stop& stop) {
           return std::ranges::any_of(structure.stops, [&](const oscillators::Stop& other) {
             return other.coordinate == stop.coordinate && other.side == -stop.side && other.at == -stop.at &&
                    other.restitution == stop.restitution && other.stiffness == stop.stiffness &&
                    other.damping == stop.damping;
           });
         });
}

/// Whether coordinates and velocities are reversed after half the period of the motion.
std::string symmetry_of(SectionMap& map, const Closed& closed, int returns, double tolerance, const VectorXd& size) {
  if (!map.driven() || returns % 2 == 0 ||  // an even number of drive periods has no half that reverses the drive
      !drive_is_antisymmetric(map.system().structure(), map.drive_period()))
    return "";
  std::vector<double> y = closed.y;
  Follower follower(map.system(), tolerance);
  Outcome outcome;
  for (int turn = 0; turn < returns / 2 && outcome.complete(); ++turn)
    outcome = follower.follow(0, y, map.drive_period());
  if (outcome.complete()) outcome = follower.follow(0, y, 0.5 * map.drive_period());
  if (!outcome.complete()) return "";
  const auto& system = map.system();
  const int n = system.coordinates();
  const VectorXd before = system.velocity(0, closed.y.data()),
                 after = system.velocity(0.5 * map.drive_period(), y.data());
  double apart = 0;
  for (int i = 0; i < n; ++i)
    apart = std::max({apart, std::abs(y[i] + closed.y[i]) / size[i], std::abs(after[i] + before[i]) / size[n + i]});
  constexpr double same = 1e-5;
  return apart < std::max(same, 1e3 * tolerance) ? "symmetric" : "twin";
}

/// Errors of the metrics of a period from those at a coarser tolerance. `known`: what is left of the period beside
/// that, as a part of its size.
void state_errors(PeriodRecord& fine, const PeriodRecord& coarse, double known) {
  for (auto& [name, measure] : fine.metrics) {
    const bool is_phase = name.find("_phase_") != std::string::npos;  // coordinates may be angles, too
    double apart = measure.value - coarse.metrics.at(name).value, size = std::abs(measure.value);
    if (is_phase) apart = std::remainder(apart, 2 * std::numbers::pi), size = std::max(size, 1.0);
    // What is left of the period is a part of the whole oscillation, and of a small harmonic more.
    if (const auto n = name.rfind('_'); is_phase || name.find("_harmonic_") != std::string::npos) {
      const auto of = name.substr(0, name.rfind('_', n - 1)) + "_harmonic_";
      const double first = fine.metrics.at(of + "1").value, own = fine.metrics.at(of + name.substr(n + 1)).value;
      size = std::max(size, is_phase && own > 0 ? first / own : first);
    }
    for (const std::string_view end : {"_max", "_min", "_mean"})  // in which an oscillation may cancel
      if (name.ends_with(end))
        size = std::max(size, fine.metrics.at(name.substr(0, name.size() - end.size()) + "_amplitude").value);
    measure.error = std::abs(apart) + known * size;
  }
}

/// One more period of a slider's cycle, followed as a structure of one coordinate from its first point.
struct SliderPeriod {
  StructureSystem system;
  PeriodRecord record;
  Outcome outcome;
  double closure = 0;  ///< how far it ends from its start, as a part of the range of displacement or slip rate

  SliderPeriod(const Model& model, const Cycle& cycle, double tolerance, double stick_threshold)
      : system(oscillators::one_slider(model)), record(system, tolerance, stick_threshold) {
    const auto& first = cycle.orbit.front();
    const double V = model.drive.speed.level(), N = model.drive.normal_load.level();
    // What a structure adds to the unknowns of a slider without mass is its slip rate, and to those of one without a
    // damper as well, whose spring is in series with the contact, all of the mechanics.
    const oscillators::SliderSystem slider(model);
    std::vector<double> y =
        slider.unknowns_at(0, first.displacement, first.slip_rate, first.state, first.friction_coefficient * N);
    if (slider.mechanics() == oscillators::Mechanics::damped) y.insert(y.begin() + 1, first.slip_rate);
    if (slider.mechanics() == oscillators::Mechanics::elastic)
      y = system.unknowns_at(0, VectorXd::Constant(1, first.displacement), VectorXd::Constant(1, V - first.slip_rate),
                             {first.state});
    Follower follower(system, tolerance);
    follower.observe = [this](Follower::Step& step, std::span<const Follower::Event> switches) {
      record.add(step, switches);
    };
    outcome = follower.follow(0, y, cycle.metrics.period);
    if (!outcome.complete()) return;
    record.finish(cycle.metrics.period);
    const auto range = [&](const char* name) { return 2 * record.metrics.at(std::string(name) + "_amplitude").value; };
    closure = std::max(std::abs(y[0] - first.displacement) / range("displacement"),
                       std::abs(system.slip_rate(0, 0, y.data()) - first.slip_rate) / range("slip_rate"));
  }
  /// Maxima of the displacement.
  int returns() const {
    const auto& velocity = record.record.values[1];
    int maxima = 0;
    double before = velocity.back();
    for (std::size_t i = 1; i < velocity.size(); before = velocity[i++]) maxima += before > 0 && velocity[i] <= 0;
    return maxima;
  }
};

/// The columns of a slider's cycle, those of a structure of one coordinate.
void take_orbit(const Model& model, const Cycle& cycle, StructureCycle& result) {
  const StructureSystem system(oscillators::one_slider(model));
  const motion::StructureRecord record(system);
  result.column_names = record.names, result.column_units = record.units;
  result.columns.resize(record.names.size());
  const double V = model.drive.speed.level(), N = model.drive.normal_load.level();
  for (const auto& point : cycle.orbit) {
    result.time.push_back(point.time);
    std::vector<double> row = {point.displacement, V - point.slip_rate, point.slip_rate, N * point.friction_coefficient,
                               point.friction_coefficient};
    row.insert(row.end(), point.state.begin(), point.state.end());
    row.resize(5 + model.law->states().size(), std::numeric_limits<double>::quiet_NaN());  // some dry curves have none
    row.push_back(point.acceleration);
    for (std::size_t c = 0; c < result.columns.size(); ++c) result.columns[c].push_back(row[c]);
  }
}

}  // namespace

std::map<std::string, StructureCycle::Measure> cycle_metrics_of(const Structure& structure) {
  const StructureSystem system(structure);
  PeriodRecord none(system);
  none.finish(1);
  return none.metrics;
}

StructureCycle find_cycle(const motion::StructureModel& model, const StructureCycleOptions& options) {
  require(options.tolerance, {1e-11, 0.1}, "tolerance", "relative accuracy of a cycle", "1");
  if (!model.structure.sampled.empty())
    throw InputError("a servo that samples has a clock of its own, of which the motion's periods are no multiples");
  SectionMap map(model.structure);
  map.most_steps = options.most_steps;
  model.structure.require_drive();
  StructureCycle result;
  RecurrenceSearch search(map, model, options);
  auto recurrence = search.search();
  result.cost = {map.count.steps, map.count.evaluations, search.crossings()};
  result.outcome = recurrence.outcome;
  result.start = search.last();
  if (recurrence.returns == 0) {
    if (options.exponent && result.outcome.ending == Ending::budget_spent && !result.start.empty()) {
      auto last = model;
      last.start.unknowns = result.start;
      result.exponent = largest_exponent(last, search.mean_return(), search.crossings());
      result.outcome = outcome_of(result.exponent, search.crossings(), result.outcome);
    }
    return result;
  }
  // Two passes show the error of the coarser; where that is above the tolerance, a third shows that of the second.
  constexpr double finer = 1.0 / 30, least = 3e-14;
  constexpr int most_passes = 4;
  double tolerance = 0.1 * options.tolerance, worst = infinity;
  std::optional<Period> coarse, fine;
  std::vector<double> near = recurrence.closed.y;
  for (int pass = 0; pass < most_passes && worst > options.tolerance; ++pass) {
    auto closed = close(map, near, recurrence.returns, tolerance, recurrence.size, options.tolerance);
    if (!closed.found) {
      result.outcome = {Ending::tolerance_not_met,
                        fmt::format("Newton's method closes the period to {:.1e} of its range only", closed.change)};
      constexpr double rough = 1e-4;  // a period that closes to less is shown, without errors
      if (!fine && closed.change < rough)
        fine.emplace(map, std::move(closed), recurrence.returns, tolerance, options.stick_threshold);
      break;
    }
    near = closed.y;
    if (fine) coarse.emplace(std::move(*fine));
    fine.emplace(map, std::move(closed), recurrence.returns, tolerance, options.stick_threshold);
    if (coarse) {
      // Each coordinate within the range of the widest of its unit: those that hardly move matter less.
      std::map<std::string, double> widest;
      const auto& structure = model.structure;
      std::vector<double> size(near.size());
      map.system().scale(near.data(), size.data());
      for (std::size_t i = 0; i < fine->coordinate_max.size(); ++i) {
        double& range = widest[structure.unit(int(i))];
        range = std::max(range, fine->coordinate_max[i] - fine->coordinate_min[i]);
      }
      state_errors(*fine, *coarse, std::max(tolerance, fine->closed.change));
      worst = std::max(fine->closed.change, fine->metrics["period"].error / fine->duration);
      for (std::size_t i = 0; i < fine->coordinate_max.size(); ++i) {
        const double range = std::max(widest[structure.unit(int(i))], 1e-3 * size[i]);  // not that of a rest
        worst = std::max({worst, std::abs(fine->coordinate_max[i] - coarse->coordinate_max[i]) / range,
                          std::abs(fine->coordinate_min[i] - coarse->coordinate_min[i]) / range});
      }
    }
    if (tolerance <= least) break;
    tolerance = std::max(tolerance * finer, least);
  }
  result.cost.steps = map.count.steps, result.cost.evaluations = map.count.evaluations;
  if (!fine) return result;
  if (!map.driven() && stands_still(*fine)) {
    result.outcome = {Ending::none_exists, at_rest_or_sliding};
    return result;
  }
  result.returns = recurrence.returns;
  result.metrics = fine->metrics;
  result.coordinate_max = fine->coordinate_max, result.coordinate_min = fine->coordinate_min;
  result.events = fine->events;
  result.start = fine->closed.y;
  result.column_names = fine->record.names, result.column_units = fine->record.units;
  result.time = fine->time, result.columns = fine->record.values;
  result.symmetry = symmetry_of(map, fine->closed, recurrence.returns, tolerance, recurrence.size);
  if (options.multipliers && coarse) {
    auto known = known_multipliers(coarse->multipliers, fine->multipliers);
    result.multipliers = std::move(known.values), result.multiplier_errors = std::move(known.errors);
    result.multipliers_left_out = std::move(known.left_out);
  }
  result.stable = !fine->multipliers.empty() && std::abs(fine->multipliers.front()) < 1;
  if (result.outcome.complete() && worst > options.tolerance)
    result.outcome = {Ending::tolerance_not_met, fmt::format("the period is known to {:.1e} only", worst)};
  return result;
}

StructureCycle find_measured_cycle(const Model& model, const CycleOptions& options) {
  const Cycle cycle = find_cycle(model, options);
  StructureCycle result;
  result.outcome = cycle.outcome;
  result.ill_conditioned_stick = cycle.ill_conditioned_stick, result.growth = cycle.growth;
  result.multipliers = cycle.multipliers, result.multiplier_errors = cycle.multiplier_errors;
  result.multipliers_left_out = cycle.multipliers_left_out;
  result.stable = cycle.stable, result.exponent = cycle.exponent;
  result.cost = {cycle.cost.steps, cycle.cost.evaluations, cycle.cost.cycles};
  const bool found = cycle.metrics.period > 0;
  if (found) {
    take_orbit(model, cycle, result);
    constexpr double finer = 1.0 / 30, least = 3e-14, another = 1e-2;
    const double tolerance = std::max(0.1 * options.tolerance, least / finer);
    const Model followed = without_clock(model).value_or(model);
    SliderPeriod fine(followed, cycle, finer * tolerance, options.stick_threshold);
    const SliderPeriod coarse(followed, cycle, tolerance, options.stick_threshold);
    result.returns = std::max(1, fine.returns());
    const double closure = std::max(fine.closure, coarse.closure);
    const Outcome& outcome = fine.outcome.complete() ? coarse.outcome : fine.outcome;
    if (!outcome.complete()) {
      result.metrics_left_out = fmt::format("metrics left out: one more period ends as {}", outcome.detail);
    } else if (!(closure < another)) {
      result.metrics_left_out =
          fmt::format("metrics left out: one more period ends {:.1e} of its range from its start", closure);
    } else {
      const auto& [metrics, error] = std::pair(cycle.metrics, cycle.error);
      const double fastest = std::max(std::abs(metrics.slip_rate_max), std::abs(metrics.slip_rate_min));
      const double known =  // as certified
          std::max(
              {closure, error.period / metrics.period, error.slip_rate_max / fastest, error.slip_rate_min / fastest});
      state_errors(fine.record, coarse.record, std::max(finer * tolerance, known));
      result.metrics = std::move(fine.record.metrics);
      result.coordinate_max = fine.record.coordinate_max, result.coordinate_min = fine.record.coordinate_min;
      result.events = std::move(fine.record.events);
    }
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [name, unit, meaning, member] : metric_names())
    result.metrics[name] = {found ? cycle.metrics.*member : none, found ? cycle.error.*member : none, unit, meaning};
  return result;
}

}  // namespace rosin::analysis::cycles
