/// Search for a cycle: returns from stick, Newton's method on the return map, and the amplitude of zero growth.
#include "analysis/cycles/cycle_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>
#include <numbers>
#include <numeric>

#include "analysis/cycles/lyapunov.hpp"
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

/// The balanced oscillation `end` as a fixed point of the map.
FixedPoint fixed_point_of(const ReturnMap& map, const SlowEnd& end) {
  const auto n = map.scale().size(), states = end.balance->state_derivative.rows();
  FixedPoint point{end.balance->y, MatrixXd::Zero(n, n), 1, end.balance->amplitude};
  point.derivative(0, 0) = std::min(1 + end.slope, std::nextafter(1.0, 0.0));
  point.derivative.bottomRightCorner(states, states) = end.balance->state_derivative;
  point.swing = end;
  return point;
}

/// Tolerances of the search for motions of the size of the drive speed. The second and third serve where the error of
/// the steps at the first is no small part of the motion at the end of a return, as after ringing on bristles.
constexpr double search_tolerances[] = {1e-6, 1e-9, 1e-12};
/// Steps of one search at one tolerance. The bound falls with the number of unknowns, so that the work stays the same.
long most_steps_of(const ReturnMap& map) { return std::min(1'000'000L, 4'000'000L / map.system().size()); }
constexpr double collapsed = 1e-5;  ///< amplitudes |v − V|/V below this are steady sliding

/// The tolerance falls with A², because the amplitude growth against which errors count does, and with the `growth`
/// ln(A'/A) per return itself.
double search_tolerance(double amplitude, double growth, double loose) {
  return std::clamp(1e-3 * std::abs(growth), 1e-13, loose) * std::clamp(amplitude * amplitude, 1e-6, 1.0);
}

/// Newton's method for y = P(y). A bound on the amplitude keeps it off steady sliding, which is a fixed point too.
std::optional<FixedPoint> newton(ReturnMap& map, std::vector<double> y, int returns, double amplitude, double growth,
                                 double loose) {
  const double least_amplitude = 0.4 * amplitude, tolerance = search_tolerance(amplitude, growth, loose);
  // In near-stick a slip at many times V is only a few scales away.
  const double size = std::min(amplitude, map.distance(y, map.system().steady(0)));
  const VectorXd scale = map.scale();
  const MatrixXd I = MatrixXd::Identity(scale.size(), scale.size());
  std::vector<double> last = y;
  VectorXd step;
  double residual = infinity, factor = 1;
  int halvings = 0;
  for (int iteration = 0; iteration < 14; ++iteration) {
    const auto returned = map.follow(y, tolerance, returns, true, Derivative::of_steps, nullptr, dip_of(amplitude));
    const double now = returned.outcome.complete() ? map.distance(returned.end, y) / std::max(size, 1e-12) : infinity;
    if (returned.amplitude < least_amplitude || !(now < residual)) {
      if (iteration == 0 || ++halvings > 2) return std::nullopt;
      factor *= 0.3;
      y = map.moved(last, step, factor);
      continue;
    }
    halvings = 0;
    const MatrixXd A = scale.cwiseInverse().asDiagonal() * (I - returned.derivative) * scale.asDiagonal();
    step = scale.asDiagonal() * solve_linear(A, scale.cwiseInverse().asDiagonal() * map.difference(returned.end, y));
    if (!step.allFinite()) return std::nullopt;
    const double length = map.length(step) / std::max(size, 1e-12);
    // Weak attraction magnifies the rounding error of a return by 1/|growth|.
    const double left = 0.1 * tolerance / std::max(std::abs(growth), tolerance);
    const double rounding = std::min(1e-15 / (size * std::abs(growth)), 1e-3);
    if (length < std::max({30 * tolerance, 1e-8, left, rounding}))
      return FixedPoint{map.moved(y, step, 1), returned.derivative, returns, returned.amplitude};
    last = y;
    residual = std::max(now, 1e-3 * tolerance);
    factor = std::min(1.0, 0.5 / length);
    y = map.moved(last, step, factor);
  }
  return std::nullopt;
}

/// The fixed point of returns that already repeat themselves, with its derivative from neighbouring returns. Relaxation
/// oscillations forget their start within one return, and slips at 10¹⁰ V leave only rounding error in the derivative
/// that the steps propagate; the neighbours show whether the map contracts, and by how much.
std::optional<FixedPoint> settled_point(ReturnMap& map, const std::vector<double>& y, int returns, double amplitude,
                                        double loose) {
  const double dip = dip_of(amplitude), size = map.distance(y, map.system().steady(0));
  const auto returned = map.follow(y, loose, returns, true, Derivative::none, nullptr, dip);
  const double change = map.distance(returned.end, y);
  if (!returned.outcome.complete() || !(change < 1e-2 * size)) return std::nullopt;
  // A motion whose amplitude grows slowly nearly repeats itself too.
  constexpr double noise = 30, dies_out = 0.5;
  if (change > noise * loose * size) {
    const auto next = map.follow(returned.end, loose, returns, true, Derivative::none, nullptr, dip);
    if (!next.outcome.complete() || map.distance(next.end, returned.end) > dies_out * change) return std::nullopt;
  }
  const int n = int(map.differential().size());
  FixedPoint point{returned.end, MatrixXd::Zero(n, n), returns, returned.amplitude, true};
  const double share = 0.05 * std::min(size, 2.0);
  // Both sides count: friction may attract on the far side of a reversal and be neutral on this one.
  for (int k = 0; k < n; ++k)
    for (const double side : {1.0, -1.0}) {
      const VectorXd step = VectorXd::Unit(n, k) * (side * share * map.scale()[k]);
      const auto start = map.moved(y, step, 1);
      if (start == y) continue;  // off the section
      auto neighbour = map.follow(start, loose, returns, true, Derivative::none, nullptr, dip);
      if (neighbour.outcome.complete() &&
          neighbour.duration < 0.5 * returned.duration)  // it began just off the section
        neighbour = map.follow(neighbour.end, loose, returns, true, Derivative::none, nullptr, dip);
      if (!neighbour.outcome.complete()) return std::nullopt;
      VectorXd image = map.difference(neighbour.end, returned.end) / step[k];
      // A neighbour that needs one return more or less ends elsewhere on the same cycle.
      for (int more = 1; more < returns && map.length(image) * std::abs(step[k]) > share; ++more) {
        neighbour = map.follow(neighbour.end, loose, 1, true, Derivative::none, nullptr, dip);
        if (!neighbour.outcome.complete()) return std::nullopt;
        image = map.difference(neighbour.end, returned.end) / step[k];
      }
      if (map.length(image) > map.length(point.derivative.col(k))) point.derivative.col(k) = image;
    }
  return point;
}

/// Near a Hopf point the amplitude A changes slowly, along one direction. This finds the A at which its growth per
/// return, r(A) = ln(A'/A), falls through zero: a stable cycle. A is measured by the distance of the section point from
/// steady sliding, which is smooth. `y` lies on the section.
struct GrowthBalance {
  std::optional<std::vector<double>> y;  ///< a section point near the cycle
  bool dies_out = false;                 ///< the amplitude falls at every amplitude below the start's
};
GrowthBalance balance_of_growth(ReturnMap& map, const std::vector<double>& y, double amplitude,
                                double growth_about_steady, double loose) {
  const auto steady = map.system().steady(0);
  const double start = map.distance(y, steady), least = 0.02 * start / amplitude;
  VectorXd direction = map.difference(y, steady) / start;
  const long last_step = map.cost().steps + most_steps_of(map) / 8;  // irregular motion has no amplitude of zero growth
  struct Growth {
    double size, rate;
    std::vector<double> y;
  };
  // The first returns relax the fast directions; the growth is known once two successive returns agree.
  const auto growth_at = [&](double size) -> std::optional<Growth> {
    constexpr int most_returns = 8;
    constexpr double same = 0.02;
    const double A = amplitude * size / start, tolerance = search_tolerance(A, growth_about_steady, loose),
                 dip = dip_of(A);
    auto y = map.moved(steady, direction, size);
    double before = 0, rate = infinity;
    for (int k = 0; k < most_returns; ++k) {
      const auto returned = map.follow(y, tolerance, 1, true, Derivative::none, nullptr, dip);
      if (!returned.outcome.complete() || map.cost().steps > last_step) return std::nullopt;
      const double a = before, last = rate, b = map.distance(returned.end, steady);
      if (!(b > 0)) return std::nullopt;
      y = returned.end;
      before = b;
      if (k == 0) continue;
      rate = std::log(b / a);
      if (std::abs(rate - last) <= same * std::max(std::abs(rate), std::abs(growth_about_steady))) break;
    }
    direction = map.difference(y, steady) / before;
    return Growth{before, rate, y};
  };
  auto high = growth_at(start);
  if (!high) return {};
  // The lower end of the bracket has growth above 0: zero amplitude with the growth of the linear mode, or, above a
  // stable steady state, an amplitude that is searched for.
  double low = 0, low_rate = growth_about_steady;
  for (int larger = 0; high->rate > 0; ++larger) {
    low = high->size, low_rate = high->rate;
    high = growth_at((larger < 8 ? 1.05 : 1.25) * low);
    if (!high || high->size <= low || larger > 40) return {};  // larger amplitudes fall back within a few returns
  }
  for (double size = 0.8 * high->size; low_rate <= 0 && size > least; size *= 0.8) {
    const auto here = growth_at(size);
    if (!here) return {};
    if (here->rate > 0)
      low = here->size, low_rate = here->rate;
    else
      high = here;
  }
  if (low_rate <= 0) return {.y = {}, .dies_out = true};
  // Growth is nearly linear in the squared amplitude; the end that stays twice counts half (Illinois).
  const double growth = low_rate;
  double high_rate = high->rate;
  for (int iteration = 0, stays = 0; iteration < 30; ++iteration) {
    const double l2 = low * low, h2 = high->size * high->size, width = h2 - l2;
    // Where growth scatters the ends may have passed each other: then near the end of decay.
    const double inside = std::max(l2 + width * low_rate / (low_rate - high_rate), l2 + 1e-4 * width);
    const double a2 = std::min(inside, h2 - 1e-4 * width);
    const auto here = growth_at(std::sqrt(a2));
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

/// Extrapolation of motion that changes slowly and steadily from return to return: over as many returns as the secant
/// through the last two changes needs to end at no change, and no further than 0.3 of the motion's size.
class Extrapolation {
 public:
  explicit Extrapolation(const ReturnMap& map) : map_(map) {}

  /// After a return that ended at `y`. `size`: distance from steady sliding, in scales.
  void passed(const std::vector<double>& y, double size) {
    const bool known = !last_.empty();
    const VectorXd change = known ? VectorXd(map_.difference(y, last_).array() / map_.scale().array())
                                  : VectorXd::Zero(map_.scale().size());
    constexpr double slow = 0.03, same = 0.2, jump = 0.3;
    steady_ = known && change_.size() && change.norm() < slow * size && change.norm() > 0 &&
              (change - change_).norm() < same * change.norm();
    relative_change_ = known ? change.norm() / size : infinity;
    constexpr double die_out = 0.3;
    dies_out_ = known && change_.size() && change.norm() <= die_out * change_.norm();
    // Ringing that decays until slip sticks, and starts again with the next slip, has a period of many returns.
    if (returns_ > 0 && known && relative_change_ > jump) useless_ = true;
    if (known) change_ = change;
    last_ = y;
    size_ = size;
  }
  bool ready() const { return steady_ && !useless_ && extrapolations_ < most_extrapolations; }
  /// Change in one return over the size; infinite where not known.
  double relative_change() const { return relative_change_; }
  /// True between extrapolations while the changes do not die out: no cycle is near.
  bool under_way() const {
    return returns_ > 0 && remaining_ > 0.3 && !dies_out_ && !useless_ && extrapolations_ < most_extrapolations;
  }

  /// The extrapolated point.
  std::vector<double> extrapolated() {
    constexpr double first = 4, most_growth = 4, share = 0.3;
    double returns = first;
    if (returns_ > 0) {
      remaining_ = change_.dot(before_) / before_.squaredNorm();
      returns = returns_ * (remaining_ < 1 ? std::min(1 / (1 - remaining_), most_growth) : most_growth);
    }
    returns_ = std::min(returns, share * size_ / change_.norm());
    before_ = change_;
    from_ = last_;
    forget();
    ++extrapolations_;
    return map_.moved(from_, before_.cwiseProduct(map_.scale()), returns_);
  }
  /// A shorter extrapolation from the same point, for use where the motion from the last one ended. Nothing if that
  /// spanned one return or less.
  std::optional<std::vector<double>> shortened() {
    if (!(returns_ > 1) || !last_.empty()) return std::nullopt;
    returns_ *= 0.25;
    return map_.moved(from_, before_.cwiseProduct(map_.scale()), returns_);
  }

 private:
  void forget() {
    last_.clear();
    change_.resize(0);
    steady_ = false;
  }
  static constexpr int most_extrapolations = 100;  // more than these go round in circles
  const ReturnMap& map_;
  std::vector<double> last_, from_;  ///< ends of the last return; start of the last extrapolation
  VectorXd change_, before_;         ///< over the last return, and the one before the last extrapolation; in scales
  double size_ = 0, relative_change_ = infinity, returns_ = 0, remaining_ = 1;
  bool steady_ = false, useless_ = false, dies_out_ = false;
  int extrapolations_ = 0;
};

/// The search for a stable fixed point of the return map, from stick or from the start of the options.
class CycleSearch {
 public:
  /// `growth_about_steady`: growth ln(A'/A) per period of a small oscillation about steady sliding.
  CycleSearch(ReturnMap& map, double growth_about_steady, const CycleOptions& options)
      : map_(map),
        options_(options),
        growth_about_steady_(growth_about_steady),
        most_steps_(most_steps_of(map)),
        most_returns_(steady_is_stable() ? std::min(options.max_cycles, 12) : options.max_cycles) {}

  /// Looks for the point; where none is found, `outcome` says why.
  void run() {
    std::vector<double> wandering;  // the end of a long search
    for (const double tolerance : search_tolerances) {
      loose_ = tolerance;
      recent_ends_.clear();
      last_step_ = map_.cost().steps + most_steps_;
      trial_steps_ = 0;
      run_once();
      if (point || outcome.ending != Ending::budget_spent) return;
      if (recent_ends_.size() == some) wandering = recent_ends_.back();
      if (!steps_err_in_returns()) break;
    }
    if (wandering.empty() || durations_.empty()) return;
    const long returns = long(durations_.size());
    const double mean_return = std::accumulate(durations_.begin(), durations_.end(), 0.0) / double(returns);
    exponent = largest_exponent(as_structure(wandering), mean_return, most_returns_);
    outcome = outcome_of(exponent, most_returns_, outcome);
  }

  std::optional<FixedPoint> point;
  std::optional<Exponent> exponent;
  Outcome outcome;

 private:
  static constexpr int transient = 10;            ///< returns
  static constexpr int relaxed = 16;              ///< returns; slowly changing motion is a free oscillation by then
  static constexpr double hardly_changes = 1e-2;  ///< relative change per return below which motion counts as slow
  static constexpr std::size_t some = 8;          ///< returns

  void run_once() {
    if (!options_.near.empty()) {
      const auto returned = map_.follow(options_.near, loose_, 1, true);
      begin_at(options_.near);
      ends_.push_back(returned.end);
      const bool ends = returned.outcome.complete() && accept(returned.end, 1, returned.amplitude, infinity);
      if (ends && (point || !outcome.complete())) return;  // motion that has died out says nothing of other starts
    }
    // The first start is stick with the state of steady sliding, the second a longer stick. The larger first slip of
    // the second can reach the basin of a cycle that coexists with stable sliding, and does not fall straight onto an
    // unstable steady state.
    const double V = map_.drive_speed();
    std::vector<double> ages = {V};
    if (!options_.start) ages.push_back((steady_is_stable() ? 1e-4 : 0.1) * V);
    for (const double aged_at : ages) {
      try {
        follow_from(options_.start ? motion::starting_point(map_.system(), *options_.start) : map_.stick(aged_at));
      } catch (const InputError& e) {
        outcome = {Ending::not_finite, e.what()};
      }
      if (point) return;
    }
  }

  /// True if the error of the steps in one of the last returns exceeds 1e-5 of the motion at its end.
  bool steps_err_in_returns() {
    constexpr double small = 1e-5, tighter = 1e-3;
    for (const auto& y : recent_ends_) {
      const auto loosely = map_.follow(y, loose_, 1, true), closely = map_.follow(y, tighter * loose_, 1, true);
      if (loosely.outcome.complete() && closely.outcome.complete() &&
          map_.distance(loosely.end, closely.end) > small * distance_from_steady(y))
        return true;
    }
    return false;
  }

  /// The slider as a structure of one coordinate, moving from y.
  motion::StructureModel as_structure(const std::vector<double>& y) const {
    const auto& model = map_.system().model();
    const auto seen = map_.system().observe(0, y.data());
    motion::StructureStart start{.coordinates = {seen.displacement}, .velocities = {seen.velocity}};
    if (model.lambda != 0) {
      auto& states = start.states.emplace_back();
      for (std::size_t i = 0; i < seen.state.size(); ++i) states[model.law->states()[i].name] = seen.state[i];
    }
    return {oscillators::one_slider(model), std::move(start)};
  }

  /// True if friction can change the energy of an oscillation with this |v − V|/V by so much in a period that the ends
  /// of returns show it well: it does the work 4 μ N s over the way 4 s, and the energy is k s²/2. In fast slip it may
  /// be all but gone.
  bool friction_shows_in_return(double amplitude) const {
    constexpr double clearly = 1e-3;
    const auto& model = map_.system().model();
    const auto friction_at = [&](double v) {
      return std::abs(model.law->steady_friction({v, model.drive.normal_load.level()}).friction);
    };
    const double V = map_.drive_speed(), mu = std::min(friction_at(V), friction_at((1 + amplitude) * V));
    return 8 * mu * friction_over_swing(model) > clearly * amplitude;
  }
  bool steady_is_stable() const { return growth_about_steady_ < 0; }
  double distance_from_steady(const std::vector<double>& y) const { return map_.distance(y, map_.system().steady(0)); }
  bool attracts(const std::optional<FixedPoint>& candidate) const {
    return candidate && candidate->amplitude >= collapsed && spectral_radius(*candidate, map_) < 1;
  }

  /// Follows the motion from y until a stable fixed point is found, or it is known why none is.
  void follow_from(std::vector<double> y) {
    outcome = steady_is_stable()
                  ? Outcome{Ending::none_exists, fmt::format("the motion started from {} dies out onto steady sliding",
                                                             options_.start ? "the given start" : "stick")}
                  : Outcome{Ending::budget_spent, fmt::format("no periodic motion within {} returns", most_returns_)};
    begin_at(y);
    Extrapolation extrapolation(map_);
    double tolerance = loose_, last_amplitude = 1;
    bool enlarged = false;
    balance_sought_ = false;
    next_attempt_ = 2;
    for (int k = 0; k < most_returns_; ++k) {
      const long steps_before = map_.cost().steps;
      const auto returned = map_.follow(y, tolerance, 1, k > 0, Derivative::none, nullptr, dip_of(last_amplitude));
      longest_return_steps_ = std::max(longest_return_steps_, map_.cost().steps - steps_before);
      if (!returned.outcome.complete()) {
        if (const auto nearer = extrapolation.shortened()) {
          y = *nearer;
          continue;
        }
        if (returned.outcome.ending != Ending::budget_spent || !steady_is_stable()) outcome = returned.outcome;
        return;
      }
      if (map_.cost().steps > last_step_) {
        outcome = {Ending::budget_spent, fmt::format("no periodic motion within {} steps", most_steps_)};
        return;
      }
      y = returned.end;
      durations_.push_back(returned.duration);
      if (k > transient) recent_ends_.push_back(y);
      if (recent_ends_.size() > some) recent_ends_.pop_front();
      ends_.push_back(y);
      const double amplitude = last_amplitude = returned.amplitude;
      if (k > 0 && steady_is_stable() && amplitude < 0.02) return;
      if (!steady_is_stable() && !enlarged && amplitude < 1e-3) {
        if (amplitude < 1e-11) return;
        y = amplified(y, amplitude);
        begin_at(y);
        enlarged = true;
        continue;
      }
      extrapolation.passed(y, distance_from_steady(y));
      // The tolerance stays at 1e-3 of the change per return, so that steps resolve that change.
      tolerance = std::clamp(1e-3 * extrapolation.relative_change(), 1e-13, loose_);
      // A trial that takes far longer has fallen into stick or onto steady sliding.
      constexpr long times = 20, few = 1'000;
      map_.allow(times * longest_return_steps_ + few);
      const bool slow = k <= relaxed && std::has_single_bit(unsigned(k)) && !friction_shows_in_return(amplitude) &&
                        (extrapolation.relative_change() < hardly_changes ||
                         friction_over_swing(map_.system().model()) < weak_friction);
      Attempt attempted = Attempt::goes_on;
      if (slow && !extrapolation.under_way()) attempted = follow_swing(y).value_or(Attempt::goes_on);
      if (attempted == Attempt::goes_on) {
        // Trials spend at most half of the steps; the motion keeps the others.
        const long before = map_.cost().steps;
        attempted = attempt(k, amplitude, extrapolation.under_way());
        trial_steps_ += map_.cost().steps - before;
      }
      map_.allow(ReturnMap::most_steps);
      if (attempted == Attempt::ends) return;
      if (!steady_is_stable() && extrapolation.ready()) {
        y = extrapolation.extrapolated();
        begin_at(y);
      }
    }
  }

  /// An overdamped start nearly reaches steady sliding, which repels. The deviation is scaled up to 0.1 of the drive
  /// speed, to save the returns in which it would grow there.
  std::vector<double> amplified(const std::vector<double>& y, double amplitude) const {
    const auto steady = map_.system().steady(0);
    // The bound in scales limits states that have changed more than the speed has.
    return map_.moved(steady, map_.difference(y, steady), std::min(0.1 / amplitude, 1 / map_.distance(y, steady)));
  }

  enum class Attempt { goes_on, ends };
  /// Tests after return k for a cycle: wherever the motion nearly repeats itself, and from time to time elsewhere.
  Attempt attempt(int k, double amplitude, bool extrapolating) {
    const auto& y = ends_.back();
    const int known = int(ends_.size()) - 1;  // returns since the start or the last extrapolation
    if (const auto recurring = recurring_point(amplitude)) {
      point = recurring;
      outcome = {};
      return Attempt::ends;
    }
    if (trial_steps_ > most_steps_ / 2) return Attempt::goes_on;
    const double size = distance_from_steady(y);
    const double moved = known > 0 ? map_.distance(y, ends_[known - 1]) : infinity;
    const double change = moved / std::min(amplitude, size);
    // A period of several returns has as many as bring the motion nearly back.
    constexpr int few = 8;
    const auto came_back = [&](int returns) {
      const double back = map_.distance(y, ends_[known - returns]);
      return back < 0.2 * moved && (returns <= few || back < std::min(0.01 * size, 0.02 * moved)) ? back : infinity;
    };
    bool many = false;
    for (int returns = few + 1; returns < known; ++returns) many = many || came_back(returns) < infinity;
    if (!many && (extrapolating || (k < next_attempt_ && !(change < 1e-3)))) return Attempt::goes_on;
    next_attempt_ = k + std::max(2, k / 2);
    // Motion whose amplitude hardly changes is not waited for.
    constexpr double slow = 1e-3;
    const bool grows_slowly = k >= 2 && std::abs(growth_about_steady_) < slow && amplitude < 10 && !balance_sought_;
    if (!grows_slowly && accept(y, 1, amplitude, moved)) return Attempt::ends;
    constexpr long as_often = 10;  // a trial follows the motion through its returns
    for (int returns = 2; returns < known; ++returns) {
      const double back = came_back(returns);
      const bool affordable =
          returns <= few || trial_steps_ + as_often * returns * longest_return_steps_ < most_steps_ / 2;
      if (back < infinity && affordable && accept(y, returns, amplitude, back)) return Attempt::ends;
    }
    return k >= 6 || (steady_is_stable() && k >= 3) || grows_slowly ? find_balanced_growth(y, amplitude)
                                                                    : Attempt::goes_on;
  }

  /// The fixed point of motion that sticks and repeats itself to rounding error. Stick forgets the oscillation before
  /// it, and after slips at 10¹⁰ V the propagated derivative holds only rounding error, so that the repetition itself
  /// must show the cycle: four periods that return to within rounding error and add up to no change.
  std::optional<FixedPoint> recurring_point(double amplitude) const {
    const auto& slider = map_.system().model().slider;
    const auto& y = ends_.back();
    const int last = int(ends_.size()) - 1;
    if (map_.system().mechanics() != oscillators::Mechanics::inertial) return std::nullopt;
    // Two periods that agree to 1e-9 are as good a proof as four that scatter within 1e-5.
    constexpr double rounding = 1e-5, agreement = 1e-9, nowhere = 2, longer_than_swings = 1.5;
    const double swing = 2 * std::numbers::pi * std::sqrt(slider.mass / slider.stiffness);
    const double size = distance_from_steady(y);
    const auto repeats = [&](int returns, int periods, double within) {
      double farthest = 0;
      for (int k = 0; k < periods && farthest <= within * size; ++k)
        farthest = std::max(farthest, map_.distance(ends_[last - k * returns], ends_[last - (k + 1) * returns]));
      return farthest <= within * size && map_.distance(y, ends_[last - periods * returns]) <= nowhere * farthest;
    };
    for (int returns = 1; 2 * returns <= last; ++returns) {
      if (!repeats(returns, 2, agreement) && !(4 * returns <= last && repeats(returns, 4, rounding))) continue;
      if (*std::max_element(durations_.end() - returns, durations_.end()) < longer_than_swings * swing) continue;
      if (returns == 1) return std::nullopt;  // neighbouring returns distinguish attraction from slow change
      const auto n = map_.scale().size();
      constexpr double at_most = 0.5;  // a larger part left of a disturbance per period would show in these periods
      return FixedPoint{.y = y,
                        .derivative = at_most * MatrixXd::Identity(n, n),
                        .returns = returns,
                        .amplitude = amplitude,
                        .by_differences = true,
                        .bounded = true};
    }
    return std::nullopt;
  }

  /// Follows the growth of a slowly changing oscillation through y to its end. Nothing if y belongs to none.
  std::optional<Attempt> follow_swing(const std::vector<double>& y) {
    constexpr double tolerance = 1e-9, dead = 0.02;
    const auto swing = slow_swing_from(map_, y, tolerance);
    if (!swing) return std::nullopt;
    const auto end = follow_slow_swing(map_, *swing, tolerance);
    constexpr double leaves_alone = 1e-12;  // metrics to 1e-6 then hold for a million periods
    // The work per period of a contact with memory is known to rounding error of the oscillation's energy.
    const bool conclusive = swing->turnover > leaves_alone || !oscillators::remembers(map_.system().model());
    if (end.balance && conclusive) return accept_swing(end);
    if (steady_is_stable()) return end.last->amplitude < dead ? Attempt::ends : Attempt::goes_on;
    if (std::abs(swing->growth) < leaves_alone) {
      point = FixedPoint{.y = swing->y, .derivative = {}, .amplitude = swing->amplitude};
      point->free = {start_, int(ends_.size()), swing->growth};
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

  /// True if the oscillation decays until the slider sticks, and the next amplitude depends on the phase of the stop by
  /// more than many periods of decay: no two periods are alike.
  bool sticks_at_random(const SlowEnd& end, const SlowSwing& swing) {
    constexpr double tolerance = 1e-11, noise = 1e3 * tolerance, many = 10;
    if (swing.growth > 0) return false;
    const auto again = swing_after_stick(map_, *end.last, swing, tolerance);
    if (!again || !(again->spread > std::max(noise, many * std::abs(again->growth)))) return false;
    outcome = {
        Ending::none_exists,
        fmt::format("no two periods are alike: a free decay of {:.1g} periods ends in stick, whose phase shifts the "
                    "next free decay by {:.1g} periods",
                    end.periods, again->spread / std::abs(again->growth))};
    return true;
  }

  /// Searches for the amplitude of zero growth.
  Attempt find_balanced_growth(const std::vector<double>& y, double amplitude) {
    balance_sought_ = true;
    const auto balanced = balance_of_growth(map_, y, amplitude, growth_about_steady_, loose_);
    if (balanced.y) {
      const auto there = map_.follow(*balanced.y, search_tolerance(amplitude, growth_about_steady_, loose_), 1, true,
                                     Derivative::none, nullptr, dip_of(amplitude));
      if (there.outcome.complete() && accept(there.end, 1, there.amplitude, infinity)) return Attempt::ends;
    }
    return balanced.dies_out ? Attempt::ends : Attempt::goes_on;
  }

  /// True if `returns` returns from y, which change it by `change`, belong to an attracting fixed point, then kept as
  /// `point`.
  bool accept(const std::vector<double>& y, int returns, double amplitude, double change) {
    auto candidate = newton(map_, y, returns, amplitude, growth_about_steady_, loose_);
    constexpr double repeats = 1e-3, certainly = 0.5;
    const double size = distance_from_steady(y);
    if (!attracts(candidate) && change < repeats * size) {
      candidate = settled_point(map_, y, returns, amplitude, loose_);
      if (candidate && !(spectral_radius(*candidate, map_) < certainly)) return false;
    }
    if (!attracts(candidate)) return false;
    // The end of a return shows too little of an oscillation that friction hardly changes.
    constexpr double neutral = 1e-6;
    if (returns == 1 && spectral_radius(*candidate, map_) > 1 - neutral)
      if (const auto attempted = follow_swing(y)) return *attempted == Attempt::ends;
    point = candidate;
    outcome = {};
    return true;
  }

  /// Motion goes on from y, the start or an extrapolated point.
  void begin_at(const std::vector<double>& y) {
    start_ = y;
    ends_.clear();
    durations_.clear();
  }

  ReturnMap& map_;
  const CycleOptions& options_;
  double growth_about_steady_;
  long most_steps_;  ///< in one search at one tolerance
  int most_returns_;
  double loose_ = search_tolerances[0];          ///< tolerance
  long last_step_ = 0;                           ///< step count that ends the search
  long trial_steps_ = 0;                         ///< steps spent on trials
  long longest_return_steps_ = 0;                ///< steps of the longest return so far
  std::vector<double> start_;                    ///< point from which the motion is followed
  std::vector<std::vector<double>> ends_;        ///< ends of the returns since the start or the last extrapolation
  std::vector<double> durations_;                ///< durations of the same returns, s
  std::deque<std::vector<double>> recent_ends_;  ///< ends of the last returns after the transient
  int next_attempt_ = 2;                         ///< return after which a cycle is tested for in any case
  bool balance_sought_ = false;                  ///< the amplitude of zero growth was searched for from this start
};

}  // namespace

SearchResult search_cycle(ReturnMap& map, double growth_about_steady, const CycleOptions& options) {
  CycleSearch search(map, growth_about_steady, options);
  search.run();
  return {std::move(search.point), std::move(search.outcome), search.exponent};
}

}  // namespace rosin::analysis::cycles
