/// Periodic orbits: from stick to the attracting cycle by the return map and Newton's method; errors by two tolerances.
#include "analysis/cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <numbers>

#include "analysis/curve.hpp"
#include "analysis/return_map.hpp"
#include "analysis/stability.hpp"
#include "core/eigenpairs.hpp"
#include "solvers/stick_slip.hpp"

namespace rosin::analysis {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using oscillators::SliderSystem;

const std::vector<MetricName>& metric_names() {
  static const std::vector<MetricName> list = {
      {"period", "s", "period of the motion", &Metrics::period},
      {"slip_rate_max", "m/s", "largest slip rate", &Metrics::slip_rate_max},
      {"slip_rate_min", "m/s", "smallest slip rate", &Metrics::slip_rate_min},
      {"friction_max", "1", "largest coefficient of friction", &Metrics::friction_max},
      {"friction_min", "1", "smallest coefficient of friction", &Metrics::friction_min},
      {"friction_mean", "1", "mean coefficient of friction", &Metrics::friction_mean},
      {"stick_fraction", "1", "part of the period with |v| <= threshold * V", &Metrics::stick_fraction},
      {"stick_fraction_001", "1", "part of the period with |v| <= 0.01 V", &Metrics::stick_fraction_001},
      {"stick_fraction_05", "1", "part of the period with |v| <= 0.5 V", &Metrics::stick_fraction_05},
      {"loop_area", "m/s", "area enclosed by the friction-velocity loop", &Metrics::loop_area},
      {"loop_area_normalised", "1", "loop area over largest slip rate and friction", &Metrics::loop_area_normalised},
      {"slip_rate_mean", "m/s", "mean slip rate (the drive speed, on a true cycle)", &Metrics::slip_rate_mean},
  };
  return list;
}

const MetricName& find_metric(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& metric : metric_names()) {
    if (name == metric.name) return metric;
    known.emplace_back(metric.name);
  }
  const auto near = nearest_name(name, known);
  throw InputError(fmt::format("unknown metric '{}'{}", name,
                               near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
}

double size_of(const MetricName& metric, const Metrics& m, double V) {
  const double value = std::abs(m.*metric.member);
  if (metric.member == &Metrics::slip_rate_min) return std::max(value, V);
  if (metric.unit[0] == '1' && metric.member != &Metrics::loop_area_normalised) return 1;
  if (metric.member == &Metrics::loop_area) return std::max(value, 0.1 * m.slip_rate_max * m.friction_max);
  if (metric.member == &Metrics::loop_area_normalised) return std::max(value, 0.1);
  return value;
}

bool is_loop(const MetricName& metric) {
  return metric.member == &Metrics::loop_area || metric.member == &Metrics::loop_area_normalised;
}
bool is_stick(const MetricName& metric) {
  return metric.member == &Metrics::stick_fraction || metric.member == &Metrics::stick_fraction_001 ||
         metric.member == &Metrics::stick_fraction_05;
}

namespace {
/// Damping of the slider and of steady friction that rises with the slip rate together, N s/m.
double resistance(const Model& model) {
  const double N = model.drive.normal_load.level(), V = model.drive.speed.level();
  return model.slider.damping + N * std::max(model.law->steady_friction({V, N}).slope, 0.0);
}
bool overdamped(const Model& model) {
  return resistance(model) > 2 * std::sqrt(model.slider.mass * model.slider.stiffness);
}
}  // namespace

double swing_time(const Model& model) {
  const auto& s = model.slider;
  return overdamped(model) ? resistance(model) / s.stiffness : 2 * std::numbers::pi * std::sqrt(s.mass / s.stiffness);
}

namespace {

constexpr double loose = 1e-6;        ///< tolerance of the search for motions of the size of the drive speed
constexpr long most_steps = 300'000;  ///< of one search
constexpr double collapsed = 1e-5;    ///< amplitudes |v − V|/V below this are steady sliding

/// Small motions are followed more closely: what matters are errors against their drift, which falls with A². So are
/// those of a slow `drift` ln(A'/A) in a passage.
double search_tolerance(double amplitude, double drift) {
  return std::clamp(1e-3 * std::abs(drift), 1e-13, loose) * std::clamp(amplitude * amplitude, 1e-6, 1.0);
}

/// What a motion of some amplitude |v − V|/V must dip below V to count as having left it.
double dip_of(double amplitude) { return std::max(1e-6 * std::min(1.0, amplitude), ReturnMap::least_dip); }

/// A fixed point of the return map.
struct FixedPoint {
  std::vector<double> y;
  MatrixXd derivative;
  int turns = 1;
  double amplitude = 0;
  bool by_differences = false;  ///< the derivative is that of neighbouring passages
};

/// Moduli of the multipliers, largest first.
std::vector<std::complex<double>> multipliers_of(const MatrixXd& derivative, const VectorXd& scale) {
  const MatrixXd balanced = scale.cwiseInverse().asDiagonal() * derivative * scale.asDiagonal();
  const auto found = eigenpairs(balanced).values;
  std::vector<std::complex<double>> values(found.data(), found.data() + found.size());
  std::sort(values.begin(), values.end(), [](auto a, auto b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
  });
  values.pop_back();  // the projection's own zero: the direction off the section
  return values;
}

double spectral_radius(const FixedPoint& point, const ReturnMap& map) {
  const auto values = multipliers_of(point.derivative, map.scale());
  return values.empty() ? 0 : std::abs(values.front());
}

/// Newton's method for y = P(y), kept from falling onto steady sliding, which is a fixed point too.
std::optional<FixedPoint> newton(ReturnMap& map, std::vector<double> y, int turns, double amplitude, double drift) {
  const double least_amplitude = 0.4 * amplitude, tolerance = search_tolerance(amplitude, drift);
  // In near-stick a slip at many times V is but a few scales away.
  const double size = std::min(amplitude, map.distance(y, map.system().steady(0)));
  const VectorXd scale = map.scale();
  const MatrixXd I = MatrixXd::Identity(scale.size(), scale.size());
  std::vector<double> last = y;
  VectorXd step;
  double residual = infinity, factor = 1;
  int halvings = 0;
  for (int iteration = 0; iteration < 14; ++iteration) {
    const auto passage = map.follow(y, tolerance, turns, true, true, nullptr, dip_of(amplitude));
    const double now = passage.outcome.complete() ? map.distance(passage.end, y) / std::max(size, 1e-12) : infinity;
    if (passage.amplitude < least_amplitude || !(now < residual)) {
      if (iteration == 0 || ++halvings > 2) return std::nullopt;
      factor *= 0.3;
      y = map.moved(last, step, factor);
      continue;
    }
    halvings = 0;
    const MatrixXd A = scale.cwiseInverse().asDiagonal() * (I - passage.derivative) * scale.asDiagonal();
    step =
        scale.asDiagonal() * A.partialPivLu().solve(scale.cwiseInverse().asDiagonal() * map.difference(passage.end, y));
    if (!step.allFinite()) return std::nullopt;
    const double length = (step.array() / scale.array()).matrix().norm() / std::max(size, 1e-12);
    if (length < std::max({30 * tolerance, 1e-8, 0.1 * tolerance / std::max(std::abs(drift), tolerance)}))
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
std::optional<FixedPoint> settled(ReturnMap& map, const std::vector<double>& y, int turns, double amplitude) {
  const double dip = dip_of(amplitude), size = map.distance(y, map.system().steady(0));
  const auto passage = map.follow(y, loose, turns, true, false, nullptr, dip);
  if (!passage.outcome.complete() || !(map.distance(passage.end, y) < 1e-2 * size)) return std::nullopt;
  const int n = int(map.differential().size());
  FixedPoint point{passage.end, MatrixXd::Zero(n, n), turns, passage.amplitude, true};
  const double share = 0.05 * std::min(size, 2.0);
  for (int k = 0; k < n; ++k) {
    const VectorXd step = VectorXd::Unit(n, k) * (share * map.scale()[k]);
    const auto start = map.moved(y, step, 1);
    if (start == y) continue;  // off the section
    auto neighbour = map.follow(start, loose, turns, true, false, nullptr, dip);
    if (neighbour.outcome.complete() && neighbour.duration < 0.5 * passage.duration)  // it began beside the section
      neighbour = map.follow(neighbour.end, loose, turns, true, false, nullptr, dip);
    if (!neighbour.outcome.complete()) return std::nullopt;
    point.derivative.col(k) = map.difference(neighbour.end, passage.end) / step[k];
  }
  return point;
}

/// Near a Hopf point the amplitude drifts slowly along one direction. This finds where the drift per passage,
/// r(A) = ln(A'/A), falls through zero: a stable cycle. A is the distance of the section point from steady sliding,
/// which is smooth. `y` lies on the section. Returns a section point near the cycle.
std::optional<std::vector<double>> balance_of_drift(ReturnMap& map, const std::vector<double>& y, double amplitude,
                                                    double drift_at_rest) {
  const auto steady = map.system().steady(0);
  const double start = map.distance(y, steady), least = 0.02 * start / amplitude;
  VectorXd direction = map.difference(y, steady) / start;
  struct Drift {
    double size, rate;
    std::vector<double> y;
  };
  // Two passages: the first relaxes the fast directions, the second shows the drift.
  const auto drift = [&](double size) -> std::optional<Drift> {
    const double A = amplitude * size / start, tolerance = search_tolerance(A, drift_at_rest), dip = dip_of(A);
    const auto first = map.follow(map.moved(steady, direction, size), tolerance, 1, true, false, nullptr, dip);
    if (!first.outcome.complete()) return std::nullopt;
    const auto second = map.follow(first.end, tolerance, 1, true, false, nullptr, dip);
    if (!second.outcome.complete()) return std::nullopt;
    const double a = map.distance(first.end, steady), b = map.distance(second.end, steady);
    if (!(a > 0 && b > 0)) return std::nullopt;
    direction = map.difference(second.end, steady) / b;
    return Drift{a, std::log(b / a), second.end};
  };
  auto high = drift(start);
  if (!high) return std::nullopt;
  // The lower end: drift that grows. At rest it is that of the linear mode; above a stable steady state it is sought.
  double low = 0, low_rate = drift_at_rest;
  for (int larger = 0; high->rate > 0; ++larger) {
    low = high->size, low_rate = high->rate;
    high = drift((larger < 8 ? 1.05 : 1.25) * low);
    if (!high || larger > 40) return std::nullopt;
  }
  for (double size = 0.8 * high->size; low_rate <= 0 && size > least; size *= 0.8) {
    const auto here = drift(size);
    if (!here) return std::nullopt;
    if (here->rate > 0)
      low = here->size, low_rate = here->rate;
    else
      high = here;
  }
  if (low_rate <= 0) return std::nullopt;
  for (int iteration = 0; iteration < 20; ++iteration) {
    // Drift is nearly linear in the squared amplitude.
    const double l2 = low * low, h2 = high->size * high->size, width = h2 - l2;
    const double a2 = std::clamp(l2 + width * low_rate / (low_rate - high->rate), l2 + 1e-4 * width, h2 - 1e-4 * width);
    const auto here = drift(std::sqrt(a2));
    if (!here) return std::nullopt;
    if (std::abs(here->rate) < 0.02 * low_rate || width < 1e-3 * h2) return here->y;
    if (here->rate > 0)
      low = here->size, low_rate = here->rate;
    else
      high = here;
  }
  return high->y;
}

/// What a search ends with: a stable fixed point, or why there is none.
struct Search {
  std::optional<FixedPoint> point;
  Outcome outcome;
};

/// `drift_at_rest`: growth of a small oscillation about steady sliding in one period, ln(A'/A).
Search search(ReturnMap& map, double drift_at_rest, int max_cycles, const std::optional<Start>& start) {
  Search result;
  const bool steady_is_stable = drift_at_rest < 0;
  const double V = map.drive_speed();
  // From stick with the state of steady sliding, then from longer stick: its larger first slip can lie in the basin of
  // a cycle beside stable sliding that the first start misses, and does not fall straight onto an unstable steady
  // state.
  std::vector<double> ages = {V};
  if (steady_is_stable) max_cycles = std::min(max_cycles, 12);
  ages.push_back((steady_is_stable ? 1e-4 : 0.1) * V);
  constexpr int most_creeping = 9;
  int creeping = 0;  ///< times that motion far from any cycle was found neither to settle nor to grow
  const auto attracts = [&](const std::optional<FixedPoint>& point) {
    return point && point->amplitude >= collapsed && spectral_radius(*point, map) < 1;
  };
  const auto accept = [&](const std::vector<double>& y, int turns, double amplitude, double change) {
    auto found = newton(map, y, turns, amplitude, drift_at_rest);
    constexpr double repeats = 1e-3, certainly = 0.5, hardly = 0.99;
    const double size = map.distance(y, map.system().steady(0));
    if (!attracts(found) && change < repeats * size) {
      found = settled(map, y, turns, amplitude);
      if (found && !(spectral_radius(*found, map) < certainly)) {
        if (spectral_radius(*found, map) > hardly && ++creeping == most_creeping)
          result.outcome = {Ending::budget_spent,
                            fmt::format("the motion hardly changes from passage to passage, by {:.1e} of its size, and "
                                        "a cycle that it may approach was not reached",
                                        change / size)};
        return false;
      }
    }
    if (!attracts(found)) return false;
    result.point = found;
    result.outcome = {};
    return true;
  };
  if (start) ages = {V};
  for (const double aged_at : ages) {
    std::vector<double> y;
    try {
      y = start ? starting_point(map.system(), *start) : map.stick(aged_at);
    } catch (const InputError& e) {
      result.outcome = {Ending::not_finite, e.what()};
      continue;
    }
    result.outcome =
        steady_is_stable
            ? Outcome{Ending::none_exists, fmt::format("the motion started from {} dies out onto steady sliding",
                                                       start ? "the given start" : "stick")}
            : Outcome{Ending::budget_spent, fmt::format("no periodic motion within {} passages", max_cycles)};
    std::vector<std::vector<double>> visited;
    int next_attempt = 2;
    bool enlarged = false, balanced_once = false;
    double last_amplitude = 1;
    for (int k = 0; k < max_cycles; ++k) {
      const auto passage = map.follow(y, loose, 1, k > 0, false, nullptr, dip_of(last_amplitude));
      if (!passage.outcome.complete()) {
        if (passage.outcome.ending != Ending::budget_spent || !steady_is_stable) result.outcome = passage.outcome;
        break;
      }
      if (map.cost().steps > most_steps) {
        result.outcome = {Ending::budget_spent, fmt::format("no periodic motion within {} steps", most_steps)};
        break;
      }
      y = passage.end;
      visited.push_back(y);
      const double amplitude = last_amplitude = passage.amplitude;
      if (k > 0 && steady_is_stable && amplitude < 0.02) break;
      if (!steady_is_stable && !enlarged && amplitude < 1e-3) {
        // An overdamped start has all but reached steady sliding, which repels: go on from where growth would lead.
        if (amplitude < 1e-11) break;
        const auto steady = map.system().steady(0);
        // States that changed more than the speed did are not carried away by it.
        y = map.moved(steady, map.difference(y, steady), std::min(0.1 / amplitude, 1 / map.distance(y, steady)));
        enlarged = true;
        continue;
      }
      const double moved = k > 0 ? map.distance(y, visited[k - 1]) : infinity, change = moved / amplitude;
      if (k < next_attempt && !(k > 0 && change < 1e-3)) continue;
      next_attempt = k + std::max(2, k / 2);
      // Motion that hardly drifts is not waited for.
      constexpr double slow = 1e-3;
      const bool drifts = k >= 2 && std::abs(drift_at_rest) < slow && amplitude < 10 && !balanced_once;
      if (!drifts && accept(y, 1, amplitude, moved)) return result;
      if (creeping == most_creeping) return result;
      // Several passages in a period: as many as bring the motion nearly back.
      for (int turns = 2; turns <= 8 && turns < k; ++turns)
        if (map.distance(y, visited[k - turns]) < 0.2 * map.distance(y, visited[k - 1]) &&
            accept(y, turns, amplitude, map.distance(y, visited[k - turns])))
          return result;
      if (k >= 6 || (steady_is_stable && k >= 3) || drifts) {
        balanced_once = true;
        const auto balanced = balance_of_drift(map, y, amplitude, drift_at_rest);
        if (balanced) {
          const auto there = map.follow(*balanced, search_tolerance(amplitude, drift_at_rest), 1, true, false, nullptr,
                                        dip_of(amplitude));
          if (there.outcome.complete() && accept(there.end, 1, there.amplitude, infinity)) return result;
        }
        if (!balanced && steady_is_stable) break;
      }
    }
  }
  return result;
}

/// Metrics of the cycle through `point` at one tolerance; moves the point onto the cycle.
struct Refined {
  Metrics metrics;
  double closure;  ///< remaining change of the section point, in scales
  std::vector<CyclePoint> orbit;
  Outcome outcome;
};
Refined refine(ReturnMap& map, FixedPoint& point, double tolerance, double stick_threshold, bool keep_orbit) {
  Refined result{{}, infinity, {}, {}};
  const VectorXd scale = map.scale();
  const MatrixXd I = MatrixXd::Identity(scale.size(), scale.size());
  const auto lu =
      MatrixXd(scale.cwiseInverse().asDiagonal() * (I - point.derivative) * scale.asDiagonal()).partialPivLu();
  for (int iteration = 0; iteration < 12; ++iteration) {
    const auto passage = map.follow(point.y, tolerance, point.turns, true, false, nullptr, dip_of(point.amplitude));
    if (!passage.outcome.complete()) {
      result.outcome = passage.outcome;
      return result;
    }
    const VectorXd step =
        scale.asDiagonal() * lu.solve(scale.cwiseInverse().asDiagonal() * map.difference(passage.end, point.y));
    const double length = (step.array() / scale.array()).matrix().norm();
    if (!std::isfinite(length) || length > 0.5 * result.closure) break;  // rounding reached
    point.y = map.moved(point.y, step, 1);
    result.closure = length;
    if (length < 0.1 * tolerance * std::min(1.0, point.amplitude)) break;
  }
  Recorder recorder(map.system(), tolerance, stick_threshold, keep_orbit);
  const auto passage = map.follow(point.y, tolerance, point.turns, true, false, &recorder, dip_of(point.amplitude));
  result.outcome = passage.outcome;
  result.metrics = recorder.finish(passage.duration);
  result.orbit = std::move(recorder.orbit);
  return result;
}

/// Several turns that were taken together, because each seemed to differ from the next, may prove to be one and the
/// same. True if so; `point` is known to be on the cycle within `closure`, in scales.
bool fewer_turns_do(ReturnMap& map, FixedPoint& point, double tolerance, double closure) {
  constexpr double largest = 1e-2;
  const double same = std::min(10 * closure, largest * map.distance(point.y, map.system().steady(0)));
  for (int fewer = 1; 2 * fewer <= point.turns; ++fewer) {
    if (point.turns % fewer != 0) continue;
    const auto passage =
        map.follow(point.y, tolerance, fewer, true, !point.by_differences, nullptr, dip_of(point.amplitude));
    if (!passage.outcome.complete() || map.distance(passage.end, point.y) > same) continue;
    point.turns = fewer;
    if (point.by_differences)
      point.derivative.setZero();  // bounded by that of all turns, which forget what they began with
    else
      point.derivative = passage.derivative;
    return true;
  }
  return false;
}

/// Errors of `fine` by its difference to `coarse`, a result at a hundred times the tolerance or more; never below what
/// the tolerance and rounding allow. Returns the worst ratio of error to size.
double estimate_errors(const Metrics& coarse, const Metrics& fine, double tolerance, double closure, double V,
                       bool stick_is_ill_conditioned, Metrics& error, std::string& worst) {
  double largest = 0;
  for (const auto& metric : metric_names()) {
    const double size = size_of(metric, fine, V), value = fine.*metric.member;
    // The loop integral scatters with the division of its steps; three times its difference was seen to fall short.
    double e = (is_loop(metric) ? 6 : 3) * std::abs(coarse.*metric.member - value);
    if (value != 0)
      // The lowest slip rate is held to its own size; in slow stick it is as good as the error estimate of the steps
      // only.
      e += metric.member == &Metrics::slip_rate_min ? (10 * tolerance + 5e-14 + closure) * std::abs(value)
                                                    : (3 * tolerance + 5e-14 + closure) * size;
    // Divided steps are each summed to a small part of the tolerance.
    if (value != 0 && metric.member == &Metrics::loop_area)
      e += 0.3 * std::max(tolerance, 1e-13) * fine.slip_rate_max * fine.friction_max;
    if (value != 0 && metric.member == &Metrics::loop_area_normalised) e += 0.3 * std::max(tolerance, 1e-13);
    error.*metric.member = e;
    if (is_stick(metric) && stick_is_ill_conditioned) continue;
    const double ratio = std::isfinite(e / size) ? e / size : infinity;
    if (ratio > largest) largest = ratio, worst = metric.name;
  }
  return largest;
}

/// The next factor on the tolerance where the error found is to fall by `wanted`: errors of moderately stiff unknowns
/// follow the estimate, which is the tolerance to the power 2/3.
double next_sharpening(double wanted) { return std::clamp(0.3 * std::pow(wanted, 1.5), 1e-4, 0.01); }

Cycle find_smooth_cycle(const Model& model, const CycleOptions& options) {
  Cycle cycle;
  // Growth in one turn of the leading oscillation; of one e-folding time where it does not oscillate.
  const auto leading = stability(model).eigenvalues.front();
  const double turn = 2 * std::numbers::pi / std::max(std::abs(leading.imag()), std::abs(leading.real()));
  ReturnMap map(model);
  if (map.differential().size() < 2) {
    cycle.outcome = {Ending::none_exists, "one unknown alone evolves, and that cannot oscillate (no mass, no memory)"};
    return cycle;
  }
  auto found = search(map, leading.real() * turn, options.max_cycles, options.start);
  cycle.cost = map.cost();
  if (!found.point) {
    cycle.outcome = found.outcome;
    return cycle;
  }
  FixedPoint& point = *found.point;
  const double V = map.drive_speed();
  // Small or weakly attracting cycles magnify errors by 1/A and 1/(1 − ρ).
  const double magnified = std::min(1.0, point.amplitude) * std::min(1.0, 1 - spectral_radius(point, map));
  double tolerance = 0.2 * options.tolerance * magnified;
  Refined coarse = refine(map, point, tolerance, options.stick_threshold, false);
  const bool fewer = coarse.outcome.complete() && fewer_turns_do(map, point, tolerance, coarse.closure);
  if (fewer) coarse = refine(map, point, tolerance, options.stick_threshold, false);
  std::string worst;
  double sharpening = 0.01;
  for (int attempt = 0; attempt < 4; ++attempt) {
    tolerance = std::max(sharpening * tolerance, solvers::Collocation::least_tolerance);
    const bool last_possible = tolerance <= solvers::Collocation::least_tolerance;
    Refined fine = refine(map, point, tolerance, options.stick_threshold, true);
    if (!coarse.outcome.complete() || !fine.outcome.complete()) {
      cycle.outcome = coarse.outcome.complete() ? fine.outcome : coarse.outcome;
      break;
    }
    const double lowest = fine.metrics.slip_rate_min;
    cycle.ill_conditioned_stick = false;
    for (const double e : {options.stick_threshold, 0.01, 0.5})
      if (std::abs(std::abs(lowest) - e * V) < 1e-4 * e * V) cycle.ill_conditioned_stick = true;
    // Rounding in one passage returns with every one that the cycle takes to forget it.
    const double forgetting = 1e-14 / std::max(1 - spectral_radius(point, map), 1e-14);
    const double reached = estimate_errors(coarse.metrics, fine.metrics, tolerance, fine.closure + forgetting, V,
                                           cycle.ill_conditioned_stick, cycle.error, worst);
    cycle.metrics = fine.metrics;
    cycle.orbit = std::move(fine.orbit);
    cycle.outcome = {};
    if (reached <= options.tolerance) break;
    cycle.outcome = {Ending::tolerance_not_met, fmt::format("{} is known to {:.1e} only", worst, reached)};
    if (last_possible) break;
    sharpening = next_sharpening(options.tolerance / reached);
    coarse = std::move(fine);
  }
  if (options.multipliers && !point.by_differences) {
    const auto passage =
        map.follow(point.y, std::max(tolerance, 1e-10), point.turns, true, true, nullptr, dip_of(point.amplitude));
    if (passage.outcome.complete()) point.derivative = passage.derivative;
  }
  // Of fewer turns than differences were taken over, multipliers are bounded but not known.
  if (!(fewer && point.by_differences)) cycle.multipliers = multipliers_of(point.derivative, map.scale());
  cycle.stable = cycle.multipliers.empty() || std::abs(cycle.multipliers.front()) < 1;
  const auto at_section = map.system().observe(0, point.y.data());
  cycle.section_displacement = at_section.displacement;
  cycle.section_state = at_section.state;
  cycle.cost = map.cost();
  return cycle;
}

/// True where the contact carries states of its own.
bool remembers(const Model& model) { return model.law->has_states() && model.lambda > 0; }

/// One period of stick–slip: from one onset of slip along the drive to the next.
struct StickSlipPeriod {
  Outcome outcome;
  Metrics metrics;
  std::vector<CyclePoint> orbit;
  std::vector<double> onset;  ///< unknowns where the period ends
  int slips = 1;              ///< in the period
  double onset_displacement = 0;
  double closure = 0;  ///< relative error that is left because the period does not quite return
  bool found = false;
  double closest = infinity;  ///< lowest slip rate after the first half of a slip, over the drive speed
  bool grazes = false;        ///< slip comes to rest or not by less than the tolerance tells
  double rounding = 0;        ///< relative error that rounding of the slip rate makes where it just comes to rest
  double landing = 0;         ///< to which the times at which slip stops are known together (s)
  long steps = 0, evaluations = 0;
};

/// The period of so many slips that begins at the `onset` of slip, or else the first full one after stick from rest.
StickSlipPeriod stick_slip_period(const Model& model, double tolerance, double stick_threshold,
                                  const std::vector<double>* onset = nullptr, int slips = 1) {
  StickSlipPeriod result;
  SliderSystem system(model);
  solvers::StickSlip solver(system, tolerance);
  const double V = model.drive.speed.level();
  const auto& s = model.slider;
  const auto rest = model.law->rest(model.drive.normal_load.level());
  if (!(onset ? solver.start_slip(0, *onset, 1) : solver.start(0, system.loaded_at_rest(rest, 0.5)))) {
    result.outcome = {Ending::not_finite, "at the start"};
    return result;
  }
  const double natural = 2 * std::numbers::pi * std::sqrt(s.mass / s.stiffness);
  const double longest = 300 * natural + 10 * std::abs(system.loaded_at_rest(rest, 1)[0]) / V;
  solver.rewind_at_switches();  // a slip may be far shorter than the last digit of the stick before it
  const auto sliding = stability(model);
  const double frequency = std::sqrt(s.stiffness / s.mass), swing = swing_time(model);
  solver.bound_slip_step(0.1 * swing);
  constexpr double settled = 1e-5;  // of the drive speed: amplitudes below it decay onto stable sliding
  constexpr double last_digits = 8 * std::numeric_limits<double>::epsilon();
  // Slip rate that the last digits of the spring's force make.
  const double noise = last_digits * s.stiffness * std::abs(sliding.steady.displacement) /
                       std::max(resistance(model), std::sqrt(s.stiffness * s.mass));
  constexpr double many = 300, quiet_enough = 20;  // swings
  double quiet = 0, slipping = 0;                  // s, in which slip has gone at the drive's speed, or gone on at all
  Recorder recorder(system, tolerance, stick_threshold, true);
  bool began = onset != nullptr, fast = false;
  double elapsed = 0, period = 0, stuck = 0, fastest = V, highest = 0, slip = 0, lowest_x = infinity,
         highest_x = -infinity;
  std::vector<double> rate(system.size());
  while (elapsed < longest) {
    if (solver.stepper().count().steps > 200'000) {
      result.outcome = {Ending::budget_spent, "no period of stick and slip within 200000 steps"};
      break;
    }
    solvers::Switch switched;
    const Outcome outcome = solver.step(longest, switched);
    if (!outcome.complete()) {
      result.outcome = outcome;
      break;
    }
    elapsed += solver.stepper().length();
    if (began) {
      recorder.step(solver.stepper());
      period += solver.stepper().length();
      if (system.direction() == 0) stuck += solver.stepper().length();
      lowest_x = std::min(lowest_x, solver.state()[0]), highest_x = std::max(highest_x, solver.state()[0]);
    }
    const double u = system.slip_rate(solver.time(), solver.state().data());
    fast = fast || u > V;
    const double away = std::hypot(u - V, frequency * (solver.state()[0] - sliding.steady.displacement));
    quiet = std::abs(u - V) < settled * V + noise ? quiet + solver.stepper().length() : 0;
    slipping = system.direction() != 0 && switched == solvers::Switch::none ? slipping + solver.stepper().length() : 0;
    if (sliding.stable && (away < settled * V + noise || quiet > quiet_enough * swing)) break;
    // Without memory slip that has gone on for so long has found its own cycle.
    if (slipping > many * swing && !remembers(model)) break;
    if (fast && switched == solvers::Switch::none) result.closest = std::min(result.closest, solver.lowest() / V);
    if (began) fastest = std::max(fastest, std::abs(u));
    const double before = highest, slip_before = slip;  // of this slip
    slip = std::abs(u);
    highest = system.direction() == 0 || switched != solvers::Switch::none ? 0 : std::max(highest, std::abs(u));
    if (began && before > V) {
      const double lowest = std::min(solver.lowest(), slip_before);
      double dip = switched == solvers::Switch::none && 2 * lowest < slip ? lowest : infinity;
      if (switched == solvers::Switch::stick) {
        // Slip that only just comes to rest does so at a time that hangs on the last digits of the slip rate.
        const auto& stop = solver.stepper().state();
        system.evaluate(solver.time(), stop.data(), rate.data());
        const double slowing = std::abs(rate[system.slip_rate_index()]) / s.mass;
        result.landing += std::max(tolerance, 1e-15) * before / slowing;
        dip = 0.5 * slowing * slowing * s.mass / (s.stiffness * V);  // to which the spring would have let it go on
      }
      // The last digits of the highest slip rate, unless damping makes slip forget them, are lost where it comes to
      // rest, and with them that part of how hard it does.
      constexpr double known = 1e-16, grazing = 100;
      const double lost = overdamped(model) ? 0 : known * before / dip;
      result.grazes = result.grazes || grazing * tolerance * lost > known;
      result.rounding += lost;
      if (lost > 1) {
        result.outcome = {
            Ending::tolerance_not_met,
            fmt::format("at {:.1e} of the highest slip rate, which is rounding, slip comes to rest or not",
                        dip / before)};
        break;
      }
    }
    if (switched != solvers::Switch::slip || solver.upcoming() < 0) continue;
    // The mean slip rate is V. Slip that did not pass it, such as rounding makes at its onset, is no period yet.
    if (began && fastest == V) continue;
    if (began && --slips > 0) {
      fastest = V;
      continue;
    }
    if (began) {
      result.metrics = recorder.finish(period);
      result.metrics.stick_fraction = stuck / period;
      // Stick is rest; the end of a located slip is rest but for rounding.
      if (std::abs(result.metrics.slip_rate_min) < 1e-10 * V) result.metrics.slip_rate_min = 0;
      result.orbit = std::move(recorder.orbit);
      result.onset = solver.state();
      result.onset_displacement = result.onset[0];
      // Slip begins where the spring is loaded beyond the last digits of its force.
      const double digits = 1e-14 * std::max(std::abs(lowest_x), std::abs(highest_x));
      result.closure = result.landing / period + digits / (highest_x - lowest_x) + result.rounding;
      result.found = true;
      break;
    }
    began = true;
  }
  result.steps = solver.stepper().count().steps;
  result.evaluations = solver.stepper().count().evaluations;
  return result;
}

/// The return of contact states from onset to onset, about the fixed point that periods from stick lead to.
class OnsetMap {
 public:
  OnsetMap(const Model& model, double tolerance, double stick_threshold, int slips = 1)
      : model_(model), system_(model), tolerance_(tolerance), stick_threshold_(stick_threshold), slips_(slips) {
    std::vector<double> s(system_.size());
    const std::vector<double> rest(system_.size());
    system_.scale(rest.data(), s.data());
    scale_ = Eigen::Map<VectorXd>(s.data(), s.size()).tail(s.size() - mechanical);
  }

  /// The period that repeats itself.
  StickSlipPeriod cycle() {
    auto period = stick_slip_period(model_, tolerance_, stick_threshold_);
    if (!period.found || scale_.size() == 0) return period;  // without memory stick forgets the past
    long steps = period.steps, evaluations = period.evaluations;
    constexpr int most_periods = 400;
    constexpr long most_steps = 200'000;
    VectorXd z = states_of(period);
    std::vector<VectorXd> onsets, changes;  // of the last periods, as long as they belong together
    double change = infinity, change_before = infinity, closest = infinity;
    VectorXd closest_image;
    bool leapt = false;
    for (int k = 0; k < most_periods && steps < most_steps && period.found; ++k) {
      const Metrics before = period.metrics;
      period = period_from(z);
      if (!period.found) break;
      steps += period.steps, evaluations += period.evaluations;
      const VectorXd step = states_of(period) - z;
      const double now = size_of_step(step, z);
      onsets.push_back(z), changes.push_back(step);
      const VectorXd onward = accelerated(onsets, changes);
      const double known = std::max(tolerance_, 1e-14);  // no state is known better
      const bool settled = now < 10 * known || (k > 3 && now < 1e3 * known && !(now < 0.5 * change));
      // States that count the time at rest scatter as the times at which slip stops. Then the metrics of two periods
      // that both do show what is left.
      if (settled || std::max(now, change) < 3 * scatter(period)) {
        period.closure +=
            settled ? std::max(now, size_of_step(onward, z)) : 10 * largest_change(before, period.metrics);
        period.steps = steps, period.evaluations = evaluations, period.slips = slips_;
        return period;
      }
      if (slips_ == 1 && alternate(onsets, z + step, now)) {
        onsets.clear(), changes.clear();
        closest = change = infinity;
        z += step;
        continue;
      }
      // Plain periods lead to what attracts; where they come in, what they have in common leads there faster.
      constexpr int plain = 6;
      constexpr double comes_in = 0.9999;
      if (leapt && now > 2 * closest) {
        onsets.clear(), changes.clear();
        z = closest_image;
        leapt = false;
      } else {
        if (now < closest) closest = now, closest_image = z + step;
        leapt = k >= plain && std::max(now / change, change / change_before) < comes_in;
        z += leapt ? onward : step;
      }
      change_before = change;
      change = now;
    }
    if (period.found) {
      period.found = false;
      period.outcome = {Ending::budget_spent, "stick and slip do not come to repeat themselves"};
    }
    return period;
  }

  /// Multipliers of the period that ends, and so begins, at `onset`, largest first; none where neighbouring periods
  /// do not return.
  std::vector<std::complex<double>> multipliers(const std::vector<double>& onset) const {
    if (scale_.size() == 0) return {0.0};
    const VectorXd values_at = Eigen::Map<const VectorXd>(onset.data(), onset.size()).tail(scale_.size());
    const MatrixXd D = derivative(values_at);
    if (!D.allFinite()) return {};
    const auto found = eigenpairs(D).values;
    std::vector<std::complex<double>> values(found.data(), found.data() + found.size());
    std::sort(values.begin(), values.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
    return values;
  }

 private:
  static constexpr int mechanical = 2;
  VectorXd states_of(const StickSlipPeriod& period) const {
    return Eigen::Map<const VectorXd>(period.onset.data(), period.onset.size()).tail(scale_.size());
  }
  /// States are measured by themselves: a time at rest may be small or large beside its natural size.
  VectorXd sizes_at(const VectorXd& z) const { return z.cwiseAbs().cwiseMax(1e-12 * scale_); }
  double size_of_step(const VectorXd& step, const VectorXd& z) const { return step.cwiseQuotient(sizes_at(z)).norm(); }
  /// The way from the last onset to the one that repeats itself: Anderson mixing of the last periods, and no farther
  /// than half of what each state is.
  VectorXd accelerated(std::vector<VectorXd>& onsets, std::vector<VectorXd>& changes) const {
    constexpr std::size_t depth = 6;
    const VectorXd z = onsets.back(), step = changes.back(), sizes = sizes_at(z);
    const std::size_t m = std::min({depth, onsets.size() - 1, std::size_t(z.size())});
    if (m == 0) return step;
    MatrixXd moved(z.size(), m), differed(z.size(), m);
    for (std::size_t i = 0; i < m; ++i) {
      const std::size_t at = onsets.size() - 1 - i;
      moved.col(i) = (onsets[at] - onsets[at - 1]).cwiseQuotient(sizes);
      differed.col(i) = (changes[at] - changes[at - 1]).cwiseQuotient(sizes);
    }
    const VectorXd share = differed.colPivHouseholderQr().solve(step.cwiseQuotient(sizes));
    VectorXd onward = step - ((moved + differed) * share).cwiseProduct(sizes);
    if (!onward.allFinite()) return step;
    constexpr double most = 0.5;
    const double farthest = onward.cwiseQuotient(sizes).cwiseAbs().maxCoeff();
    return farthest > most ? VectorXd(onward * (most / farthest)) : onward;
  }
  /// True if slips of two kinds or more follow each other by turns: a period then holds as many. `change`: from the
  /// last onset to z.
  bool alternate(const std::vector<VectorXd>& onsets, const VectorXd& z, double change) {
    constexpr std::size_t settled = 8, most = 8;
    constexpr double alike = 1e-3, apart = 1e-3;
    for (std::size_t n = 2; n <= most && onsets.size() >= settled + n && change > apart; ++n)
      if (size_of_step(z - onsets[onsets.size() - n], z) < alike * change) {
        slips_ = int(n);
        return true;
      }
    return false;
  }
  /// Of the states at the onset that ends a period.
  double scatter(const StickSlipPeriod& period) {
    std::vector<double> f(system_.size()), mass(system_.size());
    system_.set_direction(0);
    system_.evaluate(0, period.onset.data(), f.data());
    system_.mass(0, mass.data());
    system_.set_direction(1);
    VectorXd open(scale_.size());
    for (int k = 0; k < open.size(); ++k) open[k] = period.landing * f[mechanical + k] / mass[mechanical + k];
    return size_of_step(open, states_of(period));
  }
  double largest_change(const Metrics& a, const Metrics& b) const {
    double largest = 0;
    for (const auto& metric : metric_names())
      largest = std::max(
          largest, std::abs(a.*metric.member - b.*metric.member) / size_of(metric, b, model_.drive.speed.level()));
    return largest;
  }
  StickSlipPeriod period_from(const VectorXd& z) const {
    std::vector<double> y(system_.size());
    std::copy(z.data(), z.data() + z.size(), y.begin() + mechanical);
    const auto onset = system_.loaded_at_rest(system_.observe(0, y.data()).state, 1);
    return stick_slip_period(model_, tolerance_, stick_threshold_, &onset, slips_);
  }
  MatrixXd derivative(const VectorXd& z) const {
    const int n = int(z.size());
    MatrixXd D = MatrixXd::Zero(n, n);
    const double part = std::max(1e-4, 100 * tolerance_);
    for (int k = 0; k < n; ++k) {
      const double h = part * sizes_at(z)[k];
      const auto right = period_from(z + h * VectorXd::Unit(n, k)), left = period_from(z - h * VectorXd::Unit(n, k));
      if (!right.found || !left.found) return MatrixXd::Constant(n, n, std::nan(""));
      D.col(k) = (states_of(right) - states_of(left)) / (2 * h);
    }
    return D;
  }

  const Model& model_;
  SliderSystem system_;
  double tolerance_, stick_threshold_;
  int slips_;       ///< in a period
  VectorXd scale_;  ///< of the contact's states
};

/// A passage of slip, which may reverse but does not stick for long, from v = V rising at a displacement `swing` above
/// that of steady sliding to the next such passage. Two mechanical unknowns, so the section is a line.
StickSlipPeriod slip_passage(const Model& model, double swing, double tolerance, double stick_threshold, bool record) {
  StickSlipPeriod result;
  SliderSystem system(model);
  solvers::StickSlip solver(system, tolerance);
  const double V = model.drive.speed.level(), x_steady = steady_sliding(model).displacement;
  const double natural = 2 * std::numbers::pi * std::sqrt(model.slider.mass / model.slider.stiffness);
  solver.bound_slip_step(0.1 * natural);
  if (!solver.start(0, system.unknowns_at(0, x_steady + swing, V, {}, 0))) {
    result.outcome = {Ending::not_finite, "at the start"};
    return result;
  }
  Recorder recorder(system, tolerance, stick_threshold, true);
  const auto section = [&](double t, const double* y) { return system.slip_rate(t, y) - V; };
  const double longest = 100 * natural + 10 * std::abs(system.loaded_at_rest({}, 1)[0]) / V;
  bool below = false;
  double period = 0, stuck = 0;
  std::vector<double> y(system.size());
  while (!result.found && solver.time() < longest && solver.stepper().count().steps < 5'000) {
    solvers::Switch switched;
    result.outcome = solver.step(longest, switched);
    if (!result.outcome.complete()) break;
    auto& step = solver.stepper();
    double low = 0, low_value = section(step.time_before(), step.state_before().data());
    for (int i = 0; i < solvers::Collocation::stages; ++i) {
      step.stage(i, y.data());
      const double value = section(step.stage_time(i), y.data());
      if (below && value >= 0) {
        const auto located = step.locate(section, low, step.node(i), std::min(low_value, -1e-300), value);
        result.found = located && step.shorten(*located);
        break;
      }
      if (value < -1e-10 * V) below = true;
      low = step.node(i), low_value = value;
    }
    period += step.length();
    if (system.direction() == 0) stuck += step.length();
    if (record) recorder.step(step);
  }
  if (result.found) {
    result.onset_displacement = solver.state()[0] - x_steady;  // the next swing
    if (record) {
      result.metrics = recorder.finish(period);
      result.metrics.stick_fraction = stuck / period;
      result.orbit = std::move(recorder.orbit);
    }
  }
  result.steps = solver.stepper().count().steps;
  result.evaluations = solver.stepper().count().evaluations;
  return result;
}

/// Static limit of a contact without memory.
double static_limit_of_curve(const Model& model) {
  const double N = model.drive.normal_load.level();
  return model.law->static_limit(N, model.law->steady({0, N}));
}

/// The swing at which slip that never sticks repeats itself: where the drift ln(A'/A) falls through zero.
std::optional<double> balanced_swing(const Model& model, double tolerance) {
  const double natural = std::sqrt(model.slider.mass / model.slider.stiffness);
  const double largest = model.drive.speed.level() * natural +
                         2 * model.drive.normal_load.level() * static_limit_of_curve(model) / model.slider.stiffness;
  const auto drift = [&](double log_swing) {
    const auto passage = slip_passage(model, std::exp(log_swing), tolerance, 0.1, false);
    return passage.found && passage.onset_displacement > 0 ? std::log(passage.onset_displacement) - log_swing : -1.0;
  };
  double high = std::log(8 * largest), f_high = drift(high);
  for (double low = high - 0.25; low > high - 12 && f_high < 0; low -= 0.25) {
    const double f_low = drift(low);
    if (f_low <= 0) {
      high = low, f_high = f_low;
      continue;
    }
    std::uintmax_t iterations = 100;
    const auto [a, b] = boost::math::tools::toms748_solve(drift, low, high, f_low, f_high,
                                                          boost::math::tools::eps_tolerance<double>(50), iterations);
    return std::exp(0.5 * (a + b));
  }
  return std::nullopt;
}

/// True where friction never falls with slip rate, not even from rest: then two motions never part, and none repeats
/// itself but steady sliding (or free oscillation about it, which nothing attracts).
bool never_weakens(const Model& model) {
  const auto& law = *model.law;
  const double N = model.drive.normal_load.level();
  double limit = static_limit_of_curve(model);
  if (remembers(model)) {
    // What slip has taken comes back at a stop or at rest, or never.
    const auto spent = law.after_stop(law.steady({model.drive.speed.level(), N}));
    for (const double rate : law.rate({0, N}, spent))
      if (rate != 0) return false;
    limit = law.static_limit(N, spent);
  }
  constexpr double nearly_rest = 1e-14, rounding = 1e-12;
  return !weakens_somewhere(law, N) && limit <= law.steady_friction({nearly_rest, N}).friction * (1 + rounding);
}

Cycle find_stick_slip_cycle(const Model& model, const CycleOptions& options) {
  Cycle cycle;
  if (never_weakens(model)) {
    cycle.outcome = {Ending::none_exists, "friction nowhere falls with slip rate: nothing feeds an oscillation"};
    return cycle;
  }
  const double V = model.drive.speed.level();
  double tolerance = 0.2 * options.tolerance;
  bool sticks = true;
  const auto period_at = [&](double tol) -> StickSlipPeriod {
    if (sticks) {
      // Slip that only just comes to rest is missed by a solution that is not better than the miss.
      auto period = OnsetMap(model, tol, options.stick_threshold).cycle();
      constexpr double grazing = 1e-3, sharp = 1e-14;
      const bool missed = !period.found && period.outcome.complete() && period.closest < grazing;
      if ((period.grazes || missed) && tol > sharp) period = OnsetMap(model, sharp, options.stick_threshold).cycle();
      return period;
    }
    const auto swing = balanced_swing(model, tol);
    if (!swing) return {};
    auto period = slip_passage(model, *swing, tol, options.stick_threshold, true);
    period.onset_displacement = steady_sliding(model).displacement + *swing;
    return period;
  };
  StickSlipPeriod coarse = period_at(tolerance);
  const auto sliding = stability(model);
  if (!coarse.found && coarse.outcome.complete() && !sliding.stable && !sliding.marginal && !remembers(model)) {
    sticks = false;
    coarse = period_at(tolerance);
  }
  std::string worst;
  std::vector<double> onset;
  int slips = 1;
  double sharpening = 0.01;
  for (int attempt = 0; attempt < 4; ++attempt) {
    tolerance = std::max(sharpening * tolerance, solvers::Collocation::least_tolerance);
    const bool last_possible = tolerance <= solvers::Collocation::least_tolerance;
    StickSlipPeriod fine = coarse.found ? period_at(tolerance) : coarse;
    cycle.cost.steps += fine.steps + coarse.steps;
    cycle.cost.evaluations += fine.evaluations + coarse.evaluations;
    ++cycle.cost.cycles;
    if (!fine.outcome.complete()) {
      cycle.outcome = fine.outcome;
      return cycle;
    }
    if (!fine.found && attempt > 0) break;  // what was found before stays, as it was known
    if (!fine.found) {
      cycle.outcome = {Ending::none_exists, "slip started from stick neither sticks again nor keeps an amplitude"};
      return cycle;
    }
    const double reached =
        estimate_errors(coarse.metrics, fine.metrics, tolerance, fine.closure, V, false, cycle.error, worst);
    cycle.metrics = fine.metrics;
    cycle.orbit = fine.orbit;
    cycle.section_displacement = fine.onset_displacement;
    if (sticks) onset = fine.onset, slips = fine.slips;
    cycle.outcome = {};
    if (reached <= options.tolerance) break;
    cycle.outcome = {Ending::tolerance_not_met, fmt::format("{} is known to {:.1e} only", worst, reached)};
    if (last_possible) break;
    sharpening = next_sharpening(options.tolerance / reached);
    coarse = std::move(fine);
  }
  if (sticks) {
    cycle.multipliers = OnsetMap(model, 1e-10, options.stick_threshold, slips).multipliers(onset);
    if (remembers(model)) cycle.section_state = SliderSystem(model).observe(0, onset.data()).state;
  } else {
    const double swing = cycle.section_displacement - steady_sliding(model).displacement, h = 1e-4 * swing;
    const auto left = slip_passage(model, swing - h, 1e-10, options.stick_threshold, false);
    const auto right = slip_passage(model, swing + h, 1e-10, options.stick_threshold, false);
    cycle.multipliers = {(right.onset_displacement - left.onset_displacement) / (2 * h)};
  }
  cycle.stable = !cycle.multipliers.empty() && std::abs(cycle.multipliers.front()) < 1;
  return cycle;
}

/// The mirror image: drive, force, displacement, slip rate, friction and odd states with the other sign.
void mirror(Cycle& cycle, const FrictionLaw& law) {
  const auto mirror_states = [&](std::vector<double>& state) {
    for (std::size_t i = 0; i < state.size(); ++i)
      if (law.states()[i].parity == Parity::odd) state[i] = -state[i];
  };
  for (Metrics* m : {&cycle.metrics, &cycle.error}) {
    std::swap(m->slip_rate_max, m->slip_rate_min);
    std::swap(m->friction_max, m->friction_min);
  }
  Metrics& m = cycle.metrics;
  for (auto member : {&Metrics::slip_rate_max, &Metrics::slip_rate_min, &Metrics::friction_max, &Metrics::friction_min,
                      &Metrics::friction_mean, &Metrics::slip_rate_mean})
    m.*member = -(m.*member);
  cycle.section_displacement = -cycle.section_displacement;
  mirror_states(cycle.section_state);
  for (auto& p : cycle.orbit) {
    p.displacement = -p.displacement, p.slip_rate = -p.slip_rate, p.friction_coefficient = -p.friction_coefficient;
    mirror_states(p.state);
  }
}

}  // namespace

bool only_rings(const Model& model) {
  return model.law->deflects() && !weakens_somewhere(*model.law, model.drive.normal_load.level());
}

Cycle find_cycle(const Model& model, const CycleOptions& options) {
  model.check();
  require(options.tolerance, {1e-13, 0.1}, "tolerance", "relative accuracy of a cycle", "1");
  require(options.stick_threshold, {1e-6, 0.999}, "cycle.stick_threshold", "stick threshold over the drive speed", "1");
  const auto& drive = model.drive;
  if (!drive.constant())
    throw InputError(
        "a cycle is sought under a constant drive, but drive.speed, drive.normal_load or drive.force varies");
  const double V = drive.speed.level();
  Cycle cycle;
  if (V == 0) {
    cycle.outcome = {Ending::none_exists, "drive.speed = 0: without a drive the slider comes to rest"};
  } else if (drive.normal_load.level() == 0) {
    cycle.outcome = {Ending::none_exists, "drive.normal_load = 0: there is no friction"};
  } else if (!(model.slider.stiffness > 0) || !std::isfinite(model.slider.stiffness)) {
    cycle.outcome = {Ending::none_exists, "without a spring of finite stiffness there is no oscillation"};
  } else if (V < 0) {
    Model mirrored = model;
    mirrored.drive.speed = -V;
    mirrored.drive.force = -drive.force.level();
    cycle = find_cycle(mirrored, options);
    mirror(cycle, *model.law);
  } else if (only_rings(model)) {
    cycle.outcome = {Ending::none_exists, "friction nowhere falls with slip rate: nothing feeds an oscillation"};
  } else {
    cycle = model.law->set_valued() ? find_stick_slip_cycle(model, options) : find_smooth_cycle(model, options);
    for (const auto& metric : metric_names())
      if (!std::isfinite(cycle.metrics.*metric.member) || !std::isfinite(cycle.error.*metric.member)) {
        const auto cost = cycle.cost;
        cycle = {};
        cycle.cost = cost;
        cycle.outcome = {Ending::not_finite, fmt::format("in {}", metric.name)};
        break;
      }
  }
  return cycle;
}

}  // namespace rosin::analysis
