/// Slip of a contact over the steps of a period.
#include "analysis/cycles/slip_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/cycles/loop_area.hpp"
#include "solvers/steps/radau_tableau.hpp"

namespace rosin::analysis::cycles {

using oscillators::SliderSystem;
using oscillators::StructureSystem;
using solvers::steps::Collocation;
using solvers::steps::RadauTableau;

SlipSeen slip_seen(const SliderSystem& system) {
  const auto& drive = system.model().drive;
  const double N = drive.normal_load.level();
  return {[&system](double t, const double* y) { return system.slip_rate(t, y); },
          [&system](double t, const double* y) { return system.friction_coefficient(t, y); },
          [law = system.model().law, N](double v) {
            return law->steady_friction({v, N}).friction;
          },
          drive.speed.level(), follows_steady_curve(system)};
}

SlipSeen slip_seen(const StructureSystem& system, int j) {
  const auto& contact = system.structure().contacts[j];
  const double level = contact.speed.level(), N = contact.load_factor * contact.normal_load.level(),
               sign = level < 0 ? -1 : 1;
  const bool has_memory = contact.lambda > 0 && contact.law->has_states();
  // Dry friction behind a spring rests while the spring yields.
  const bool is_elastic = contact.stiffness.present() && contact.law->set_valued();
  return {
      [&system, j, sign, is_elastic](double t, const double* y) {
        return sign * (is_elastic ? system.contact_slip_rate(j, t, y) : system.slip_rate(j, t, y));
      },
      [&system, j, sign, force = std::vector<double>(system.friction_contacts())](double t, const double* y) mutable {
        system.friction_forces(t, y, force.data());
        const double load = system.normal_load(j, t, y);
        return load > 0 ? sign * force[j] / load : 0;
      },
      [law = contact.law, N](double v) {
        return law->steady_friction({v, N}).friction;
      },
      level != 0 ? std::abs(level) : system.reference_speed_of(j),
      !has_memory && !contact.stiffness.present() && contact.normal_load.constant() && !system.follows_motion(j)};
}

SlipRecord::SlipRecord(SlipSeen seen, int unknowns, double tolerance, double stick_threshold)
    : seen_(std::move(seen)), unknowns_(unknowns), tolerance_(tolerance), threshold_{stick_threshold, 0.01, 0.5} {}

namespace {
/// Value at θ of the polynomial through the samples (θ = 0 and the nodes).
template <class Samples, class Quantity>
double polynomial(const Samples& samples, Quantity quantity, double theta) {
  std::array<double, RadauTableau::stages + 1> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = samples[i].*quantity;
  return RadauTableau::get().interpolate(values, theta);
}
}  // namespace

/// Extrema of the polynomial of a quantity within the step.
std::vector<SlipRecord::Extremum> SlipRecord::extrema(const std::vector<Sample>& samples, double Sample::*quantity) {
  constexpr int fine = 8;
  const auto slope = [&](double theta) {
    constexpr double d = 1e-5;
    return polynomial(samples, quantity, theta + d) - polynomial(samples, quantity, theta - d);
  };
  std::vector<Extremum> found;
  double before = slope(0);
  for (int i = 1; i <= fine; ++i) {
    const double after = slope(double(i) / fine);
    if ((before > 0) != (after > 0)) {
      double left = double(i - 1) / fine, right = double(i) / fine;
      for (int k = 0; k < 20; ++k) {
        const double middle = 0.5 * (left + right);
        ((slope(middle) > 0) == (before > 0) ? left : right) = middle;
      }
      const double theta = 0.5 * (left + right);
      found.push_back({theta, polynomial(samples, quantity, theta), before > 0});
    }
    before = after;
  }
  return found;
}

SlipRecord::Sample SlipRecord::sample_at(Collocation& solver, double theta) const {
  std::vector<double> y(unknowns_);
  solver.solve_at(theta, y.data());
  const double t = solver.time_at(theta);
  return {theta, seen_.slip_rate(t, y.data()), seen_.friction(t, y.data())};
}

std::vector<SlipRecord::Sample> SlipRecord::samples(Collocation& solver) const {
  std::vector<Sample> samples;
  std::vector<double> y(unknowns_);
  const auto take = [&](double theta, double t, const double* state) {
    samples.push_back({theta, seen_.slip_rate(t, state), seen_.friction(t, state)});
  };
  take(0, solver.time_before(), solver.state_before().data());
  for (int i = 0; i < Collocation::stages; ++i) {
    solver.stage(i, y.data());
    take(RadauTableau::get().c[i], solver.stage_time(i), y.data());
  }
  return samples;
}

SlipRecord::Loop SlipRecord::loop(const std::vector<Sample>& samples) const {
  constexpr int s = Collocation::stages;
  const auto& tableau = RadauTableau::get();
  // Weights of the rule on the first, third and fifth node, exact to degree 2.
  static const std::array<double, 3> part = [&] {
    const double a = tableau.c[0], b = tableau.c[2], c = tableau.c[4];
    const auto weight = [](double x, double y, double z) {
      return (1.0 / 3 - (y + z) / 2 + y * z) / ((x - y) * (x - z));
    };
    return std::array{weight(a, b, c), weight(b, a, c), weight(c, a, b)};
  }();
  Loop result{0, 0, 0};
  for (int i = 0; i < s; ++i) {
    const Sample& at = samples[i + 1];
    // dv/dθ from the polynomial: in near-stick the force balance loses it to cancellation.
    double rate = 0;
    for (int j = 0; j < s; ++j) rate += tableau.a_inverse[i][j] * (samples[j + 1].slip_rate - samples[0].slip_rate);
    const double density = (at.friction - seen_.steady_friction(loop_slip_rate(at.slip_rate, seen_.speed))) * rate;
    result.integral += tableau.b[i] * density;
    result.magnitude += tableau.b[i] * std::abs(density);
    if (i % 2 == 0) result.check += part[i / 2] * density;
  }
  return result;
}

double SlipRecord::refined_loop(Collocation& solver, const Sample& begin, const Sample& end, double coarse,
                                double last_change, double accuracy) {
  const auto part = [&](const Sample& from, const Sample& to) {
    std::vector<Sample> samples{from};
    for (int i = 0; i + 1 < Collocation::stages; ++i)
      samples.push_back(sample_at(solver, from.theta + solver.node(i) * (to.theta - from.theta)));
    samples.push_back(to);
    return loop(samples).integral;
  };
  const Sample middle = sample_at(solver, 0.5 * (begin.theta + end.theta));
  const double left = part(begin, middle), right = part(middle, end);
  const double change = std::abs(left + right - coarse);
  // In small parts a change that no longer shrinks is rounding error.
  const bool rounding = end.theta - begin.theta < 0.01 && change > 0.5 * last_change;
  if (change <= accuracy || rounding || --divisions_left_ < 0) return left + right;
  return refined_loop(solver, begin, middle, left, change, accuracy) +
         refined_loop(solver, middle, end, right, change, accuracy);
}

double SlipRecord::time_below(Collocation& solver, const std::vector<Sample>& samples,
                              const std::vector<Extremum>& extrema, double threshold) const {
  const double h = solver.length();
  std::vector<double> marks{0.0};
  for (const double level : {threshold, -threshold}) {
    const auto mark = [&](const Sample& from, const Sample& to) {
      const double a = from.slip_rate - level, b = to.slip_rate - level;
      if ((a < 0) == (b < 0) || a == 0) return;
      const auto theta = solver.locate([&](double t, const double* y) { return seen_.slip_rate(t, y) - level; },
                                       from.theta, to.theta, a, b);
      if (theta) marks.push_back(*theta);
    };
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const Sample &from = samples[i - 1], &to = samples[i];
      // An extremum between nodes may lie across the level.
      const auto across = std::find_if(extrema.begin(), extrema.end(), [&](const Extremum& extremum) {
        return extremum.theta > from.theta && extremum.theta < to.theta &&
               (extremum.value < level) != (from.slip_rate < level) &&
               (extremum.value < level) != (to.slip_rate < level);
      });
      if (across == extrema.end()) {
        mark(from, to);
        continue;
      }
      const Sample extremum = sample_at(solver, across->theta);
      mark(from, extremum);
      mark(extremum, to);
    }
  }
  marks.push_back(1.0);
  std::sort(marks.begin(), marks.end());
  double within = 0;
  for (std::size_t i = 1; i < marks.size(); ++i) {
    const double middle = 0.5 * (marks[i - 1] + marks[i]);
    if (std::abs(polynomial(samples, &Sample::slip_rate, middle)) <= threshold) within += (marks[i] - marks[i - 1]) * h;
  }
  return within;
}

/// By the nodes where slip does not reverse, else by the parts of the polynomial.
double SlipRecord::distance(const std::vector<Sample>& samples, const std::vector<Extremum>& extrema) {
  const auto& tableau = RadauTableau::get();
  const auto v = [&](double theta) { return polynomial(samples, &Sample::slip_rate, theta); };
  std::vector<std::pair<double, double>> places;
  for (const auto& sample : samples) places.emplace_back(sample.theta, sample.slip_rate);
  for (const auto& extremum : extrema) places.emplace_back(extremum.theta, extremum.value);
  std::ranges::sort(places);
  std::vector<double> marks{0.0};
  for (std::size_t i = 1; i < places.size(); ++i) {
    auto [left, at_left] = places[i - 1];
    auto [right, at_right] = places[i];
    if (!(at_left * at_right < 0)) continue;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (left + right);
      ((v(middle) > 0) == (at_left > 0) ? left : right) = middle;
    }
    marks.push_back(right);
  }
  double sum = 0;
  if (marks.size() == 1) {
    for (int i = 0; i < RadauTableau::stages; ++i) sum += tableau.b[i] * samples[i + 1].slip_rate;
    return std::abs(sum);
  }
  marks.push_back(1.0);
  for (std::size_t i = 1; i < marks.size(); ++i) {  // Gauss's rule of three points is exact for the polynomial
    const double middle = 0.5 * (marks[i] + marks[i - 1]), half = 0.5 * (marks[i] - marks[i - 1]);
    const double aside = half * std::sqrt(0.6);
    sum += std::abs(half / 9 * (5 * v(middle - aside) + 8 * v(middle) + 5 * v(middle + aside)));
  }
  return sum;
}

void SlipRecord::add(Collocation& solver, const std::vector<Sample>& samples, const std::vector<Extremum>& of_slip,
                     double fastest, double strongest) {
  if (!seen_.follows_steady_curve) {
    const double accuracy =
        2e-3 * std::max(tolerance_, 1e-13) * std::max(fastest, std::abs(seen_.speed)) * std::max(strongest, 0.01);
    const Loop whole = loop(samples);
    // Orders 10 and 4: the relative error of the full rule is about the relative error of the partial rule to the
    // power 2.5.
    const double ratio = std::abs(whole.integral - whole.check) / std::max(whole.magnitude, 1e-300);
    const bool resolved = std::pow(ratio, 2.5) * whole.magnitude <= accuracy;
    loop_ += resolved ? whole.integral
                      : refined_loop(solver, samples.front(), samples.back(), whole.integral, infinity, accuracy);
  }
  for (int k = 0; k < 3; ++k)
    time_within[k] += time_below(solver, samples, of_slip, threshold_[k] * std::abs(seen_.speed));
}

Recorder::Recorder(const SliderSystem& system, double tolerance, double stick_threshold, bool keep_orbit)
    : system_(system), slip_(slip_seen(system), system.size(), tolerance, stick_threshold), keep_orbit_(keep_orbit) {
  sums_.slip_rate_max = sums_.friction_max = -infinity;
  sums_.slip_rate_min = sums_.friction_min = infinity;
}

void Recorder::extreme(Collocation& solver, const std::vector<Sample>& samples,
                       const std::vector<SlipRecord::Extremum>& extrema, double Sample::*quantity, double& low,
                       double& high) {
  for (const auto& sample : samples) {
    low = std::min(low, sample.*quantity);
    high = std::max(high, sample.*quantity);
  }
  // The polynomial gives the rough place of an extremum between nodes, parabolas through the step solved again its
  // value.
  const auto solved = [&](double theta) { return slip_.sample_at(solver, theta).*quantity; };
  for (const auto& [place, guess, is_maximum] : extrema) {
    double theta = place, width = 0.02;
    const double reach = 1e-3 * (high - low);
    const bool matters = is_maximum ? guess + reach > high : guess - reach < low;
    for (int refine = 0; matters && refine < 3; ++refine, width *= 0.2) {
      theta = std::clamp(theta, 1e-3, 1.0);
      const double inside = std::min({width, 0.5 * theta, 1 - theta});
      const double middle = solved(theta);
      low = std::min(low, middle);
      high = std::max(high, middle);
      if (inside < 1e-6) break;  // at the end of the step: the value there is already counted
      const double l = solved(theta - inside), r = solved(theta + inside), bend = l - 2 * middle + r;
      low = std::min({low, l, r});
      high = std::max({high, l, r});
      if (bend == 0) break;
      // Most of several nearly equal extrema prove not to be the highest after the first parabola.
      const double rise = (l - r) * (l - r) / (8 * std::abs(bend));
      if (is_maximum ? middle + 2 * rise < high : middle - 2 * rise > low) break;
      theta += inside * std::clamp(0.5 * (l - r) / bend, -2.0, 2.0);
    }
  }
}

void Recorder::step(Collocation& solver) {
  const double h = solver.length();
  const auto samples = slip_.samples(solver);
  if (keep_orbit_) {
    std::vector<double> y = solver.state_before();
    if (!orbit.empty()) orbit.pop_back();  // the end of the last step is the start of this one
    for (int i = -1; i < Collocation::stages; ++i) {
      if (i >= 0) solver.stage(i, y.data());
      const auto seen = system_.observe(i < 0 ? solver.time_before() : solver.stage_time(i), y.data());
      orbit.push_back({elapsed_ + samples[std::size_t(i + 1)].theta * h, seen.displacement, seen.slip_rate,
                       seen.friction_coefficient, seen.acceleration, seen.state});
    }
  }
  for (int i = 0; i < Collocation::stages; ++i) {
    const Sample& at = samples[std::size_t(i + 1)];
    const double weight = RadauTableau::get().b[i] * h;
    sums_.friction_mean += weight * at.friction;
    sums_.slip_rate_mean += weight * at.slip_rate;
  }
  const auto slip_extrema = SlipRecord::extrema(samples, &Sample::slip_rate);
  slip_.add(solver, samples, slip_extrema, sums_.slip_rate_max, sums_.friction_max);
  extreme(solver, samples, slip_extrema, &Sample::slip_rate, sums_.slip_rate_min, sums_.slip_rate_max);
  extreme(solver, samples, SlipRecord::extrema(samples, &Sample::friction), &Sample::friction, sums_.friction_min,
          sums_.friction_max);
  elapsed_ += h;
  friction_ = samples.back().friction;
}

void Recorder::add_rest(double time) {
  sums_.friction_mean += time * friction_;
  for (double& within : slip_.time_within) within += time;
  elapsed_ += time;
}

Metrics Recorder::finish(double period) const {
  Metrics m = sums_;
  m.period = period;
  m.friction_mean /= period;
  m.slip_rate_mean /= period;
  m.slow_fraction = slip_.time_within[0] / period;
  m.stick_fraction = m.slow_fraction;  // for smooth laws; set-valued laws overwrite it with the time of exact stick
  m.stick_fraction_001 = slip_.time_within[1] / period;
  m.stick_fraction_05 = slip_.time_within[2] / period;
  m.loop_area = std::abs(slip_.loop_integral());
  m.loop_area_normalised = m.loop_area / (m.slip_rate_max * m.friction_max);
  return m;
}

}  // namespace rosin::analysis::cycles
