/// Drawing the oscillators, following them, and the statistics of what was found.
#include "analysis/studies/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <mutex>
#include <numbers>
#include <random>

#include "core/workers.hpp"
#include "solvers/force_algorithms/force_algorithms.hpp"
#include "solvers/stick_slip/exact.hpp"
#include "solvers/stick_slip/plane_stick_slip.hpp"

namespace rosin::analysis::studies {

namespace algorithms = solvers::force_algorithms;
using algorithms::DryMass;
using algorithms::State;
using algorithms::Vector;

namespace {

/// Uniform numbers that are the same on every machine.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : random_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }

 private:
  std::mt19937_64 random_;
};

template <int D>
struct Drawn {
  DryMass<D> mass;
  Vector<D> start;
  double duration, average_speed;
  std::vector<double> inputs;
};

constexpr double gravity = 9.81;

/// Sum of the speeds that the free, the forced and the load-driven motion begin with, from rest at x₀ sliding back.
double average_speed(double m, double k, double c, double P, double we, double muN, double muNv, double wn, double x0) {
  using solvers::stick_slip::ClosedForm;
  const auto amplitude = [&](double force, double w) { return force / std::hypot(k - m * w * w, c * w); };
  const double w0 = std::sqrt(k / m), zeta = c / (2 * m * w0), wd = w0 * std::sqrt(1 - zeta * zeta);
  // Particular motion at t = 0: force P cos we t + μ Nv cos wn t + μ Nc.
  const auto particular = [&](double force, double w) {
    const std::complex<double> dynamic{k - m * w * w, c * w};
    return force / dynamic;  // value: real part; velocity: −w·imaginary part
  };
  const auto e = particular(P, we), n = particular(muNv, wn);
  const double A = x0 - e.real() - n.real() - muN / k;
  const double B = (0 + we * e.imag() + wn * n.imag() + zeta * w0 * A) / wd;
  return w0 * std::hypot(A, B) + we * amplitude(P, we) + wn * amplitude(muNv, wn);
}

template <int D>
Drawn<D> draw(Uniform& random, const StudyOptions& options);

template <>
Drawn<1> draw<1>(Uniform& random, const StudyOptions& options) {
  constexpr double pi = std::numbers::pi;
  const double m = random(1, 5), w0 = random(2 * pi, 100 * pi), zeta = random(0.01, 0.05);
  const double we = random(0, 5) * w0, wn = random(0, 5) * w0, k = m * w0 * w0;
  const double P = random(0, 0.01) * k, Nc = gravity * m, Nv = random(0, 1) * Nc;
  const double muk = random(0.15, 0.40), mus = random(1, 2) * muk, c = 2 * zeta * m * w0;
  const double x0 = options.start_factor * (P + (Nc + Nv) * mus) / k;
  const double duration = options.duration_factor * 4 / (zeta * w0);
  return {{m,
           {k},
           {c},
           mus,
           muk,
           {0},
           Signal(Signal::Harmonics{Nc, {{Nv, wn, 0}}}),
           {Signal(Signal::Harmonics{0, {{P, we, 0}}})}},
          {x0},
          duration,
          average_speed(m, k, c, P, we, muk * Nc, muk * Nv, wn, x0),
          {m, w0, zeta, we, wn, P, Nc, Nv, muk, mus}};
}

template <>
Drawn<2> draw<2>(Uniform& random, const StudyOptions& options) {
  constexpr double pi = std::numbers::pi, fastest = 90 * pi;
  const double m = random(1, 5);
  double w0[2], zeta[2], we[2], Pc[2], Po[2];
  for (double& w : w0) w = random(2 * pi, 200 * pi);
  for (double& z : zeta) z = random(0.01, 0.05);
  for (double& w : we) w = random(0, fastest);
  const double wn = random(0, fastest);
  for (int d = 0; d < 2; ++d) Pc[d] = random(0, 1e-3) * m * w0[d] * w0[d];
  for (int d = 0; d < 2; ++d) Po[d] = random(0, 1.5e-3) * m * w0[d] * w0[d];
  const double Nc = gravity * m, Nv = random(0, 1) * Nc, muk = random(0.15, 0.40), mus = random(1, 2) * muk;
  Drawn<2> drawn{{m, {}, {}, mus, muk, {}, Signal(Signal::Harmonics{Nc, {{Nv, wn, 0}}}), {}},
                 {},
                 0,
                 0,
                 {m, w0[0], w0[1], zeta[0], zeta[1], we[0], we[1], wn, Pc[0], Pc[1], Po[0], Po[1], Nc, Nv, muk, mus}};
  for (int d = 0; d < 2; ++d) {
    const double k = m * w0[d] * w0[d], c = 2 * zeta[d] * m * w0[d];
    drawn.mass.stiffness[d] = k, drawn.mass.damping[d] = c;
    drawn.mass.force[d] = Signal(Signal::Harmonics{Pc[d], {{Po[d], we[d], 0}}});
    drawn.start[d] = options.start_factor * (Pc[d] + Po[d] + (Nc + Nv) * mus) / k;
    drawn.duration = std::max(drawn.duration, options.duration_factor * 4 / (zeta[d] * w0[d]));
    drawn.average_speed = std::hypot(
        drawn.average_speed, average_speed(m, k, c, Po[d], we[d], muk * Nc, muk * Nv, wn, drawn.start[d] - Pc[d] / k));
  }
  return drawn;
}

/// The exact solver at the start of the motion.
solvers::stick_slip::Exact<double> exact_of(const Drawn<1>& drawn) {
  const auto& mass = drawn.mass;
  solvers::stick_slip::Exact<double> exact({mass.mass, mass.stiffness[0], mass.damping[0], mass.static_friction,
                                            mass.dynamic_friction, 0, 0.0, mass.load, mass.force[0]});
  exact.start(0, drawn.start[0], 0);
  return exact;
}

Motion follow_exactly(const Drawn<1>& drawn, const StudyOptions& options) {
  auto exact = exact_of(drawn);
  exact.audit();
  Motion motion;
  bool stuck = exact.upcoming() == 0;
  motion.sticks = stuck;
  while (exact.time() < drawn.duration) {
    const auto what = exact.advance(drawn.duration);
    if (what == solvers::stick_slip::Switch::stick && motion.sticks++ == 0) motion.first_stick = exact.time();
    if (what == solvers::stick_slip::Switch::slip && motion.sticks == options.most_sticks) break;
  }
  motion.stick_share = exact.stick_time() / exact.time();
  motion.friction_work = exact.works().friction;
  motion.wear_rate = motion.friction_work / drawn.mass.dynamic_friction / exact.time();
  return motion;
}

Motion follow_exactly(const Drawn<2>& drawn, const StudyOptions& options) {
  solvers::stick_slip::PlaneStickSlip exact(drawn.mass, 1e-9);
  exact.start(0, drawn.start, {});
  Motion motion;
  while (exact.time() < drawn.duration) {
    solvers::stick_slip::Switch what;
    const auto outcome = exact.advance(drawn.duration, what);
    if (!outcome.complete()) throw std::runtime_error("a plane motion could not be followed: " + outcome.detail);
    if (what == solvers::stick_slip::Switch::stick && motion.sticks++ == 0) motion.first_stick = exact.time();
    if (what == solvers::stick_slip::Switch::slip && motion.sticks == options.most_sticks) break;
  }
  motion.stick_share = exact.stick_time() / exact.time();
  motion.friction_work = exact.friction_work();
  motion.wear_rate = motion.friction_work / drawn.mass.dynamic_friction / exact.time();
  return motion;
}

template <int D>
algorithms::Track<D> track_of(const std::string& name, const Drawn<D>& drawn, const algorithms::Forcing<D>& forcing,
                              const StudyOptions& options) {
  algorithms::Options asked;
  asked.window = options.window_share * drawn.average_speed;
  asked.most_sticks = static_cast<std::size_t>(options.most_sticks);
  asked.step = 2 * forcing.half;
  algorithms::check(name, drawn.mass, asked);
  return algorithms::follow<D>(name, drawn.mass, forcing, asked, drawn.start, Vector<D>{});
}

template <int D>
algorithms::Forcing<D> forcing_of(const Drawn<D>& drawn, const StudyOptions& options) {
  const double step = algorithms::step_of(drawn.mass, {}) * 1000 / options.steps_per_period;
  return {drawn.mass, step, static_cast<std::size_t>(drawn.duration / step)};
}

template <int D>
Motion follow(const std::string& name, const Drawn<D>& drawn, const algorithms::Forcing<D>& forcing,
              const StudyOptions& options) {
  const auto track = track_of(name, drawn, forcing, options);
  const auto& points = track.points;
  Motion motion;
  motion.sticks = static_cast<int>(track.sticks.size());
  for (std::size_t n = 1; n < points.size(); ++n) {
    const double h = points[n].time - points[n - 1].time;
    const auto middle = [&](int d) { return (points[n - 1].v[d] + points[n].v[d]) / 2; };
    Vector<D> v;
    for (int d = 0; d < D; ++d) v[d] = middle(d);
    const double speed = algorithms::length<D>(v);
    motion.friction_work += h * std::abs(algorithms::dot<D>(points[n - 1].friction, v));
    motion.wear_rate += h * drawn.mass.load.value(points[n - 1].time) * speed;
    if (points[n - 1].state == State::stick) motion.stick_share += h;
  }
  motion.stick_share /= points.back().time;
  motion.wear_rate /= points.back().time;
  for (const auto& stick : track.sticks) motion.false_starts += stick.false_start;
  if (!track.sticks.empty()) {
    const auto& first = track.sticks.front();
    const double unit = 1e-3 * drawn.average_speed;
    motion.first_stick = points[first.begin].time;
    motion.smallest_error = first.smallest_speed / unit;
    motion.last_error = first.last_speed / unit;
    Vector<D> moved;
    for (int d = 0; d < D; ++d) moved[d] = points[first.end].x[d] - points[first.begin].x[d];
    motion.drift = algorithms::length<D>(moved);
    motion.back_steps = first.back_steps;
  }
  return motion;
}

/// Processor time of this thread: what a motion costs, whatever else the machine does.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

template <int D>
StudyCase follow_all(const Drawn<D>& drawn, const StudyOptions& options, double& exact_seconds, double& seconds) {
  StudyCase found{drawn.inputs, drawn.average_speed, {}, {}};
  double begin = processor_seconds();
  found.exact = follow_exactly(drawn, options);
  exact_seconds = processor_seconds() - begin;
  begin = processor_seconds();
  const auto forcing = forcing_of(drawn, options);
  for (const auto& name : options.algorithms) found.motions.push_back(follow(name, drawn, forcing, options));
  seconds = processor_seconds() - begin;
  return found;
}

constexpr int whole_points = 2000, entry_steps = 12;  ///< of the motions shown

/// The exact motion at the given times.
std::vector<ShownMotion::Point> exactly(const Drawn<1>& drawn, const std::vector<double>& times) {
  auto exact = exact_of(drawn);
  std::vector<ShownMotion::Point> points;
  for (const double t : times) {
    while (exact.time() < t || exact.time() == 0) exact.advance(drawn.duration);
    const auto seen = exact.at(t);
    points.push_back({t, {seen.displacement}, {seen.velocity}, exact.direction() == 0});
  }
  return points;
}

std::vector<ShownMotion::Point> exactly(const Drawn<2>& drawn, const std::vector<double>& times) {
  solvers::stick_slip::PlaneStickSlip exact(drawn.mass, 1e-9);
  exact.start(0, drawn.start, {});
  std::vector<ShownMotion::Point> points;
  for (const double t : times) {
    solvers::stick_slip::Switch what;
    while (exact.time() < t || exact.time() == 0)
      if (!exact.advance(drawn.duration, what).complete()) return points;
    const auto seen = exact.at(t);
    points.push_back(
        {t, {seen.displacement[0], seen.displacement[1]}, {seen.velocity[0], seen.velocity[1]}, exact.sticking()});
  }
  return points;
}

template <int D>
std::vector<ShownMotion> show(const Drawn<D>& drawn, double first_stick, const StudyOptions& options) {
  const auto forcing = forcing_of(drawn, options);
  const double step = 2 * forcing.half, from = first_stick - entry_steps * step, to = first_stick + entry_steps * step;
  std::vector<ShownMotion> shown(1);
  shown[0].name = "exact";
  double end = 0;
  for (const auto& name : options.algorithms) {
    const auto track = track_of(name, drawn, forcing, options);
    ShownMotion motion{name, {}, {}};
    const std::size_t every = std::max<std::size_t>(1, track.points.size() / whole_points);
    for (std::size_t n = 0; n < track.points.size(); ++n) {
      const auto& point = track.points[n];
      const ShownMotion::Point kept{
          point.time, {point.x.begin(), point.x.end()}, {point.v.begin(), point.v.end()}, point.state == State::stick};
      if (n % every == 0) motion.whole.push_back(kept);
      if (from <= point.time && point.time <= to) motion.entry.push_back(kept);
    }
    end = std::max(end, track.points.back().time);
    shown.push_back(std::move(motion));
  }
  std::vector<double> whole, entry;
  for (int i = 0; i <= whole_points; ++i) {
    whole.push_back(end * i / whole_points);
    entry.push_back(std::clamp(std::lerp(from, to, double(i) / whole_points), 0.0, end));
  }
  shown[0].whole = exactly(drawn, whole), shown[0].entry = exactly(drawn, entry);
  return shown;
}

AlgorithmStatistics statistics(const StudyResult& result, std::size_t a, const StudyOptions& options) {
  AlgorithmStatistics found;
  found.name = options.algorithms[a];
  found.back_steps.assign(10, 0);
  std::vector<double> smallest, last, drift, first, share, work;
  for (const auto& c : result.cases) {
    const auto& motion = c.motions[a];
    const bool sticks = motion.sticks > 0;
    const auto others = std::ranges::count_if(c.motions, [](const Motion& other) { return other.sticks > 0; }) - sticks;
    found.sticking_cases += sticks;
    found.alone += sticks && others == 0;
    found.missed += !sticks && c.exact.sticks > 0;
    found.invented += sticks && c.exact.sticks == 0;
    found.more_sticks += motion.sticks > c.exact.sticks;
    found.false_starts += motion.false_starts;
    if (!sticks || others + 1 < static_cast<long>(c.motions.size())) continue;
    ++found.back_steps[static_cast<std::size_t>(std::min(motion.back_steps, 9))];
    smallest.push_back(motion.smallest_error), last.push_back(motion.last_error), drift.push_back(motion.drift);
    if (c.exact.sticks == 0) continue;
    first.push_back(motion.first_stick - c.exact.first_stick);
    share.push_back(motion.stick_share - c.exact.stick_share);
    work.push_back(motion.friction_work / c.exact.friction_work - 1);
  }
  found.smallest_error = summarise(smallest), found.last_error = summarise(last), found.drift = summarise(drift);
  found.first_stick_error = summarise(first), found.stick_share_error = summarise(share);
  found.friction_work_error = summarise(work);
  const double threshold = found.name == "o-fbfm" ? options.window_threshold : 0;
  try {
    found.weibull = {weibull_by_moments(smallest, threshold), weibull_by_plot(smallest, threshold),
                     weibull_by_likelihood(smallest, threshold)};
  } catch (const InputError&) {
    // too few sticks for a distribution
  }
  return found;
}

const std::vector<std::string> line_names = {
    "mass",  "natural_frequency", "damping_ratio",  "force_frequency",  "load_frequency",
    "force", "mean_load",         "load_amplitude", "dynamic_friction", "static_friction"};
const std::vector<std::string> line_units = {"kg", "rad/s", "1", "rad/s", "rad/s", "N", "N", "N", "1", "1"};
const std::vector<std::string> plane_names = {"mass",
                                              "natural_frequency_x",
                                              "natural_frequency_y",
                                              "damping_ratio_x",
                                              "damping_ratio_y",
                                              "force_frequency_x",
                                              "force_frequency_y",
                                              "load_frequency",
                                              "mean_force_x",
                                              "mean_force_y",
                                              "force_x",
                                              "force_y",
                                              "mean_load",
                                              "load_amplitude",
                                              "dynamic_friction",
                                              "static_friction"};
const std::vector<std::string> plane_units = {"kg", "rad/s", "rad/s", "1", "1", "rad/s", "rad/s", "rad/s",
                                              "N",  "N",     "N",     "N", "N", "N",     "1",     "1"};

template <int D>
StudyResult study_in(const StudyOptions& options, const std::function<void(int)>& progress) {
  StudyResult result;
  result.input_names = D == 1 ? line_names : plane_names;
  result.input_units = D == 1 ? line_units : plane_units;
  Uniform random(options.seed);
  std::vector<Drawn<D>> drawn;
  for (int i = 0; i < options.cases; ++i) drawn.push_back(draw<D>(random, options));
  result.cases.resize(drawn.size());
  std::mutex reporting;
  int done = 0;
  try {
    in_parallel(options.threads, drawn.size(), [&](std::size_t i) {
      double exact_seconds = 0, seconds = 0;
      result.cases[i] = follow_all(drawn[i], options, exact_seconds, seconds);
      const std::lock_guard lock(reporting);
      result.exact_seconds += exact_seconds, result.algorithm_seconds += seconds;
      ++done;
      if (progress) progress(done);
    });
  } catch (const Stopped&) {
    result.outcome = {Ending::interrupted, fmt::format("{} of {} cases", done, options.cases)};
    return result;
  }
  std::vector<double> share, friction, wear;
  for (const auto& c : result.cases) {
    result.common += std::ranges::all_of(c.motions, [](const Motion& motion) { return motion.sticks > 0; });
    if (c.exact.sticks == 0) continue;
    ++result.exact_sticking_cases;
    share.push_back(c.exact.stick_share), friction.push_back(c.exact.friction_work), wear.push_back(c.exact.wear_rate);
  }
  result.exact_stick_share = summarise(share);
  result.exact_friction_work = summarise(friction);
  result.exact_wear_rate = summarise(wear);
  result.shown_case = options.show;
  for (int i = 0; result.shown_case < 0 && i < options.cases; ++i) {
    const auto& c = result.cases[static_cast<std::size_t>(i)];
    if (c.exact.sticks > 0 && std::ranges::all_of(c.motions, [](const Motion& motion) { return motion.sticks > 0; }))
      result.shown_case = i;
  }
  if (result.shown_case >= 0) {
    const auto index = static_cast<std::size_t>(result.shown_case);
    result.shown = show(drawn[index], result.cases[index].exact.first_stick, options);
  }
  for (std::size_t a = 0; a < options.algorithms.size(); ++a)
    result.algorithms.push_back(statistics(result, a, options));
  return result;
}

}  // namespace

StudyResult study(const StudyOptions& options, const std::function<void(int)>& progress) {
  for (const auto& name : options.algorithms)
    if (!algorithms::is_algorithm(name)) {
      std::vector<std::string> known;
      for (const auto& algorithm : algorithms::algorithms()) known.emplace_back(algorithm.name);
      throw InputError(fmt::format("unknown algorithm '{}'; did you mean '{}'?", name, nearest_name(name, known)));
    }
  require(options.cases, {1, 1e6}, "study.cases", "random oscillators", "1");
  require(options.start_factor, {1.000001, 1e6}, "study.start_factor", "start beyond where stick could hold", "1");
  require(options.show, {-1, double(options.cases - 1)}, "study.show", "case whose motions are drawn", "1");
  require(options.steps_per_period, {600, 1e6}, "study.steps_per_period", "steps of the shortest period", "1");

  require(options.dimensions, {1, 2}, "study.dimensions", "directions of motion", "1");
  return options.dimensions == 1 ? study_in<1>(options, progress) : study_in<2>(options, progress);
}

}  // namespace rosin::analysis::studies
