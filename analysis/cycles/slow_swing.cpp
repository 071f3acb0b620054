/// The work of friction on a free oscillation, and the amplitude at which it vanishes.
#include "analysis/cycles/slow_swing.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "core/linear_solve.hpp"

namespace rosin::analysis::cycles {

using oscillators::Mechanics;

namespace {

constexpr double rounding = 1e-14;  // relative error of the work, by cancellation
constexpr double digits = 4e-16;    // rounding error of the mean friction, whose work over a period cancels
constexpr double searched = 1e-7, closely = 1e-15;  // relative errors of a balanced amplitude
constexpr int at_displacement = 0, mechanical = 2;  // unknowns of a slider with mass: x, v, then those of its contact

/// |v − V|/V of a free oscillation of this amplitude.
double amplitude_of(const ReturnMap& map, double stretch) {
  const auto& s = map.system().model().slider;
  return std::sqrt(s.stiffness / s.mass) * std::abs(stretch) / map.drive_speed();
}

/// Displacement at which the spring holds this friction.
double middle_of(const ReturnMap& map, double friction) {
  const auto& model = map.system().model();
  return (friction + model.drive.force.level()) / model.slider.stiffness;
}

/// The swing of zero growth between one that grows and one that decays.
struct Root {
  SlowSwing swing;
  double within;  ///< relative error of its amplitude
};
/// Nothing if a swing in between does not return, or the map would take more steps than `last_step`.
std::optional<Root> root_between(ReturnMap& map, const SlowSwing& low, const SlowSwing& high, double tolerance,
                                 double known, long last_step) {
  const double from = low.y[at_displacement], width = high.y[at_displacement] - from;
  SlowSwing here = low;
  bool failed = false;
  const auto growth = [&](double part) {
    if (failed || map.cost().steps > last_step) return failed = true, 0.0;
    const auto at = swing_at(map, here, from + part * width, tolerance);
    if (!at) return failed = true, 0.0;
    here = *at;
    return at->growth;
  };
  const double enough = known * low.stretch / width;
  std::uintmax_t iterations = 80;
  const auto [a, b] = boost::math::tools::toms748_solve(
      growth, 0.0, 1.0, low.growth, high.growth, [&](double l, double r) { return r - l < enough; }, iterations);
  growth(0.5 * (a + b));
  if (failed) return std::nullopt;
  return Root{here, (b - a) * width / low.stretch};
}

/// The neighbour of `swing` whose stretch differs by a relative `part`.
std::optional<SlowSwing> neighbour_at(ReturnMap& map, const SlowSwing& swing, double part, double tolerance) {
  return swing_at(map, swing, swing.y[at_displacement] + part * swing.stretch, tolerance);
}

}  // namespace

SwingWork::SwingWork(const oscillators::SliderSystem& system, double reference)
    : system_(system), reference_(reference), y_(system.size()) {}

void SwingWork::step(solvers::steps::Collocation& solver) {
  const auto& model = system_.model();
  const double N = model.drive.normal_load.level(), V = model.drive.speed.level();
  for (int i = 0; i < solvers::steps::Collocation::stages; ++i) {
    solver.stage(i, y_.data());
    const double t = solver.stage_time(i), dt = solvers::steps::RadauTableau::get().b[i] * solver.length();
    const double w = system_.slip_rate(t, y_.data()) - V;
    const double friction = N * system_.friction_coefficient(t, y_.data());
    const double power = -(friction - reference_ + model.slider.damping * w) * w;
    gained_ += dt * power;
    moved_ += dt * std::abs(power);
    impulse_ += dt * friction;
    time_ += dt;
  }
}

double SwingWork::growth(double stretch) const {
  return 0.5 * std::log1p(2 * gained_ / (system_.model().slider.stiffness * stretch * stretch));
}
double SwingWork::turnover(double stretch) const {
  return moved_ / (system_.model().slider.stiffness * stretch * stretch);
}

std::optional<SlowSwing> swing_at(ReturnMap& map, const SlowSwing& near, double displacement, double tolerance) {
  const auto& model = map.system().model();
  constexpr double another = 0.3;  // relative difference of the amplitude beyond which the motion is another one
  constexpr int most = 16;
  constexpr double forgets = 0.1, gone = 1e-12;           // part of a change left after a period; scales
  constexpr double settled = 1e-3, state_settled = 1e-3;  // part of the growth; scales
  constexpr double noisy = 0.3;                           // part of the turnover
  SlowSwing swing = near;
  swing.scatter = 0;
  swing.y[at_displacement] = displacement;
  double last = infinity, moved_last = infinity, scatter = infinity;
  bool use_newton = false;
  for (int period = 0; period < most; ++period) {
    swing.stretch = displacement - swing.middle;
    const double expected = amplitude_of(map, swing.stretch);
    SwingWork work(map.system(), model.slider.stiffness * swing.middle - model.drive.force.level());
    const auto returned = map.follow(swing.y, tolerance, 1, true, use_newton ? Derivative::of_steps : Derivative::none,
                                     &work, dip_of(expected));
    if (!returned.outcome.complete() || !(std::abs(returned.amplitude - expected) < another * expected))
      return std::nullopt;
    swing.growth = work.growth(swing.stretch);
    swing.turnover = work.turnover(swing.stretch);
    swing.amplitude = returned.amplitude;
    swing.middle = middle_of(map, work.mean_friction());
    if (!std::isfinite(swing.growth)) return std::nullopt;
    auto change = map.difference(returned.end, swing.y);
    const auto states = change.size() - mechanical;
    if (use_newton) {
      swing.state_derivative = returned.derivative.bottomRightCorner(states, states);
      const Eigen::VectorXd scale = map.scale().tail(states);
      const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(states, states);
      const Eigen::MatrixXd A = scale.cwiseInverse().asDiagonal() * (I - swing.state_derivative) * scale.asDiagonal();
      change.tail(states) =
          scale.asDiagonal() * solve_linear(A, scale.cwiseInverse().asDiagonal() * change.tail(states));
    }
    change.head(mechanical).setZero();
    swing.y = map.moved(swing.y, change, 1);
    const double moved = map.length(change);
    constexpr double nothing = 1e-16;
    const double enough =
        std::max({settled * std::abs(swing.growth), std::max(tolerance, rounding) * swing.turnover, nothing});
    const bool forgotten = moved < std::max(forgets * moved_last, gone);
    const bool state_is = (use_newton || forgotten) && moved < state_settled;
    // The position of the steps about a reversal varies from period to period, and with it the error of the work.
    const double differs = std::abs(swing.growth - last);
    scatter = state_is ? std::max(std::isfinite(scatter) ? 0.5 * scatter : 0, differs) : infinity;
    if (period > 0 && state_is && differs <= enough) return swing;
    if (period == most - 1 && scatter < noisy * swing.turnover) {
      swing.scatter = scatter;
      return swing;
    }
    use_newton = use_newton || !forgotten;  // states that a period does not forget are solved for by Newton's method
    last = swing.growth;
    moved_last = moved;
  }
  return std::nullopt;
}

std::optional<SlowSwing> slow_swing_from(ReturnMap& map, const std::vector<double>& y, double tolerance) {
  const auto& system = map.system();
  if (system.mechanics() != Mechanics::inertial || !system.rigid()) return std::nullopt;
  SlowSwing swing;
  swing.y = y;
  SwingWork work(system, 0);
  const double about_steady = y[at_displacement] - system.steady(0)[at_displacement];
  const auto returned =
      map.follow(y, tolerance, 1, true, Derivative::none, &work, dip_of(amplitude_of(map, about_steady)));
  if (!returned.outcome.complete()) return std::nullopt;
  swing.middle = middle_of(map, work.mean_friction());
  const auto found = swing_at(map, swing, y[at_displacement], tolerance);
  constexpr double small = 0.1;
  if (!found || found->turnover > small) return std::nullopt;
  return found;
}

SlowEnd follow_slow_swing(ReturnMap& map, const SlowSwing& start, double tolerance) {
  constexpr double first = 0.05, widening = 1.2, widest = 0.7, least = 1e-3;  // steps in ln stretch
  constexpr double farthest = 50, fast = 0.3, at_rest = 1e-4;
  const long last_step = map.cost().steps + 200'000;
  const double sign = start.growth > 0 ? 1 : -1;
  SlowSwing here = start;
  double step = first, periods = 0;
  while (std::abs(std::log(here.stretch / start.stretch)) < farthest && std::abs(here.growth) < fast &&
         here.amplitude > at_rest && map.cost().steps < last_step) {
    const auto next = swing_at(map, here, here.middle + here.stretch * std::exp(sign * step), tolerance);
    if (!next) {
      step *= 0.5;
      if (step < least) break;
      continue;
    }
    if (next->growth * sign > 0) {
      // Between the two the growth follows roughly a power of the stretch.
      const double ratio = next->growth / here.growth;
      periods += step / std::abs(here.growth) * (std::abs(ratio - 1) < 1e-6 ? 1 : (1 - 1 / ratio) / std::log(ratio));
      here = *next;
      step = std::min(widening * step, widest);
      continue;
    }
    constexpr double clear = 3;
    if (std::abs(here.growth) < clear * here.scatter || std::abs(next->growth) < clear * next->scatter) break;
    const auto root =
        root_between(map, sign > 0 ? here : *next, sign > 0 ? *next : here, tolerance, searched, last_step);
    if (!root) break;
    constexpr double aside = 100 * searched;
    const auto low = neighbour_at(map, root->swing, -aside, tolerance),
               high = neighbour_at(map, root->swing, aside, tolerance);
    if (!low || !high || !(high->growth < low->growth)) break;
    return {.balance = root->swing,
            .slope = (high->growth - low->growth) / (2 * aside),
            // Half the difference of the slopes on both sides.
            .slope_error = (std::abs(high->growth + low->growth) / 2 + high->scatter + low->scatter) / aside,
            .last = {},
            .periods = periods};
  }
  return {.balance = {}, .last = here, .periods = periods};
}

std::optional<AfterStick> swing_after_stick(ReturnMap& map, const SlowSwing& last, const SlowSwing& first,
                                            double tolerance) {
  constexpr int places = 4, most_returns = 300, relaxed = 4;
  constexpr double jump = 1.5, as_large = 0.3;
  const long most_steps = map.cost().steps + 300'000;
  double least = infinity, largest = -infinity, growth = 0;
  for (int place = 0; place < places; ++place) {
    auto y = last.y;
    y[at_displacement] = last.middle + last.stretch * std::exp(last.growth * place / places);
    double amplitude = last.amplitude;
    bool jumped = false;
    for (int k = 0, since = 0; !jumped || since < relaxed || amplitude < as_large * first.amplitude; ++k, ++since) {
      if (k == most_returns || map.cost().steps > most_steps) return std::nullopt;
      const auto returned = map.follow(y, tolerance, 1, true, Derivative::none, nullptr, dip_of(amplitude));
      if (!returned.outcome.complete()) return std::nullopt;
      if (returned.amplitude > jump * amplitude) jumped = true, since = 0;
      y = returned.end;
      amplitude = returned.amplitude;
    }
    const auto next = slow_swing_from(map, y, tolerance);
    if (!next) return std::nullopt;
    growth = next->growth;
    const double size = std::log(next->stretch);
    least = std::min(least, size), largest = std::max(largest, size);
  }
  return AfterStick{largest - least, growth};
}

std::optional<double> balance_closely(ReturnMap& map, SlowEnd& end, double tolerance) {
  constexpr double first = 1e-9, widest = 1e-3;
  const long last_step = map.cost().steps + 500'000;  // a reversal under stiff friction may take 20 000 at a time
  for (double aside = first; aside < widest; aside *= 10) {
    const auto low = neighbour_at(map, *end.balance, -aside, tolerance),
               high = neighbour_at(map, *end.balance, aside, tolerance);
    if (!low || !high || map.cost().steps > last_step) return std::nullopt;
    if (low->growth < 0 || high->growth > 0) continue;
    const auto root = root_between(map, *low, *high, tolerance, closely, last_step);
    if (!root) return std::nullopt;
    end.balance = root->swing;
    const SlowSwing& found = root->swing;
    const double cancels = digits * std::abs(found.middle) / std::abs(found.stretch);
    return root->within + (rounding * found.turnover + cancels + found.scatter) / -end.slope;
  }
  return std::nullopt;
}

}  // namespace rosin::analysis::cycles
