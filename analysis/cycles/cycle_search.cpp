/// Search for a cycle: from stick through passages, Newton's method on the return map, the balance of slow drift.
#include "analysis/cycles/cycle_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>
#include <numbers>

#include "analysis/cycles/irregular_motion.hpp"
#include "analysis/cycles/multipliers.hpp"
#include "analysis/cycles/stick_slip_period.hpp"
#include "core/linear_solve.hpp"
#include "oscillators/time_scales.hpp"

namespace rosin::analysis::cycles {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double spectral_radius(const FixedPoint& point, const ReturnMap& map) {
  const auto values = multipliers_of(point.derivative, map.scale());
  return values.empty() ? 0 : std::abs(values.front());
}

namespace {

/// The fixed point that a balanced swing is.
FixedPoint fixed_point_of(const ReturnMap& map, const SlowEnd& end) {
  const auto n = map.scale().size(), states = end.balance->state_derivative.rows();
  FixedPoint point{end.balance->y, MatrixXd::Zero(n, n), 1, end.balance->amplitude};
  point.derivative(0, 0) = std::min(1 + end.slope, std::nextafter(1.0, 0.0));
  point.derivative.bottomRightCorner(states, states) = end.balance->state_derivative;
  point.swing = end;
  return point;
}

/// Tolerances of the search for motions of the size of the drive speed. The second and third serve where what steps err
/// at the first is no small part of the motion when the passage ends, as after ringing on bristles.
constexpr double search_tolerances[] = {1e-6, 1e-9, 1e-12};
/// Of one search at one of them: as much work with many unknowns as with few.
long most_steps_of(const ReturnMap& map) { return std::min(1'000'000L, 4'000'000L / map.system().size()); }
constexpr double collapsed = 1e-5;  ///< amplitudes |v − V|/V below this are steady sliding

/// Small motions are followed more closely: what matters are errors against their drift, which falls with A². So are
/// those of a slow `drift` ln(A'/A) in a passage.
double search_tolerance(double amplitude, double drift, double loose) {
  return std::clamp(1e-3 * std::abs(drift), 1e-13, loose) * std::clamp(amplitude * amplitude, 1e-6, 1.0);
}

/// Newton's method for y = P(y), kept from falling onto steady sliding, which is a fixed point too.
std::optional<FixedPoint> newton(ReturnMap& map, std::vector<double> y, int turns, double amplitude, double drift,
                                 double loose) {
  const double least_amplitude = 0.4 * amplitude, tolerance = search_tolerance(amplitude, drift, loose);
  // In near-stick a slip at many times V is but a few scales away.
  const double size = std::min(amplitude, map.distance(y, map.system().steady(0)));
  const VectorXd scale = map.scale();
  const MatrixXd I = MatrixXd::Identity(scale.size(), scale.size());
  std::vector<double> last = y;
  VectorXd step;
  double residual = infinity, factor = 1;
  int halvings = 0;
  for (int iteration = 0; iteration < 14; ++iteration) {
    const auto passage = map.follow(y, tolerance, turns, true, Derivative::of_steps, nullptr, dip_of(amplitude));
    const double now = passage.outcome.complete() ? map.distance(passage.end, y) / std::max(size, 1e-12) : infinity;
    if (passage.amplitude < least_amplitude || !(now < residual)) {
      if (iteration == 0 || ++halvings > 2) return std::nullopt;
      factor *= 0.3;
      y = map.moved(last, step, factor);
      continue;
    }
    halvings = 0;
    const MatrixXd A = scale.cwiseInverse().asDiagonal() * (I - passage.derivative) * scale.asDiagonal();
    step = scale.asDiagonal() * solve_linear(A, scale.cwiseInverse().asDiagonal() * map.difference(passage.end, y));
    if (!step.allFinite()) return std::nullopt;
    const double length = map.length(step) / std::max(size, 1e-12);
    // What weak attraction leaves of rounding in a passage is not small.
    const double left = 0.1 * tolerance / std::max(std::abs(drift), tolerance);
    const double rounding = std::min(1e-15 / (size * std::abs(drift)), 1e-3);
    if (length < std::max({30 * tolerance, 1e-8, left, rounding}))
      return FixedPoint{map.moved(y, step, 1), passage.derivative, turns, passage.amplitude};
    last = y;
    residual = std::max(now, 1e-3 * tolerance);
    factor = std::min(1.0, 0.5 / length);
    y = map.moved(last, step, factor);
  }
  return std::nullopt;
}

/// Relaxation oscillations forget all but the time within one passage, while slips at 10¹⁰ V leave nothing of the
/// derivative but rounding. Where passages have come to repeat themselves, neighbouring ones show whether they are led
/// back, and by how much.
std::optional<FixedPoint> settled(ReturnMap& map, const std::vector<double>& y, int turns, double amplitude,
                                  double loose) {
  const double dip = dip_of(amplitude), size = map.distance(y, map.system().steady(0));
  const auto passage = map.follow(y, loose, turns, true, Derivative::none, nullptr, dip);
  const double change = map.distance(passage.end, y);
  if (!passage.outcome.complete() || !(change < 1e-2 * size)) return std::nullopt;
  // A slow drift repeats itself too.
  constexpr double noise = 30, dies_out = 0.5;
  if (change > noise * loose * size) {
    const auto next = map.follow(passage.end, loose, turns, true, Derivative::none, nullptr, dip);
    if (!next.outcome.complete() || map.distance(next.end, passage.end) > dies_out * change) return std::nullopt;
  }
  const int n = int(map.differential().size());
  FixedPoint point{passage.end, MatrixXd::Zero(n, n), turns, passage.amplitude, true};
  const double share = 0.05 * std::min(size, 2.0);
  // On both sides: beyond a reversal friction may lead back what on this side it leaves alone.
  for (int k = 0; k < n; ++k)
    for (const double side : {1.0, -1.0}) {
      const VectorXd step = VectorXd::Unit(n, k) * (side * share * map.scale()[k]);
      const auto start = map.moved(y, step, 1);
      if (start == y) continue;  // off the section
      auto neighbour = map.follow(start, loose, turns, true, Derivative::none, nullptr, dip);
      if (neighbour.outcome.complete() && neighbour.duration < 0.5 * passage.duration)  // it began beside the section
        neighbour = map.follow(neighbour.end, loose, turns, true, Derivative::none, nullptr, dip);
      if (!neighbour.outcome.complete()) return std::nullopt;
      VectorXd led = map.difference(neighbour.end, passage.end) / step[k];
      // A passage more or less leads to another place of the same cycle.
      for (int more = 1; more < turns && map.length(led) * std::abs(step[k]) > share; ++more) {
        neighbour = map.follow(neighbour.end, loose, 1, true, Derivative::none, nullptr, dip);
        if (!neighbour.outcome.complete()) return std::nullopt;
        led = map.difference(neighbour.end, passage.end) / step[k];
      }
      if (map.length(led) > map.length(point.derivative.col(k))) point.derivative.col(k) = led;
    }
  return point;
}

/// Near a Hopf point the amplitude drifts slowly along one direction. This finds where the drift per passage,
/// r(A) = ln(A'/A), falls through zero: a stable cycle. A is the distance of the section point from steady sliding,
/// which is smooth. `y` lies on the section.
struct Balance {
  std::optional<std::vector<double>> y;  ///< a section point near the cycle
  bool dies_out = false;  ///< the drift is towards steady sliding at every amplitude below that of the start
};
Balance balance_of_drift(ReturnMap& map, const std::vector<double>& y, double amplitude, double drift_at_rest,
                         double loose) {
  const auto steady = map.system().steady(0);
  const double start = map.distance(y, steady), least = 0.02 * start / amplitude;
  VectorXd direction = map.difference(y, steady) / start;
  const long last_step = map.cost().steps + most_steps_of(map) / 8;  // irregular motion has no such amplitude
  struct Drift {
    double size, rate;
    std::vector<double> y;
  };
  // The first passages relax the fast directions; the drift is known once the next shows the same.
  const auto drift = [&](double size) -> std::optional<Drift> {
    constexpr int most_passages = 8;
    constexpr double same = 0.02;
    const double A = amplitude * size / start, tolerance = search_tolerance(A, drift_at_rest, loose), dip = dip_of(A);
    auto y = map.moved(steady, direction, size);
    double before = 0, rate = infinity;
    for (int k = 0; k < most_passages; ++k) {
      const auto passage = map.follow(y, tolerance, 1, true, Derivative::none, nullptr, dip);
      if (!passage.outcome.complete() || map.cost().steps > last_step) return std::nullopt;
      const double a = before, last = rate, b = map.distance(passage.end, steady);
      if (!(b > 0)) return std::nullopt;
      y = passage.end;
      before = b;
      if (k == 0) continue;
      rate = std::log(b / a);
      if (std::abs(rate - last) <= same * std::max(std::abs(rate), std::abs(drift_at_rest))) break;
    }
    direction = map.difference(y, steady) / before;
    return Drift{before, rate, y};
  };
  auto high = drift(start);
  if (!high) return {};
  // The lower end: drift that grows. At rest it is that of the linear mode; above a stable steady state it is sought.
  double low = 0, low_rate = drift_at_rest;
  for (int larger = 0; high->rate > 0; ++larger) {
    low = high->size, low_rate = high->rate;
    high = drift((larger < 8 ? 1.05 : 1.25) * low);
    if (!high || high->size <= low || larger > 40) return {};  // what is larger falls back within a few passages
  }
  for (double size = 0.8 * high->size; low_rate <= 0 && size > least; size *= 0.8) {
    const auto here = drift(size);
    if (!here) return {};
    if (here->rate > 0)
      low = here->size, low_rate = here->rate;
    else
      high = here;
  }
  if (low_rate <= 0) return {.y = {}, .dies_out = true};
  // Drift is nearly linear in the squared amplitude; the end that stays twice counts half (Illinois).
  const double growth = low_rate;
  double high_rate = high->rate;
  for (int iteration = 0, stays = 0; iteration < 30; ++iteration) {
    const double l2 = low * low, h2 = high->size * high->size, width = h2 - l2;
    const double a2 = std::clamp(l2 + width * low_rate / (low_rate - high_rate), l2 + 1e-4 * width, h2 - 1e-4 * width);
    const auto here = drift(std::sqrt(a2));
    if (!here) return {};
    if (std::abs(here->rate) < 0.02 * growth || width < 1e-3 * h2) return {here->y};
    if (here->rate > 0) {
      low = here->size, low_rate = here->rate;
      if (stays > 0) high_rate *= 0.5;
      stays = 1;
    } else {
      high = here, high_rate = here->rate;
      if (stays < 0) low_rate *= 0.5;
      stays = -1;
    }
  }
  return {high->y};
}

/// Motion that changes slowly and steadily from passage to passage is taken ahead by many passages at once: to where
/// the secant through the last two changes has them end, and no further than a share of its size.
class Leaps {
 public:
  explicit Leaps(const ReturnMap& map) : map_(map) {}

  /// After a passage that ended at `y`. `size`: distance from steady sliding, in scales.
  void passed(const std::vector<double>& y, double size) {
    const bool known = !last_.empty();
    const VectorXd change = known ? VectorXd(map_.difference(y, last_).array() / map_.scale().array())
                                  : VectorXd::Zero(map_.scale().size());
    constexpr double slow = 0.03, same = 0.2, jump = 0.3;
    steady_ = known && change_.size() && change.norm() < slow * size && change.norm() > 0 &&
              (change - change_).norm() < same * change.norm();
    pace_ = known ? change.norm() / size : infinity;
    constexpr double die_out = 0.3;
    dies_out_ = known && change_.size() && change.norm() <= die_out * change_.norm();
    // Ringing that decays until slip sticks, and begins anew after the next: a period of many passages.
    if (passages_ > 0 && known && pace_ > jump) useless_ = true;
    if (known) change_ = change;
    last_ = y;
    size_ = size;
  }
  bool ready() const { return steady_ && !useless_ && leaps_ < most_leaps; }
  /// Change in one passage as a part of the size; infinite where not known.
  double pace() const { return pace_; }
  /// Between leaps, as long as the changes do not die out: no cycle is near.
  bool under_way() const { return passages_ > 0 && remaining_ > 0.3 && !dies_out_ && !useless_ && leaps_ < most_leaps; }

  /// The point so many passages ahead.
  std::vector<double> ahead() {
    constexpr double first = 4, most_growth = 4, share = 0.3;
    double passages = first;
    if (passages_ > 0) {
      remaining_ = change_.dot(before_) / before_.squaredNorm();
      passages = passages_ * (remaining_ < 1 ? std::min(1 / (1 - remaining_), most_growth) : most_growth);
    }
    passages_ = std::min(passages, share * size_ / change_.norm());
    before_ = change_;
    from_ = last_;
    forget();
    ++leaps_;
    return map_.moved(from_, before_.cwiseProduct(map_.scale()), passages_);
  }
  /// A shorter leap from the same point where the last ended motion. Nothing if that was no longer than one passage.
  std::optional<std::vector<double>> shorter() {
    if (!(passages_ > 1) || !last_.empty()) return std::nullopt;
    passages_ *= 0.25;
    return map_.moved(from_, before_.cwiseProduct(map_.scale()), passages_);
  }

 private:
  void forget() {
    last_.clear();
    change_.resize(0);
    steady_ = false;
  }
  static constexpr int most_leaps = 100;  // more lead in circles
  const ReturnMap& map_;
  std::vector<double> last_, from_;  ///< of the last passage; where the last leap began
  VectorXd change_, before_;         ///< in the last passage, in the one before the last leap; in scales
  double size_ = 0, pace_ = infinity, passages_ = 0, remaining_ = 1;
  bool steady_ = false, useless_ = false, dies_out_ = false;
  int leaps_ = 0;
};

/// The search for a stable fixed point of the return map, from starts in stick or the one that is given.
class Search {
 public:
  /// `drift_at_rest`: growth of a small oscillation about steady sliding in one period, ln(A'/A).
  Search(ReturnMap& map, double drift_at_rest, const CycleOptions& options)
      : map_(map),
        options_(options),
        drift_at_rest_(drift_at_rest),
        most_steps_(most_steps_of(map)),
        most_passages_(steady_is_stable() ? std::min(options.max_cycles, 12) : options.max_cycles) {}

  /// Looks for the point; where none is found, `outcome` says why.
  void run() {
    std::vector<double> wandering;  // the end of a long search
    for (const double tolerance : search_tolerances) {
      loose_ = tolerance;
      reached_.clear();
      last_step_ = map_.cost().steps + most_steps_;
      tried_ = 0;
      run_once();
      if (point || outcome.ending != Ending::budget_spent) return;
      if (reached_.size() == some) wandering = reached_.back();
      if (!errs_in_passages()) break;
    }
    if (wandering.empty()) return;
    map_.allow(ReturnMap::most_steps);
    if (const auto parting = parting_from(map_, wandering))
      outcome = {
          Ending::none_exists,
          fmt::format("no two periods are alike: neighbouring motions part by a factor of e^({:.2g} ± {:.1g}) in "
                      "a passage, on the mean of {}",
                      parting->rate, parting->error, parting->passages)};
  }

  std::optional<FixedPoint> point;
  Outcome outcome;

 private:
  static constexpr int transient = 10;            ///< passages
  static constexpr int relaxed = 16;              ///< passages; by then slow motion is a swing, if it is one
  static constexpr double hardly_changes = 1e-2;  ///< what slow motion changes in a passage, of its size
  static constexpr std::size_t some = 8;          ///< passages

  void run_once() {
    if (!options_.near.empty()) {
      const auto passage = map_.follow(options_.near, loose_, 1, true);
      begin_at(options_.near);
      visited_.push_back(passage.end);
      const bool ends = passage.outcome.complete() && accept(passage.end, 1, passage.amplitude, infinity);
      if (ends && (point || !outcome.complete())) return;  // else it has died out, which says nothing of other starts
    }
    // From stick with the state of steady sliding, then from longer stick: its larger first slip can lie in the basin
    // of a cycle beside stable sliding that the first start misses, and does not fall straight onto an unstable steady
    // state.
    const double V = map_.drive_speed();
    std::vector<double> ages = {V};
    if (!options_.start) ages.push_back((steady_is_stable() ? 1e-4 : 0.1) * V);
    for (const double aged_at : ages) {
      try {
        from(options_.start ? motion::starting_point(map_.system(), *options_.start) : map_.stick(aged_at));
      } catch (const InputError& e) {
        outcome = {Ending::not_finite, e.what()};
      }
      if (point) return;
    }
  }

  /// True if what steps err in one of the last passages is no small part of the motion when it ends.
  bool errs_in_passages() {
    constexpr double small = 1e-5, closer = 1e-3;
    for (const auto& y : reached_) {
      const auto loosely = map_.follow(y, loose_, 1, true), closely = map_.follow(y, closer * loose_, 1, true);
      if (loosely.outcome.complete() && closely.outcome.complete() &&
          map_.distance(loosely.end, closely.end) > small * distance_from_steady(y))
        return true;
    }
    return false;
  }

  bool steady_is_stable() const { return drift_at_rest_ < 0; }
  double distance_from_steady(const std::vector<double>& y) const { return map_.distance(y, map_.system().steady(0)); }
  bool attracts(const std::optional<FixedPoint>& candidate) const {
    return candidate && candidate->amplitude >= collapsed && spectral_radius(*candidate, map_) < 1;
  }

  /// Follows the motion from y until a stable fixed point is found, or it is known why none is.
  void from(std::vector<double> y) {
    outcome = steady_is_stable()
                  ? Outcome{Ending::none_exists, fmt::format("the motion started from {} dies out onto steady sliding",
                                                             options_.start ? "the given start" : "stick")}
                  : Outcome{Ending::budget_spent, fmt::format("no periodic motion within {} passages", most_passages_)};
    begin_at(y);
    Leaps leaps(map_);
    double tolerance = loose_, last_amplitude = 1;
    bool enlarged = false;
    balanced_ = false;
    next_attempt_ = 2;
    for (int k = 0; k < most_passages_; ++k) {
      const long steps_before = map_.cost().steps;
      const auto passage = map_.follow(y, tolerance, 1, k > 0, Derivative::none, nullptr, dip_of(last_amplitude));
      most_taken_ = std::max(most_taken_, map_.cost().steps - steps_before);
      if (!passage.outcome.complete()) {
        if (const auto nearer = leaps.shorter()) {
          y = *nearer;
          continue;
        }
        if (passage.outcome.ending != Ending::budget_spent || !steady_is_stable()) outcome = passage.outcome;
        return;
      }
      if (map_.cost().steps > last_step_) {
        outcome = {Ending::budget_spent, fmt::format("no periodic motion within {} steps", most_steps_)};
        return;
      }
      y = passage.end;
      lasted_.push_back(passage.duration);
      if (k > transient) reached_.push_back(y);
      if (reached_.size() > some) reached_.pop_front();
      visited_.push_back(y);
      const double amplitude = last_amplitude = passage.amplitude;
      if (k > 0 && steady_is_stable() && amplitude < 0.02) return;
      if (!steady_is_stable() && !enlarged && amplitude < 1e-3) {
        if (amplitude < 1e-11) return;
        y = grown(y, amplitude);
        begin_at(y);
        enlarged = true;
        continue;
      }
      leaps.passed(y, distance_from_steady(y));
      // A drift is followed as closely as it takes to see it.
      tolerance = std::clamp(1e-3 * leaps.pace(), 1e-13, loose_);
      // A trial that takes far longer has strayed into stick or onto steady sliding.
      constexpr long times = 20, few = 1'000;
      map_.allow(times * most_taken_ + few);
      const bool slow = k <= relaxed && std::has_single_bit(unsigned(k)) &&
                        (leaps.pace() < hardly_changes || friction_over_swing(map_.system().model()) < weak_friction);
      Attempt attempted = Attempt::goes_on;
      if (slow && !leaps.under_way()) attempted = follow_swing(y).value_or(Attempt::goes_on);
      if (attempted == Attempt::goes_on) {
        // Trials leave half of the steps to the motion.
        const long before = map_.cost().steps;
        attempted = attempt(k, amplitude, leaps.under_way());
        tried_ += map_.cost().steps - before;
      }
      map_.allow(ReturnMap::most_steps);
      if (attempted == Attempt::ends) return;
      if (!steady_is_stable() && leaps.ready()) {
        y = leaps.ahead();
        begin_at(y);
      }
    }
  }

  /// An overdamped start has all but reached steady sliding, which repels: goes on from where growth would lead.
  std::vector<double> grown(const std::vector<double>& y, double amplitude) const {
    const auto steady = map_.system().steady(0);
    // States that changed more than the speed did are not carried away by it.
    return map_.moved(steady, map_.difference(y, steady), std::min(0.1 / amplitude, 1 / map_.distance(y, steady)));
  }

  enum class Attempt { goes_on, ends };
  /// After passage k, the last of those visited: tries to take the motion for a cycle, where it nearly repeats itself,
  /// and now and then where it does not.
  Attempt attempt(int k, double amplitude, bool leaping) {
    const auto& y = visited_.back();
    const int passages = int(visited_.size()) - 1;  // since the start or the last leap
    if (const auto recurring = recurs(amplitude)) {
      point = recurring;
      outcome = {};
      return Attempt::ends;
    }
    if (tried_ > most_steps_ / 2) return Attempt::goes_on;
    const double size = distance_from_steady(y);
    const double moved = passages > 0 ? map_.distance(y, visited_[passages - 1]) : infinity;
    const double change = moved / std::min(amplitude, size);
    // Several passages in a period: as many as bring the motion nearly back.
    constexpr int few = 8;
    const auto came_back = [&](int turns) {
      const double back = map_.distance(y, visited_[passages - turns]);
      return back < 0.2 * moved && (turns <= few || back < std::min(0.01 * size, 0.02 * moved)) ? back : infinity;
    };
    bool many = false;
    for (int turns = few + 1; turns < passages; ++turns) many = many || came_back(turns) < infinity;
    if (!many && (leaping || (k < next_attempt_ && !(change < 1e-3)))) return Attempt::goes_on;
    next_attempt_ = k + std::max(2, k / 2);
    // Motion that hardly drifts is not waited for.
    constexpr double slow = 1e-3;
    const bool drifts = k >= 2 && std::abs(drift_at_rest_) < slow && amplitude < 10 && !balanced_;
    if (!drifts && accept(y, 1, amplitude, moved)) return Attempt::ends;
    constexpr long as_often = 10;  // a trial follows the motion through its turns
    for (int turns = 2; turns < passages; ++turns) {
      const double back = came_back(turns);
      const bool affordable = turns <= few || tried_ + as_often * turns * most_taken_ < most_steps_ / 2;
      if (back < infinity && affordable && accept(y, turns, amplitude, back)) return Attempt::ends;
    }
    return k >= 6 || (steady_is_stable() && k >= 3) || drifts ? balance(y, amplitude) : Attempt::goes_on;
  }

  /// Stick forgets the swing that led to it, and slips at 10¹⁰ V leave nothing of a derivative that would say so.
  /// Motion that sticks has come to its cycle where four periods have brought it back to rounding and led nowhere.
  std::optional<FixedPoint> recurs(double amplitude) const {
    const auto& slider = map_.system().model().slider;
    const auto& y = visited_.back();
    const int last = int(visited_.size()) - 1;
    if (map_.system().mechanics() != oscillators::Mechanics::inertial) return std::nullopt;
    // Two periods that are the same to the last digits that hold are as good as four that scatter.
    constexpr double rounding = 1e-5, last_digits = 1e-9, nowhere = 2, longer_than_swings = 1.5;
    const double swing = 2 * std::numbers::pi * std::sqrt(slider.mass / slider.stiffness);
    const double size = distance_from_steady(y);
    const auto repeats = [&](int turns, int periods, double within) {
      double farthest = 0;
      for (int k = 0; k < periods && farthest <= within * size; ++k)
        farthest = std::max(farthest, map_.distance(visited_[last - k * turns], visited_[last - (k + 1) * turns]));
      return farthest <= within * size && map_.distance(y, visited_[last - periods * turns]) <= nowhere * farthest;
    };
    for (int turns = 1; 2 * turns <= last; ++turns) {
      if (!repeats(turns, 2, last_digits) && !(4 * turns <= last && repeats(turns, 4, rounding))) continue;
      if (*std::max_element(lasted_.end() - turns, lasted_.end()) < longer_than_swings * swing) continue;
      if (turns == 1) return std::nullopt;  // neighbours tell whether it is led back, or only changes slowly
      const auto n = map_.scale().size();
      constexpr double at_most = 0.5;  // of a change is left after a period, or it would not have been lost so soon
      return FixedPoint{.y = y,
                        .derivative = at_most * MatrixXd::Identity(n, n),
                        .turns = turns,
                        .amplitude = amplitude,
                        .by_differences = true,
                        .bounded = true};
    }
    return std::nullopt;
  }

  /// After a passage to y that hardly changed the motion: what becomes of it; nothing if it is no swing whose growth
  /// tells.
  std::optional<Attempt> follow_swing(const std::vector<double>& y) {
    constexpr double closely = 1e-9, dead = 0.02;
    const auto swing = slow_swing_from(map_, y, closely);
    if (!swing) return std::nullopt;
    const auto end = follow_slow_swing(map_, *swing, closely);
    constexpr double leaves_alone = 1e-12;  // so that metrics to 1e-6 hold for a million turns
    // What a contact that remembers does in a turn is known to the last digits of the swing.
    const bool tells = swing->turnover > leaves_alone || !oscillators::remembers(map_.system().model());
    if (end.balance && tells) return accept_swing(end);
    if (steady_is_stable()) return end.last->amplitude < dead ? Attempt::ends : Attempt::goes_on;
    if (std::abs(swing->growth) < leaves_alone) {
      point = FixedPoint{.y = swing->y, .derivative = {}, .amplitude = swing->amplitude};
      point->free = {begun_, int(visited_.size()), swing->growth};
      outcome = {};
      return Attempt::ends;
    }
    return sticks_at_random(end, *swing) ? Attempt::ends : Attempt::goes_on;
  }

  Attempt accept_swing(const SlowEnd& end) {
    const auto candidate = fixed_point_of(map_, end);
    if (!attracts(candidate)) return Attempt::goes_on;
    point = candidate;
    outcome = {};
    return Attempt::ends;
  }

  /// True if swings decay until the slider sticks, and the next differs by many turns of its decay with the place in a
  /// turn where that happens: no two periods are alike.
  bool sticks_at_random(const SlowEnd& end, const SlowSwing& swing) {
    constexpr double closely = 1e-11, noise = 1e3 * closely, many = 10;
    if (swing.growth > 0) return false;
    const auto again = return_after(map_, *end.last, swing, closely);
    if (!again || !(again->spread > std::max(noise, many * std::abs(again->growth)))) return false;
    outcome = {Ending::none_exists,
               fmt::format("no two periods are alike: a swing decays over {:.1g} turns until the slider sticks, and "
                           "where in a turn that happens moves the next swing by {:.1g} turns of its decay",
                           end.turns, again->spread / std::abs(again->growth))};
    return true;
  }

  /// Looks for the amplitude at which drift balances.
  Attempt balance(const std::vector<double>& y, double amplitude) {
    balanced_ = true;
    const auto balanced = balance_of_drift(map_, y, amplitude, drift_at_rest_, loose_);
    if (balanced.y) {
      const auto there = map_.follow(*balanced.y, search_tolerance(amplitude, drift_at_rest_, loose_), 1, true,
                                     Derivative::none, nullptr, dip_of(amplitude));
      if (there.outcome.complete() && accept(there.end, 1, there.amplitude, infinity)) return Attempt::ends;
    }
    return balanced.dies_out ? Attempt::ends : Attempt::goes_on;
  }

  /// True if `turns` passages from y, which bring it back but for `change`, lead to a fixed point that attracts; it is
  /// then `point`.
  bool accept(const std::vector<double>& y, int turns, double amplitude, double change) {
    auto candidate = newton(map_, y, turns, amplitude, drift_at_rest_, loose_);
    constexpr double repeats = 1e-3, certainly = 0.5;
    const double size = distance_from_steady(y);
    if (!attracts(candidate) && change < repeats * size) {
      candidate = settled(map_, y, turns, amplitude, loose_);
      if (candidate && !(spectral_radius(*candidate, map_) < certainly)) return false;
    }
    if (!attracts(candidate)) return false;
    // Where a turn ends tells too little of a swing that friction hardly moves.
    constexpr double neutral = 1e-6;
    if (turns == 1 && spectral_radius(*candidate, map_) > 1 - neutral)
      if (const auto attempted = follow_swing(y)) return *attempted == Attempt::ends;
    point = candidate;
    outcome = {};
    return true;
  }

  /// Motion goes on from y, after the start or a leap.
  void begin_at(const std::vector<double>& y) {
    begun_ = y;
    visited_.clear();
    lasted_.clear();
  }

  ReturnMap& map_;
  const CycleOptions& options_;
  double drift_at_rest_;
  long most_steps_;  ///< of one search at one tolerance
  int most_passages_;
  double loose_ = search_tolerances[0];       ///< tolerance
  long last_step_ = 0;                        ///< at which the search ends
  long tried_ = 0;                            ///< steps of trials
  long most_taken_ = 0;                       ///< steps of a passage of the motion itself
  std::vector<double> begun_;                 ///< where the present motion began
  std::vector<std::vector<double>> visited_;  ///< ends of passages since the start or the last leap
  std::vector<double> lasted_;                ///< these, s
  std::deque<std::vector<double>> reached_;   ///< the last ends of passages after the transient
  int next_attempt_ = 2;                      ///< the passage after which a cycle is next looked for in any case
  bool balanced_ = false;                     ///< the balance of drift was looked for from this start
};

}  // namespace

SearchResult search_cycle(ReturnMap& map, double drift_at_rest, const CycleOptions& options) {
  Search search(map, drift_at_rest, options);
  search.run();
  return {std::move(search.point), std::move(search.outcome)};
}

}  // namespace rosin::analysis::cycles
