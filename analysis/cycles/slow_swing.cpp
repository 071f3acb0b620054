/// The work of friction on a swing, and where it vanishes.
#include "analysis/cycles/slow_swing.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "core/linear_solve.hpp"

namespace rosin::analysis::cycles {

using oscillators::Mechanics;

namespace {

constexpr double rounding = 1e-14;                  // of the work, by what cancels in it
constexpr double digits = 4e-16;                    // of the mean friction, whose work a turn takes back
constexpr double searched = 1e-7, closely = 1e-15;  // parts of the stretch to which a balance is found
constexpr int at_displacement = 0, mechanical = 2;  // unknowns of a slider with mass: x, v, then those of its contact

/// |v − V|/V of a free swing of that stretch.
double amplitude_of(const ReturnMap& map, double stretch) {
  const auto& s = map.system().model().slider;
  return std::sqrt(s.stiffness / s.mass) * std::abs(stretch) / map.drive_speed();
}

/// Displacement at which the spring holds this friction.
double middle_of(const ReturnMap& map, double friction) {
  const auto& model = map.system().model();
  return (friction + model.drive.force.level()) / model.slider.stiffness;
}

/// Between swings that grow and that decay: where growth vanishes.
struct Root {
  SlowSwing swing;
  double within;  ///< how far off it may be, as a part of its stretch
};
/// Nothing if some swing on the way does not come round, or the map would have to take more steps than `last_step`.
std::optional<Root> root_between(ReturnMap& map, const SlowSwing& low, const SlowSwing& high, double tolerance,
                                 double known, long last_step) {
  const double from = low.y[at_displacement], width = high.y[at_displacement] - from;
  SlowSwing here = low;
  bool lost = false;
  const auto growth = [&](double part) {
    if (lost || map.cost().steps > last_step) return lost = true, 0.0;
    const auto at = swing_at(map, here, from + part * width, tolerance);
    if (!at) return lost = true, 0.0;
    here = *at;
    return at->growth;
  };
  const double enough = known * low.stretch / width;
  std::uintmax_t iterations = 80;
  const auto [a, b] = boost::math::tools::toms748_solve(
      growth, 0.0, 1.0, low.growth, high.growth, [&](double l, double r) { return r - l < enough; }, iterations);
  growth(0.5 * (a + b));
  if (lost) return std::nullopt;
  return Root{here, (b - a) * width / low.stretch};
}

/// The swing at a part of its stretch from `swing`.
std::optional<SlowSwing> beside(ReturnMap& map, const SlowSwing& swing, double part, double tolerance) {
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
  constexpr double another = 0.3;  // of the amplitude: the motion is no swing of this stretch
  constexpr int most = 16;
  constexpr double forgets = 0.1, gone = 1e-12;           // part of a change that is left after a turn; scales
  constexpr double settled = 1e-3, state_settled = 1e-3;  // part of the growth; scales
  constexpr double noisy = 0.3;                           // part of the turnover
  SlowSwing swing = near;
  swing.scatter = 0;
  swing.y[at_displacement] = displacement;
  double last = infinity, moved_last = infinity, scatter = infinity;
  bool leads = false;
  for (int turn = 0; turn < most; ++turn) {
    swing.stretch = displacement - swing.middle;
    const double expected = amplitude_of(map, swing.stretch);
    SwingWork work(map.system(), model.slider.stiffness * swing.middle - model.drive.force.level());
    const auto passage = map.follow(swing.y, tolerance, 1, true, leads ? Derivative::of_steps : Derivative::none, &work,
                                    dip_of(expected));
    if (!passage.outcome.complete() || !(std::abs(passage.amplitude - expected) < another * expected))
      return std::nullopt;
    swing.growth = work.growth(swing.stretch);
    swing.turnover = work.turnover(swing.stretch);
    swing.amplitude = passage.amplitude;
    swing.middle = middle_of(map, work.mean_friction());
    if (!std::isfinite(swing.growth)) return std::nullopt;
    auto change = map.difference(passage.end, swing.y);
    const auto states = change.size() - mechanical;
    if (leads) {
      swing.state_derivative = passage.derivative.bottomRightCorner(states, states);
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
    const bool state_is = (leads || forgotten) && moved < state_settled;
    // Steps that fall now so, now so, on a reversal tell its work to so many digits only.
    const double differs = std::abs(swing.growth - last);
    scatter = state_is ? std::max(std::isfinite(scatter) ? 0.5 * scatter : 0, differs) : infinity;
    if (turn > 0 && state_is && differs <= enough) return swing;
    if (turn == most - 1 && scatter < noisy * swing.turnover) {
      swing.scatter = scatter;
      return swing;
    }
    leads = leads || !forgotten;  // what a turn does not forget is solved for
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
  const auto passage =
      map.follow(y, tolerance, 1, true, Derivative::none, &work, dip_of(amplitude_of(map, about_steady)));
  if (!passage.outcome.complete()) return std::nullopt;
  swing.middle = middle_of(map, work.mean_friction());
  const auto found = swing_at(map, swing, y[at_displacement], tolerance);
  constexpr double small = 0.1;
  if (!found || found->turnover > small) return std::nullopt;
  return found;
}

SlowEnd follow_slow_swing(ReturnMap& map, const SlowSwing& start, double tolerance) {
  constexpr double first = 0.05, widening = 1.2, widest = 0.7, least = 1e-3;  // ways in ln stretch
  constexpr double farthest = 50, fast = 0.3, at_rest = 1e-4;
  const long last_step = map.cost().steps + 200'000;
  const double sign = start.growth > 0 ? 1 : -1;
  SlowSwing here = start;
  double way = first, turns = 0;
  while (std::abs(std::log(here.stretch / start.stretch)) < farthest && std::abs(here.growth) < fast &&
         here.amplitude > at_rest && map.cost().steps < last_step) {
    const auto next = swing_at(map, here, here.middle + here.stretch * std::exp(sign * way), tolerance);
    if (!next) {
      way *= 0.5;
      if (way < least) break;
      continue;
    }
    if (next->growth * sign > 0) {
      // About as of a power of the stretch.
      const double ratio = next->growth / here.growth;
      turns += way / std::abs(here.growth) * (std::abs(ratio - 1) < 1e-6 ? 1 : (1 - 1 / ratio) / std::log(ratio));
      here = *next;
      way = std::min(widening * way, widest);
      continue;
    }
    constexpr double clear = 3;
    if (std::abs(here.growth) < clear * here.scatter || std::abs(next->growth) < clear * next->scatter) break;
    const auto root =
        root_between(map, sign > 0 ? here : *next, sign > 0 ? *next : here, tolerance, searched, last_step);
    if (!root) break;
    constexpr double aside = 100 * searched;
    const auto low = beside(map, root->swing, -aside, tolerance), high = beside(map, root->swing, aside, tolerance);
    if (!low || !high || !(high->growth < low->growth)) break;
    return {.balance = root->swing,
            .slope = (high->growth - low->growth) / (2 * aside),
            // By what the slopes of both sides differ by.
            .slope_error = (std::abs(high->growth + low->growth) / 2 + high->scatter + low->scatter) / aside,
            .last = {},
            .turns = turns};
  }
  return {.balance = {}, .last = here, .turns = turns};
}

std::optional<Return> return_after(ReturnMap& map, const SlowSwing& last, const SlowSwing& first, double tolerance) {
  constexpr int places = 4, most_passages = 300, relaxed = 4;
  constexpr double jump = 1.5, as_large = 0.3;
  const long most_steps = map.cost().steps + 300'000;
  double least = infinity, largest = -infinity, growth = 0;
  for (int place = 0; place < places; ++place) {
    auto y = last.y;
    y[at_displacement] = last.middle + last.stretch * std::exp(last.growth * place / places);
    double amplitude = last.amplitude;
    bool jumped = false;
    for (int k = 0, since = 0; !jumped || since < relaxed || amplitude < as_large * first.amplitude; ++k, ++since) {
      if (k == most_passages || map.cost().steps > most_steps) return std::nullopt;
      const auto passage = map.follow(y, tolerance, 1, true, Derivative::none, nullptr, dip_of(amplitude));
      if (!passage.outcome.complete()) return std::nullopt;
      if (passage.amplitude > jump * amplitude) jumped = true, since = 0;
      y = passage.end;
      amplitude = passage.amplitude;
    }
    const auto next = slow_swing_from(map, y, tolerance);
    if (!next) return std::nullopt;
    growth = next->growth;
    const double size = std::log(next->stretch);
    least = std::min(least, size), largest = std::max(largest, size);
  }
  return Return{largest - least, growth};
}

std::optional<double> balance_closely(ReturnMap& map, SlowEnd& end, double tolerance) {
  constexpr double first = 1e-9, widest = 1e-3;
  const long last_step = map.cost().steps + 500'000;  // a reversal under stiff friction may take 20 000 at a time
  for (double aside = first; aside < widest; aside *= 10) {
    const auto low = beside(map, *end.balance, -aside, tolerance), high = beside(map, *end.balance, aside, tolerance);
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
