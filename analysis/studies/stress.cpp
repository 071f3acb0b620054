/// Drawing of random scenes, and the judgement of what an analysis answers to them.
#include "analysis/studies/stress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <numbers>
#include <thread>

#include "analysis/lanes/cycle_lanes.hpp"
#include "analysis/steady/stability.hpp"
#include "core/random.hpp"
#include "core/workers.hpp"

namespace rosin::analysis::studies {

using Clock = std::chrono::steady_clock;
using Real = long double;  // for the digits that cancel in the impedance equation
using Complex = std::complex<Real>;

namespace {

/// Random numbers that depend on seed and index alone.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t index) : state_(seed * splitmix_step) {
    state_ ^= next() + index * 0xD1B54A32D192ED03u;
    next();
  }
  double uniform(double low, double high) { return low + (high - low) * (double(next() >> 11) * 0x1p-53); }
  /// 10^U(from, to).
  double decades(double from, double to) { return std::pow(10.0, uniform(from, to)); }
  bool chance(double probability) { return uniform(0, 1) < probability; }
  std::size_t pick(std::size_t count) { return std::min(count - 1, std::size_t(uniform(0, double(count)))); }
  double sign() { return chance(0.5) ? 1 : -1; }

 private:
  std::uint64_t next() { return splitmix(state_ += splitmix_step); }
  std::uint64_t state_;
};

/// Inputs that nobody means: each must be refused or handled.
constexpr double extremes[] = {0,    -0.0,  5e-324, 1e-310,  -1e-310, 2.3e-308, 1e-300,   1e-200,    1e-30, 1e15,
                               1e30, 1e200, 1e300,  1.7e308, -1,      -1e300,   infinity, -infinity, NAN};

double inside(double value, const Range& range) {
  if (value != 0 && std::abs(value) < range.smallest) value = std::copysign(range.smallest, value);
  return std::clamp(value, range.low, range.high);
}

/// A law's parameter about its published value: ratios over one decade, quantities with a dimension over ten at most
/// (`reach` to either side).
Value drawn(Dice& dice, const Quantity& quantity, const Value& published, double reach) {
  const bool wide = quantity.unit != "1" || (quantity.range.low > 0 && quantity.range.high / quantity.range.low > 1e6);
  const double half = wide ? reach : 0.5;
  if (quantity.is_list) {
    auto list = std::get<std::vector<double>>(published);
    const double factor = dice.decades(-half, half);
    for (double& x : list) x = inside(x * factor, quantity.range);
    return list;
  }
  const double value = std::get<double>(published);
  if (value == 0) return dice.chance(0.6) ? 0.0 : inside(quantity.range.high * dice.decades(-10, 0), quantity.range);
  const bool turned = quantity.range.low < 0 && dice.chance(0.2);
  return inside((turned ? -value : value) * dice.decades(-half, half), quantity.range);
}

/// Speeds that a law's parameters contain (m/s).
std::vector<double> speeds_in(const FrictionLaw& law) {
  std::vector<double> speeds;
  for (std::size_t i = 0; i < law.parameters().size(); ++i) {
    const auto& unit = law.parameters()[i].unit;
    if (law.parameters()[i].is_list) {
      if (unit == "m/s")
        for (const double v : std::get<std::vector<double>>(law.values()[i]))
          if (v > 0) speeds.push_back(v);
      continue;
    }
    const double value = std::get<double>(law.values()[i]);
    if (unit == "m/s" && value > 0) speeds.push_back(value);
    if (unit == "s/m" && value > 0) speeds.push_back(1 / value);
  }
  return speeds;
}

/// The time in which the fastest state relaxes at steady sliding (s); nothing without states.
std::optional<double> relaxation_time(const Model& model) {
  if (!model.law->has_states() || model.lambda == 0) return std::nullopt;
  const double V = std::abs(model.drive.speed.level());
  const auto contact = model.law->contact({.lambda = model.lambda, .unknowns = Unknowns::states});
  constexpr int most = Slopes<double>::capacity;
  double z[most], weight[most], g[most], F;
  Slopes<double> s;
  contact->steady(0, V, 1, z, weight);
  contact->linearise({V, 1, 0, 1}, z, g, F, s);
  double fastest = 0;
  for (int i = 0; i < contact->unknowns(); ++i)
    fastest = std::max(fastest, std::abs(s.g_z[i * contact->unknowns() + i]) / model.lambda);
  if (!(fastest > 0) || !std::isfinite(fastest)) return std::nullopt;
  return 1 / fastest;
}

/// Load at which steady sliding loses stability, by any means.
std::optional<double> hopf_load(const Model& model) {
  try {
    if (const auto closed = steady::critical_load(model)) return closed->normal_load;
    const auto points = steady::hopf_points(model, "drive.normal_load", 8);
    if (!points.empty()) return points.front().value;
  } catch (const InputError&) {
  }
  return std::nullopt;
}

}  // namespace

std::string name(Question q) { return q == Question::stability ? "stability" : q == Question::cycle ? "cycle" : "run"; }

std::string name(Verdict v) {
  switch (v) {
    case Verdict::certified:
      return "certified";
    case Verdict::less_exact:
      return "certified, less exactly than asked";
    case Verdict::none_exists:
      return "none exists";
    case Verdict::refused:
      return "refused";
    case Verdict::failed:
      return "failed";
    case Verdict::wrong:
      return "wrong";
    case Verdict::not_finite:
      return "not finite";
    case Verdict::crashed:
      return "crashed";
  }
  return "";
}

Model model_of(const StressScene& scene) {
  Model model;
  model.law = scene.law;
  // A law is checked as a whole: lists belong together.
  auto values = model.law->values();
  for (const auto& [path, value] : scene.settings)
    if (path.starts_with("law."))
      if (const auto index = model.law->find(path.substr(4))) values[*index] = value;
  model.law = model.law->with(values);
  for (const auto& [path, value] : scene.settings)
    if (!path.starts_with("law.") || !model.law->find(path.substr(4)))
      model = model.with(path, std::get<double>(value));
  model.check();
  return model;
}

StressScene draw_scene(const Laws& laws, std::uint64_t seed, long index) {
  Dice dice(seed, std::uint64_t(index));
  StressScene scene;
  scene.seed = seed;
  scene.index = index;
  Model model;
  model.law = laws[dice.pick(laws.size())];
  scene.law = model.law;
  const double asked = dice.uniform(0, 1);
  scene.question = asked < 0.25 ? Question::stability : asked < 0.75 ? Question::cycle : Question::run;

  // The law: a published one, or one about it.
  const auto& presets = model.law->presets();
  const auto published =
      !presets.empty() && dice.chance(0.4) ? presets[dice.pick(presets.size())].values : model.law->values();
  auto values = published;
  const double reach = dice.chance(0.5) ? 5 : 1;
  for (bool drawn_well = dice.chance(0.15); !drawn_well;) {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = drawn(dice, model.law->parameters()[i], published[i], reach);
    try {
      model.law->with(values);
      drawn_well = true;
    } catch (const InputError&) {  // parameters that do not go together, such as more friction in motion than at rest
    }
  }
  model.law = model.law->with(values);
  for (std::size_t i = 0; i < values.size(); ++i)
    scene.settings.emplace_back("law." + model.law->parameters()[i].name, values[i]);
  const auto set = [&](const std::string& path, double value) {
    value = inside(value, model.describe(path).range);
    model = model.with(path, value);
    for (auto& [known, before] : scene.settings)
      if (known == path) return void(before = value);
    scene.settings.emplace_back(path, value);
  };

  if (model.law->has_states()) {
    const double kind = dice.uniform(0, 1);
    set("law.lambda", kind < 0.1 ? 0 : kind < 0.4 ? 1 : dice.decades(-6, 6));
  }
  const auto speeds = speeds_in(*model.law);
  const double V =
      std::clamp((speeds.empty() ? 1e-3 : speeds[dice.pick(speeds.size())]) * dice.decades(-5, 5), 1e-15, 1e4);
  set("drive.speed", dice.chance(0.05) ? -V : V);

  // The slider: on its own, or with its period near the time in which the contact renews itself.
  const double k = dice.decades(-3, 7);
  set("oscillator.stiffness", k);
  const auto relaxation = relaxation_time(model);
  const bool massless = !model.law->set_valued() && dice.chance(0.15);
  double m = 0;
  if (!massless) {
    m = relaxation && dice.chance(0.5) ? k * std::pow(*relaxation * dice.decades(-3, 3), 2) : dice.decades(-5, 5);
    m = std::clamp(m, 1e-20, 1e12);
  }
  set("oscillator.mass", m);
  const double natural = std::sqrt(m / k);      // s, per radian
  const double anything = dice.decades(-5, 5);  // N
  if (!model.law->set_valued() && dice.chance(0.2)) {
    const double spring = k * dice.decades(-5, 5);
    const double beside = spring * (m > 0 ? natural : relaxation.value_or(1)) * dice.decades(-5, 5);
    const bool damped = dice.chance(0.4);
    if (dice.chance(0.7)) {
      set("law.contact_stiffness.tangential", spring);
      if (damped) set("law.contact_stiffness.damping", beside);
    } else {
      set("law.contact_stiffness.per_load", spring / anything);
      if (damped) set("law.contact_stiffness.damping_per_load", beside / anything);
    }
  }
  const double damping = (m > 0 ? 2 * std::sqrt(k * m) : k * relaxation.value_or(1)) * dice.decades(-5, 5);
  if (dice.chance(0.5)) set("oscillator.damping", damping);

  // The load: anything, about the critical load, or next to it.
  set("drive.normal_load", anything);
  if (const auto critical = dice.chance(0.7) ? hopf_load(model) : std::nullopt)
    set("drive.normal_load",
        *critical * (dice.chance(0.4) ? 1 + dice.sign() * dice.decades(-7, -0.5) : dice.decades(-5, 5)));
  else if (m > 0 && dice.chance(0.6))
    set("drive.normal_load", V * std::sqrt(k * m) * dice.decades(-5, 5));
  const double N = model.drive.normal_load.level();
  if (dice.chance(0.15)) set("drive.force", dice.sign() * N * dice.decades(-3, 1));

  if (scene.question == Question::run) {
    // From a part of one of the scene's own times up to many of it, but not more than hundreds of free oscillations,
    // which nothing may damp.
    std::vector<double> times{N / (k * V)};
    if (m > 0) times.push_back(2 * std::numbers::pi * natural);
    if (relaxation) times.push_back(*relaxation);
    const double kt = model.contact_stiffness.tangential;
    const double fastest = 2 * std::numbers::pi * std::sqrt(m / (k + (std::isfinite(kt) ? kt : 0)));
    double duration = times[dice.pick(times.size())] * dice.decades(-3, 1.5);
    if (m > 0) duration = std::min(duration, 300 * fastest);
    scene.run.duration = std::clamp(duration, 1e-15, 1e15);
    scene.run.samples = 20;
    scene.run.most_steps = 1'000'000;
    scene.run.tolerance = 1e-6;
    const double kind = dice.uniform(0, 1);
    if (kind < 0.2) {
      scene.run.start.kind = motion::Start::Kind::steady;
    } else if (kind < 0.4) {
      scene.run.start.kind = motion::Start::Kind::rest;
    } else {
      scene.run.start.kind = motion::Start::Kind::given;
      const double u = model.drive.speed.level() * dice.decades(-4, 1);
      scene.run.start.slip_rate = dice.chance(0.1) && m > 0 ? -u : u;
    }
  }

  // Now and then a number that nobody means.
  if (dice.chance(0.04)) {
    auto& [path, value] = scene.settings[dice.pick(scene.settings.size())];
    if (std::holds_alternative<double>(value)) value = extremes[dice.pick(std::size(extremes))];
  }
  return scene;
}

// ---------------------------------------------------------------- judging

namespace {

Judgement failure(const Outcome& outcome, std::string_view of = {}) {
  return {Verdict::failed, fmt::format("{}{}: {}", of, name(outcome.ending), outcome.detail)};
}

constexpr double understated = 10;  ///< differences beyond this many stated errors are wrong numbers

/// Turns the largest ratio of difference to stated error into a verdict.
Judgement by_ratio(double ratio, std::string_view worst) {
  Judgement judgement{Verdict::certified, "", ratio};
  if (ratio > 1) {
    judgement.verdict = ratio > understated ? Verdict::wrong : Verdict::failed;
    judgement.reason = fmt::format("error understated: {} differs by {:.3g} stated errors", worst, ratio);
  }
  return judgement;
}

/// The eigenvalue equation in the form of impedances: the spring and mass of the slider against the contact's dynamic
/// stiffness s·Z(s), Z = F_u + F_z (sΛ − g_z)⁻¹ g_u, in series with the contact spring; times det(sΛ − g_z), so that it
/// has no poles. Independent of the assembled Jacobian.
Complex impedance(const Model& model, Complex s) {
  const double V = model.drive.speed.level(), N = model.drive.normal_load.level();
  const auto contact = model.law->contact({.lambda = model.lambda, .unknowns = Unknowns::states});
  constexpr int most = Slopes<double>::capacity;
  const int n = contact->unknowns();
  double z[most], weight[most], g[most], F;
  Slopes<double> d;
  contact->steady(0, V, N, z, weight);
  contact->linearise({V, N, 0, V < 0 ? -1.0 : 1.0}, z, g, F, d);
  // (sΛ − g_z) x = g_u by Gaussian elimination with pivots; n ≤ 2 in practice.
  std::vector<Complex> A(std::size_t(n * n)), x(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) A[i * n + j] = (i == j ? s * Real(model.lambda) : Complex(0)) - Real(d.g_z[i * n + j]);
    x[i] = d.g_u[i];
  }
  Complex determinant = 1;
  for (int c = 0; c < n; ++c) {
    int pivot = c;
    for (int r = c + 1; r < n; ++r)
      if (std::abs(A[r * n + c]) > std::abs(A[pivot * n + c])) pivot = r;
    for (int j = 0; j < n; ++j) std::swap(A[c * n + j], A[pivot * n + j]);
    std::swap(x[c], x[pivot]);
    determinant *= pivot == c ? A[c * n + c] : -A[c * n + c];
    for (int r = c + 1; r < n; ++r) {
      const Complex f = A[r * n + c] / A[c * n + c];
      for (int j = c; j < n; ++j) A[r * n + j] -= f * A[c * n + j];
      x[r] -= f * x[c];
    }
  }
  for (int r = n - 1; r >= 0; --r) {
    for (int j = r + 1; j < n; ++j) x[r] -= A[r * n + j] * x[j];
    x[r] /= A[r * n + r];
  }
  Complex Z = d.F_u;
  for (int i = 0; i < n; ++i) Z += Real(d.F_z[i]) * x[i];
  const auto& o = model.slider;
  const auto& spring = model.contact_stiffness;
  const Real compliance = spring.compliance(N), damping = spring.damping + spring.damping_per_load * N;
  // Slider: D(s) = m s² + c s + k; contact: s Z; series spring and damper: κ = k_t + c_t s.
  // 1/D + 1/(s Z) + 1/κ = 0, times D s Z κ/k_t.
  const Complex D = Real(o.mass) * s * s + Real(o.damping) * s + Real(o.stiffness);
  const Complex relative = Real(1) + s * damping * compliance;
  return determinant * (D * (relative + s * Z * compliance) + s * Z * relative);
}

/// How far an eigenvalue is from the next root of the impedance equation: one step of Newton's method.
double distance_to_root(const Model& model, Complex s) {
  const Real h = 1e-6 * std::abs(s);
  const Complex here = impedance(model, s);
  if (h == 0 || here == Real(0)) return 0;  // s = 0 is a root where the equation lacks its constant: no spring
  const Complex slope = (impedance(model, s + h) - impedance(model, s - h)) / (2 * h);
  return double(std::abs(here / slope));
}

Judgement judge_stability(const Model& model) {
  const auto found = steady::stability(model);
  for (const auto& e : found.eigenvalues)
    if (!std::isfinite(e.real()) || !std::isfinite(e.imag())) return {Verdict::not_finite, "an eigenvalue"};
  double ratio = 0;
  std::string worst;
  for (std::size_t i = 0; i < found.eigenvalues.size(); ++i) {
    const auto e = found.eigenvalues[i];
    const double distance = distance_to_root(model, e), stated = found.eigenvalue_errors[i] + 1e-12 * std::abs(e);
    if (distance > ratio * stated) ratio = distance / stated, worst = "an eigenvalue";
  }
  if (const auto closed = steady::critical_load(model)) {
    const double N = model.drive.normal_load.level(), distance = N / closed->normal_load - 1;
    if (std::abs(distance) > 1e-9 && !found.marginal && found.stable != (distance < 0))
      return {Verdict::wrong,
              fmt::format("eigenvalues say {} at N/N_c - 1 = {:.3g}", found.stable ? "stable" : "unstable", distance)};
  }
  for (const auto& point : steady::hopf_points(model, "drive.normal_load")) {
    if (!std::isfinite(point.value) || !std::isfinite(point.value_error) ||
        !std::isfinite(point.first_lyapunov_coefficient) || !std::isfinite(point.angular_frequency))
      return {Verdict::not_finite, "a Hopf point"};
    // Stability changes across the stated error, unless the change is less than rounding shows.
    const double step = std::max(3 * point.value_error / point.value, 1e-12);
    if (step > 0.1) continue;
    const auto below = steady::stability(model.with("drive.normal_load", point.value * (1 - step)));
    const auto above = steady::stability(model.with("drive.normal_load", point.value * (1 + step)));
    if (!below.marginal && !above.marginal && below.stable == above.stable) {
      const double far = 10 * step;
      const auto low = steady::stability(model.with("drive.normal_load", point.value * (1 - far)));
      const auto high = steady::stability(model.with("drive.normal_load", point.value * (1 + far)));
      const double excess = low.stable != high.stable ? 3 : 30;
      if (excess > ratio) ratio = excess, worst = "the load of a Hopf point";
    }
  }
  return by_ratio(ratio, worst);
}

/// The third answer, from the lanes that fill planes: largest difference over stated errors, 0 where they do not serve
/// or settle on nothing. A cycle with another period, by more than a tenth, is another cycle and no error.
double lanes_against(const cycles::Cycle& tight, const Model& model, std::string& worst) {
  const auto found = lanes::find_cycles(std::span(&model, 1), lanes::every_metric());
  const lanes::LaneCycle& lane = found.front();
  const bool another = std::abs(lane.metrics.period / tight.metrics.period - 1) > 0.1;
  if (!lane.found || another) return 0;
  double ratio = 0;
  for (const auto& metric : cycles::metric_names()) {
    if (cycles::is_stick(metric) && (lane.ill_conditioned_stick || tight.ill_conditioned_stick)) continue;
    const double a = lane.metrics.*metric.member, b = tight.metrics.*metric.member;
    const double r = a == b ? 0 : std::abs(a - b) / (lane.error.*metric.member + tight.error.*metric.member);
    if (!(r <= ratio)) ratio = r, worst = metric.name;
  }
  return ratio;
}

constexpr double coarsest_of_use = 1e-3;  ///< error over size

/// What agrees within its errors, but was asked for more exactly.
Judgement less_exactly(Judgement judgement, const Outcome& outcome) {
  if (judgement.verdict == Verdict::certified) judgement = {Verdict::less_exact, outcome.detail};
  return judgement;
}

/// True if every metric of a cycle short of its tolerance is known to a thousandth.
bool is_of_use(const cycles::Cycle& cycle, const Model& model) {
  return cycle.metrics.period > 0 && std::ranges::all_of(cycles::metric_names(), [&](const cycles::MetricName& metric) {
           if (cycles::is_stick(metric) && cycle.ill_conditioned_stick) return true;
           return cycle.error.*metric.member <=
                  coarsest_of_use * size_of(metric, cycle.metrics, std::abs(model.drive.speed.level()));
         });
}

Judgement judge_cycle(const Model& model) {
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6});
  const bool short_of = loose.outcome.ending == Ending::tolerance_not_met && is_of_use(loose, model);
  if (!loose.outcome.complete() && loose.outcome.ending != Ending::none_exists && !short_of)
    return failure(loose.outcome);
  auto tight = cycles::find_cycle(model, {.tolerance = 1e-9});
  for (const double tolerance : {1e-7, 3e-7})
    if (tight.outcome.ending == Ending::budget_spent) tight = cycles::find_cycle(model, {.tolerance = tolerance});
  const bool has_numbers = tight.metrics.period > 0;
  if (tight.outcome.ending == Ending::none_exists && loose.outcome.ending == Ending::none_exists) {
    std::string_view reason = loose.outcome.detail;
    if (reason.starts_with("the motion started from stick dies out") ||
        reason.starts_with("no two periods are alike: neighbouring motions part")) {
      // From a slip of another size too.
      const double V = model.drive.speed.level();
      motion::Start other;
      other.kind = motion::Start::Kind::given;
      other.slip_rate = (model.slider.mass > 0 ? 3 : 0.3) * V;
      if (cycles::find_cycle(model, {.tolerance = 1e-6, .start = other}).outcome.complete())
        return {Verdict::failed, "a cycle from another start, none from stick"};
    }
    return {Verdict::none_exists, loose.outcome.detail};
  }
  if (tight.outcome.ending == Ending::none_exists || (loose.outcome.ending == Ending::none_exists && has_numbers))
    return {Verdict::wrong, "a cycle at one tolerance, none at the other"};
  // The check need not reach its own tolerance: it is held to the errors that it states.
  if (!has_numbers) return failure(tight.outcome, "in the check: ");
  double ratio = 0;
  std::string worst;
  for (const auto& metric : cycles::metric_names()) {
    const double a = loose.metrics.*metric.member, a_error = loose.error.*metric.member;
    const double b = tight.metrics.*metric.member, b_error = tight.error.*metric.member;
    if (!std::isfinite(a + b + a_error + b_error)) return {Verdict::not_finite, metric.name};
    if (cycles::is_stick(metric) && (loose.ill_conditioned_stick || tight.ill_conditioned_stick)) continue;
    const double r = a == b ? 0 : std::abs(a - b) / (a_error + b_error);
    if (!(r <= ratio)) ratio = r, worst = metric.name;
  }
  // Identity: a periodic motion slips as far as the drive moves.
  const double V = model.drive.speed.level();
  const double r = std::abs(tight.metrics.slip_rate_mean - V) / tight.error.slip_rate_mean;
  if (!(r <= ratio)) ratio = r, worst = "slip_rate_mean against the drive speed";
  std::string of_lanes;
  const double lanes = V > 0 && tight.outcome.complete() ? lanes_against(tight, model, of_lanes) : 0;
  if (!(lanes <= ratio)) ratio = lanes, worst = of_lanes + " of the lanes";
  return short_of ? less_exactly(by_ratio(ratio, worst), loose.outcome) : by_ratio(ratio, worst);
}

/// True if every column of a run that reached its end is known to a thousandth of what it is measured by, velocities to
/// that of the drive's or the slip's.
bool is_of_use(const motion::Run& run, const Model& model, std::size_t samples) {
  if (run.column_size.empty() || run.columns[0].size() != samples) return false;
  constexpr std::size_t velocity = 1, slip_rate = 2;
  const auto& size = run.column_size;
  const double speeds = std::max({std::abs(model.drive.speed.level()), size[velocity], size[slip_rate]});
  for (std::size_t c = 0; c < run.columns.size(); ++c)
    if (!(run.column_error[c] <= coarsest_of_use * (c == velocity || c == slip_rate ? speeds : size[c]))) return false;
  return true;
}

Judgement judge_run(const Model& model, const motion::RunOptions& options) {
  const auto loose = motion::run(model, options);
  const bool short_of = loose.outcome.ending == Ending::tolerance_not_met &&
                        is_of_use(loose, model, motion::sample_times(options).size());
  if (!loose.outcome.complete() && loose.outcome.ending != Ending::none_exists && !short_of)
    return failure(loose.outcome);
  motion::RunOptions check = options;
  motion::Run second;
  bool checked = false;
  if (loose.solver == "collocation" && loose.outcome.complete()) {
    // BDF in the natural unknowns: another method and other equations, where it can.
    check.solver = "cvode";
    check.tolerance = 1e-7;
    try {
      second = motion::run(model, check);
      checked = second.outcome.complete();
    } catch (const InputError&) {  // an algebraic row
    }
  }
  check.solver = "auto";
  if (loose.solver == "steady") {
    // The equations themselves, for as long as rounding has not grown to matter. All samples are the same: what is no
    // balance shows within a few of the times in which anything changes.
    constexpr double times_of_change = 100;
    const auto eigenvalues = steady::stability(model).eigenvalues;
    double fastest = 0;
    for (const auto& e : eigenvalues) fastest = std::max(fastest, std::abs(e));
    check.solver = model.law->set_valued() ? "events" : "collocation";
    check.duration =
        std::min({check.duration, 5 / std::max(eigenvalues.front().real(), 0.0), times_of_change / fastest});
  }
  // What was just within the budget is to be within that of a closer look.
  constexpr long more_steps = 3;
  // Rings that steps pass over at the run's tolerance, within its stated errors, may have to be followed at a smaller
  // one.
  for (const auto& [tolerance, steps] :
       {std::pair(1e-9, 1L), std::pair(1e-7, more_steps), std::pair(3e-7, more_steps)}) {
    if (checked) break;
    check.tolerance = tolerance;
    check.most_steps = steps * options.most_steps;
    second = motion::run(model, check);
    checked = second.outcome.ending != Ending::budget_spent;
  }
  if (loose.outcome.ending == Ending::none_exists) {
    if (second.outcome.ending == Ending::none_exists) return {Verdict::none_exists, loose.outcome.detail};
    if (!second.outcome.complete()) return failure(second.outcome, "in the check: ");
    return {Verdict::wrong, "a motion at one tolerance only"};
  }
  const bool to_the_end = second.columns[0].size() == loose.columns[0].size();
  if (!second.outcome.complete() && !(second.outcome.ending == Ending::tolerance_not_met && to_the_end))
    return failure(second.outcome, "in the check: ");
  double ratio = 0;
  std::string worst;
  for (std::size_t c = 0; c < loose.columns.size(); ++c) {
    const double error = loose.column_error[c] + second.column_error[c];
    if (!std::isfinite(error)) return failure({Ending::not_finite, "error of " + loose.column_names[c]});
    for (std::size_t i = 0; i < loose.columns[c].size(); ++i) {
      const double a = loose.columns[c][i], b = second.columns[c].at(i);
      if (!std::isfinite(a) || !std::isfinite(b)) return {Verdict::not_finite, loose.column_names[c]};
      const double r = a == b ? 0 : std::abs(a - b) / error;
      if (!(r <= ratio)) ratio = r, worst = loose.column_names[c];
    }
  }
  return short_of ? less_exactly(by_ratio(ratio, worst), loose.outcome) : by_ratio(ratio, worst);
}

/// A message with its numbers left out, so that like ones are counted together.
std::string without_numbers(const std::string& text) {
  std::string kind;
  for (std::size_t i = 0; i < text.size();) {
    const bool begins = std::isdigit(static_cast<unsigned char>(text[i])) &&
                        (i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1])));
    if (!begins) {
      kind += text[i++];
      continue;
    }
    kind += '#';
    while (i < text.size() && (std::isdigit(static_cast<unsigned char>(text[i])) || text[i] == '.' || text[i] == 'e' ||
                               ((text[i] == '-' || text[i] == '+') && text[i - 1] == 'e')))
      ++i;
  }
  return kind;
}

}  // namespace

Judgement judge(const StressScene& scene) {
  const auto begin = Clock::now();
  Judgement judgement;
  try {
    const Model model = model_of(scene);
    judgement = scene.question == Question::stability ? judge_stability(model)
                : scene.question == Question::cycle   ? judge_cycle(model)
                                                      : judge_run(model, scene.run);
  } catch (const InputError& error) {
    judgement = {Verdict::refused, error.what()};
  } catch (const std::exception& error) {
    judgement = {Verdict::crashed, error.what()};
  }
  judgement.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return judgement;
}

long StressReport::sum(const std::map<std::string, Tally>& table) {
  long sum = 0;
  for (const auto& [kind, tally] : table) sum += tally.count;
  return sum;
}

double StressReport::failure_share() const {
  const long asked = scenes - refusals();
  return asked > 0 ? double(failed()) / double(asked) : 0;
}

bool StressReport::passed() const {
  return complete && wrong == 0 && not_finite == 0 && crashed == 0 && failure_share() < 0.01;
}

StressReport stress(const StressOptions& options, const StressObservers& observers) {
  require(double(options.scenes), {1, 1e9}, "scenes", "number of random scenes", "1");
  if (options.laws.empty()) throw InputError("the stress suite needs laws to draw from");
  require(options.threads, {1, 4096}, "threads", "number of threads", "1");
  std::vector<Judgement> judgements(std::size_t(options.scenes));
  std::vector<char> done(judgements.size(), 0);
  std::vector<Question> questions(judgements.size());
  std::atomic<long> next{0};
  std::mutex reporting;
  struct Watched {
    std::atomic<long> index{-1};
    std::atomic<Clock::rep> begin{0};
  };
  std::vector<Watched> watched(std::size_t(options.threads));
  {
    // No scene may hang unseen: solvers count their steps, and this watches the clock.
    std::mutex waiting;
    std::condition_variable_any wake;
    const std::jthread watchdog([&](std::stop_token stop) {
      std::unique_lock lock(waiting);
      while (!wake.wait_for(lock, stop, std::chrono::seconds(1), [&] { return stop.stop_requested(); }))
        for (auto& worker : watched) {
          const long index = worker.index;
          const Clock::time_point began{Clock::duration(worker.begin)};
          if (index >= 0 && Clock::now() - began > std::chrono::duration<double>(options.longest) && observers.hung)
            observers.hung(draw_scene(options.laws, options.seed, index));
        }
    });
    try {
      in_threads(options.threads, [&](int t) {
        auto& mine = watched[std::size_t(t)];
        for (long i = next++; i < options.scenes; i = next++) {
          end_if_stopped();
          const auto scene = draw_scene(options.laws, options.seed, options.first + i);
          mine.begin = Clock::now().time_since_epoch().count();
          mine.index = scene.index;
          auto judgement = judge(scene);
          end_if_stopped();  // of a run that was broken off there is nothing to judge
          mine.index = -1;
          const std::scoped_lock lock(reporting);
          if (observers.finished) observers.finished(scene, judgement);
          questions[std::size_t(i)] = scene.question;
          judgements[std::size_t(i)] = std::move(judgement);
          done[std::size_t(i)] = 1;
        }
      });
    } catch (const Stopped&) {  // the report says that it is not complete
    }
  }

  // Of a suite that was stopped, the scenes before the first that is not done: behind it are those that took less time.
  StressReport report;
  for (long i = 0; i < options.scenes; ++i) {
    if (!done[std::size_t(i)]) {
      report.complete = false;
      break;
    }
    const auto& judgement = judgements[std::size_t(i)];
    const auto count = [&](std::map<std::string, Tally>& table, const std::string& kind) {
      auto& tally = table[kind];
      if (tally.count++ == 0) tally.example = options.first + i;
    };
    ++report.scenes;
    report.seconds += judgement.seconds;
    report.slowest.emplace_back(judgement.seconds, options.first + i);
    count(report.questions, name(questions[std::size_t(i)]));
    if (judgement.error_ratio > 0) {
      ++report.compared;
      if (judgement.error_ratio <= 1) ++report.covered;
    }
    switch (judgement.verdict) {
      case Verdict::certified:
        ++report.certified;
        report.worst_error_ratio = std::max(report.worst_error_ratio, judgement.error_ratio);
        break;
      case Verdict::less_exact:
        count(report.less_exact, without_numbers(judgement.reason));
        break;
      case Verdict::none_exists:
        ++report.none_exists;
        break;
      case Verdict::refused:
        count(report.refused, without_numbers(judgement.reason));
        break;
      case Verdict::failed:
        count(report.failures, without_numbers(judgement.reason));
        break;
      case Verdict::wrong:
        ++report.wrong;
        count(report.alarms, "wrong: " + without_numbers(judgement.reason));
        break;
      case Verdict::not_finite:
        ++report.not_finite;
        count(report.alarms, "not finite: " + without_numbers(judgement.reason));
        break;
      case Verdict::crashed:
        ++report.crashed;
        count(report.alarms, "crashed: " + without_numbers(judgement.reason));
        break;
    }
  }
  std::ranges::sort(report.slowest, std::greater<>());
  report.slowest.resize(std::min<std::size_t>(report.slowest.size(), 10));
  return report;
}

}  // namespace rosin::analysis::studies
