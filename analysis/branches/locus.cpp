/// The growth rate of one mode held at 0 by pseudo-arclength; steady sliding is eliminated.
#include "analysis/branches/locus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/branches/cycle_problem.hpp"
#include "analysis/branches/fold_problem.hpp"
#include "analysis/steady/verdict.hpp"
#include "core/bracket.hpp"
#include "core/linear_solve.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::branches {

using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

constexpr const char *bautin = "bautin", *bogdanov_takens = "bogdanov-takens", *zero_hopf = "zero-hopf";

/// Half the sum of two eigenvalues, over a frequency, is 0: those whose sum and product are nearest to 0 and to the
/// product at the point before. The product is the square of the frequency where they are a pair, and negative where
/// they are real: the curve goes on through a double zero. The unknown is q, as its scale has it.
class HopfProblem final : public Problem {
 public:
  HopfProblem(const Family2& family, const LocusOptions& options, double angular_frequency)
      : family_(family),
        options_(options),
        frequency_(angular_frequency),
        product_(angular_frequency * angular_frequency) {}

  Residual residual(const VectorXd& x, double p, double, bool slopes) override {
    Residual result;
    try {
      result.F = VectorXd::Constant(1, mode_at(p, x[0]).growth / frequency_);
      if (!slopes) return result;
      const double c = options_.p.coordinate(p);
      result.F_x = MatrixXd::Constant(1, 1, difference([&](double aside) { return mode_at(p, x[0] + aside); }));
      const double by_c = difference([&](double aside) { return mode_at(options_.p.value(c + aside), x[0]); });
      result.F_p = VectorXd::Constant(1, by_c / options_.p.slope(c));
    } catch (const InputError& error) {
      result.outcome = {Ending::none_exists, error.what()};
    }
    return result;
  }

  const VectorXd& scale() const override { return scale_; }

  View view(const Solved& at, const Solved&) override {
    const auto& [x, p, tolerance] = at;
    View view;
    try {
      const auto here = mode_at(p, x[0]);
      view.metrics["angular_frequency"] = std::sqrt(std::max(here.product, 0.0));
      view.metrics[growth_error] = here.error / frequency_;
      const double square = frequency_ * frequency_;
      view.tests.push_back({bogdanov_takens, here.product / square, here.product_error / square});
      if (std::isfinite(here.real))
        view.tests.push_back({zero_hopf, here.real / frequency_, here.real_error / frequency_});
      add_normal_form(p, options_.q.value(x[0]), view);
    } catch (const InputError& error) {
      view.outcome = {Ending::none_exists, error.what()};
    }
    return view;
  }

  /// Not where two modes merge, which without damping are neutral before.
  bool crosses_alone(double p, double c_q) const {
    constexpr double merged = 1e-4;
    return mode_at(p, c_q).apart > merged;
  }

  bool refer_to(VectorXd& x, double p, double) override {
    product_ = mode_at(p, x[0]).product;
    return false;
  }
  int in_common() const override { return 1; }

  static constexpr const char* growth_error = "growth_error";  ///< over the frequency at the start

 private:
  void add_normal_form(double p, double q, View& view) const {
    const double angular_frequency = view.metrics.at("angular_frequency");
    if (!options_.normal_form || angular_frequency == 0) return;
    try {
      const auto form = options_.normal_form(p, q, angular_frequency);
      if (!form) return;
      view.tests.push_back({bautin, form->value, form->error});
      view.metrics["first_lyapunov_coefficient"] = form->value;
    } catch (const InputError&) {  // the curve goes on without it
    }
  }
  struct Mode {
    double growth, product;  ///< half the sum of the two eigenvalues, 1/s; 1/s²
    double error, product_error;
    double apart;  ///< from the next eigenvalue, over the frequency at the start
    /// Of the real eigenvalues beside them the one nearest to 0, with the sign of their product; NaN: there is none.
    double real = NAN, real_error = 0;
  };
  Mode mode_at(double p, double c_q) const {
    const auto oscillator = family_(p, options_.q.value(c_q));
    const auto [values, errors] = steady::spectrum_of_sliding(oscillator->linearised().moving());
    constexpr double least = 0.03;  // of the frequency at the start
    const double frequency = std::max(std::sqrt(std::abs(product_)), least * frequency_);
    Mode mode{NAN, NAN, 0, 0, infinity};
    double nearest = infinity;
    std::size_t first = 0, second = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      // A complex eigenvalue stands for its pair, a real one goes with each of the others.
      const bool pair = values[i].imag() != 0;
      for (std::size_t j = pair ? i : i + 1; j < (pair ? i + 1 : values.size()); ++j) {
        if (values[i].imag() < 0 || (!pair && values[j].imag() != 0)) continue;
        const double a = values[i].real(), b = values[j].real();
        const double growth = 0.5 * (a + b), product = pair ? std::norm(values[i]) : a * b;
        const double off = std::hypot(growth, (product - product_) / (2 * frequency));
        if (!(off < nearest)) continue;
        nearest = off, first = i, second = j;
        mode.growth = growth, mode.product = product;
        mode.error = 0.5 * (errors[i] + errors[j]);
        mode.product_error = std::abs(values[i]) * errors[j] + std::abs(values[j]) * errors[i];
      }
    }
    if (nearest == infinity) throw InputError("no two modes are left whose growth rates add up to 0");
    double sign = 1;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (k == first || k == second || std::abs(values[k] - std::conj(values[first])) == 0) continue;
      mode.apart = std::min(mode.apart, std::abs(values[k] - values[first]) / frequency_);
      const double real = values[k].real();
      if (values[k].imag() != 0) continue;
      sign *= real > 0 ? 1 : -1;
      if (std::isnan(mode.real) || std::abs(real) < std::abs(mode.real)) mode.real = real, mode.real_error = errors[k];
    }
    mode.real = sign * std::abs(mode.real);
    return mode;
  }
  /// By differences: Newton's method needs no better.
  template <class At>
  double difference(At at) const {
    constexpr double aside = 1e-5;
    return (at(aside).growth - at(-aside).growth) / (2 * aside * frequency_);
  }

  const Family2& family_;
  const LocusOptions& options_;
  double frequency_;  ///< at the start
  double product_;    ///< at the point before
  VectorXd scale_ = VectorXd::Ones(1);
};

/// One point, with the errors that rounding of the eigenvalue leaves across the curve.
LocusPoint locus_point(HopfProblem& problem, const BranchPoint& at, const LocusOptions& options) {
  const auto slopes = problem.residual(at.x, at.p, options.tolerance, true);
  const double c = options.p.coordinate(at.p), by_p = slopes.F_p[0] * options.p.slope(c), by_q = slopes.F_x(0, 0);
  const double off = at.view.metrics.at(HopfProblem::growth_error);
  const double per_slope = off / (by_p * by_p + by_q * by_q);
  const double p_slope = std::abs(options.p.slope(c)), q_slope = std::abs(options.q.slope(at.x[0]));
  constexpr double rounding = 4e-16;
  const double q = options.q.value(at.x[0]);
  auto metrics = at.view.metrics;
  metrics.erase(HopfProblem::growth_error);
  return {at.p, q, at.error + per_slope * std::abs(by_p) * p_slope + rounding * std::abs(at.p),
          (at.x_error + per_slope * std::abs(by_q)) * q_slope + rounding * std::abs(q), std::move(metrics)};
}

/// A point at which a test is 0, with what the test's error leaves open along the curve.
LocusEvent event_at(HopfProblem& problem, const SpecialPoint& special, const Branch& branch,
                    const LocusOptions& options) {
  BranchPoint there;
  there.p = special.p, there.error = special.error, there.x = special.x, there.view = special.view;
  LocusEvent event{special.kind, locus_point(problem, there, options)};
  const auto &before = branch.points[special.after], &after = branch.points[special.after + 1];
  const auto test = [&](const Problem::View& view) {
    return *std::ranges::find(view.tests, special.test, &Problem::Test::kind);
  };
  const auto here = test(special.view);
  const double per_value =
      (here.error + std::abs(here.value)) / std::abs(test(after.view).value - test(before.view).value);
  event.at.p_error += per_value * std::abs(after.p - before.p);
  event.at.q_error += per_value * std::abs(options.q.value(after.x[0]) - options.q.value(before.x[0]));
  return event;
}

/// At a given q: the value of p on the curve near one.
std::optional<BranchPoint> at_q(Continuation& continuation, double c_q, double p) {
  return continuation.branch_off(VectorXd::Constant(1, c_q), p, {VectorXd::Ones(1), 0}, 0);
}

/// Along the curve until q leaves its range, where a last point is put. \returns why it ends before; empty: it does not
std::string follow_hopf(HopfProblem& problem, Continuation& continuation, const LocusOptions& options,
                        const BranchPoint& start, double sign, std::vector<LocusPoint>& points,
                        std::vector<LocusEvent>& events) {
  const auto inside = [](const BranchPoint& point) { return point.x[0] >= 0 && point.x[0] <= 1; };
  const auto oscillates = [](const BranchPoint& point) {
    const auto& square_of_frequency = point.view.tests.front();
    return square_of_frequency.value > 0 || !square_of_frequency.has_sign();
  };
  continuation.arrived = [&](const BranchPoint& point) { return inside(point) && oscillates(point); };
  auto branch = continuation.follow(start, Direction{VectorXd::Constant(1, sign), 0});
  if (branch.outcome.ending == Ending::interrupted) throw Stopped{};
  std::vector<LocusPoint> last;
  for (const auto& special : branch.special)
    if (special.x[0] >= 0 && special.x[0] <= 1) {
      events.push_back(event_at(problem, special, branch, options));
      if (special.test == bogdanov_takens) last = {events.back().at};
    }
  std::string end = branch.outcome.detail;
  if (auto outside = branch.points.back(); !oscillates(outside)) {
    end = "the frequency goes to 0";
    branch.points.pop_back();
  } else if (!inside(outside)) {
    end.clear();
    branch.points.pop_back();
    const double border = outside.x[0] < 0 ? 0 : 1;
    constexpr double on_it = 1e-9;
    const bool is_there = std::abs(branch.points.back().x[0] - border) < on_it;
    if (const auto there = is_there ? std::nullopt : at_q(continuation, border, outside.p))
      branch.points.push_back(*there);
  }
  for (const auto& point : branch.points) points.push_back(locus_point(problem, point, options));
  points.insert(points.end(), last.begin(), last.end());
  return end;
}

/// The branch of cycles near one along one parameter at a value of the other, followed a little.
class NearSpecial {
 public:
  NearSpecial(Family2 family, const ParameterScale& scale, double tolerance)
      : family_(std::move(family)), scale_(scale), tolerance_(tolerance) {}

  /// The special point at q near one whose cycle is known.
  /// \param alike  one of another test serves as well, if that is told alike
  /// \param opening  of a fold the sign of the parameter along which both cycles are, from the fold: of two folds that
  ///        meet in a cusp it differs. That which is wanted, 0 for any, and then that of the fold that was found
  std::optional<SpecialPoint> find(const SpecialPoint& known, double p, double q, bool alike = false,
                                   int* opening = nullptr) const {
    const auto is_wanted = [&](const std::string& test) {
      return alike ? shown_kind(test) == shown_kind(known.test) : test == known.test;
    };
    const Family family = [&](double at) { return family_(at, q); };
    const double period = known.view.metrics.at("period");
    for (const double reach : {0.02, 0.1})
      for (const double sign : {1.0, -1.0}) {
        CycleProblem problem(family, known.view.turns);
        ContinuationOptions how;
        how.parameter = scale_, how.tolerance = tolerance_;
        how.first_step = how.longest_step = reach;
        constexpr int few = 8;
        how.most_points = few;
        Continuation continuation(problem, how);
        const auto x = problem.begin(known.view.start, period, p);
        const auto along = direction(problem, x, p);
        if (!along) return std::nullopt;
        auto start = continuation.branch_off(x, p, *along, -sign * reach);
        if (!start) continue;
        problem.refer_to(start->x, start->p, tolerance_);
        const auto sign_at = [&](const BranchPoint& point) {  // 0: left open
          const auto test = std::ranges::find_if(point.view.tests, is_wanted, &Problem::Test::kind);
          return test == point.view.tests.end() || !test->has_sign() ? 0 : test->value > 0 ? 1 : -1;
        };
        const int before = sign_at(*start);
        continuation.arrived = [&](const BranchPoint& point) { return sign_at(point) * before >= 0; };
        // The unknowns may be others by now: the parameter and the period keep their meaning.
        auto onward = direction(problem, start->x, start->p);
        if (!onward) continue;
        const double turn = onward->x.head(1).dot(along->x.head(1)) + onward->c * along->c;
        if ((turn < 0) != (sign < 0)) onward->x *= -1, onward->c *= -1;
        const auto branch = continuation.follow(*start, *onward);
        if (branch.outcome.ending == Ending::interrupted) throw Stopped{};
        for (const auto& special : branch.special) {
          if (!is_wanted(special.test)) continue;
          const double before_it = branch.points[special.after].p - special.p,
                       behind = branch.points[special.after + 1].p - special.p;
          const int opens = (std::abs(before_it) > std::abs(behind) ? before_it : behind) > 0 ? 1 : -1;
          if (opening && *opening != 0 && opens != *opening) continue;
          if (opening) *opening = opens;
          return special;
        }
      }
    return std::nullopt;
  }

 private:
  /// Of the branch through a cycle, or near one.
  std::optional<Direction> direction(CycleProblem& problem, const VectorXd& x, double p) const {
    const auto found = problem.residual(x, p, tolerance_, true);
    if (!found.outcome.complete() || !found.F_x.allFinite() || !found.F_p.allFinite()) return std::nullopt;
    const Eigen::Index n = x.size();
    MatrixXd A(n + 1, n + 1);
    A.topLeftCorner(n, n) = found.F_x * problem.scale().asDiagonal();
    A.topRightCorner(n, 1) = found.F_p * scale_.slope(scale_.coordinate(p));
    A.bottomRows(1).setOnes();
    const VectorXd t = solve_linear(A, VectorXd::Unit(n + 1, n)).normalized();
    if (!t.allFinite()) return std::nullopt;
    return Direction{t.head(n), t[n]};
  }

  Family2 family_;
  ParameterScale scale_;
  double tolerance_;
};

constexpr double on_level = 1e-9;  // of the range of q

/// Half the sum of that pair of multipliers whose product is nearest to 1: the cosine of their angle where they lie on
/// the unit circle. NaN where there is no pair.
struct CosineOfPair {
  double value = NAN, error = 0;
};
CosineOfPair cosine_of_pair(const SpecialPoint& special) {
  const auto& z = special.view.multipliers;
  const auto& errors = special.view.multiplier_errors;
  CosineOfPair cosine;
  double least = infinity;
  for (std::size_t i = 0; i < z.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const double off = std::abs(z[i] * z[j] - 1.0); off < least) {
        least = off;
        cosine = {(z[i] + z[j]).real() / 2, (errors[i] + errors[j]) / 2};
      }
  return cosine;
}
struct Resonance {
  const char* kind;
  double cosine;
};
constexpr Resonance resonances[] = {
    {"resonance-1:1", 1}, {"resonance-1:2", -1}, {"resonance-1:3", -0.5}, {"resonance-1:4", 0}};

/// A curve of special points, followed at whole steps of that parameter along which it runs: where it turns in one, the
/// other goes on.
class SpecialCurve {
 public:
  SpecialCurve(const Family2& family, const SpecialPoint& start, double q, const LocusOptions& options)
      : family_(family),
        scales_{options.p, options.q},
        tolerance_(options.tolerance),
        near_{NearSpecial(family, options.p, options.tolerance),
              NearSpecial([family](double at_q, double at_p) { return family(at_p, at_q); }, options.q,
                          options.tolerance)},
        start_(start),
        q_(q),
        start_place_{options.p.coordinate(start.p), options.q.coordinate(q)},
        longest_(1.0 / options.points) {}

  LocusPoint start() const { return {start_.p, q_, start_.error, 0, start_.view.metrics}; }
  /// Towards smaller or larger q at first. \returns why it ends; empty: at the end of a range
  std::string follow(int sign, std::vector<LocusPoint>& points, std::vector<LocusEvent>& events) {
    SpecialPoint at = start_;
    Place place = start_place_, tangent = {0, double(sign)};
    std::optional<Place> departure;  // its direction
    const bool is_fold = start_.test == "fold";
    int opening = 0, opening_along = -1;  // of the fold, and the parameter that it was not along
    bool has_left = false, alike = false;
    constexpr double least = 1.0 / 64;
    constexpr int most_cusps = 8;
    std::vector<LongStep> long_steps{{at, place, tangent, points.size()}};
    for (double step = longest_;;) {
      end_if_stopped();
      const int along = std::abs(tangent[1]) >= std::abs(tangent[0]) ? 1 : 0, across = 1 - along;
      if (tangent[along] > 0 ? place[along] >= 1 : place[along] <= 0) return {};
      const double next = next_step(place[along], tangent[along], step);
      const double expected = place[across] + tangent[across] / tangent[along] * (next - place[along]);
      int opens = along == opening_along ? opening : 0;  // where the curve turns the parameters change places
      const auto found = near_[across].find(at, scales_[across].value(std::clamp(expected, 0.0, 1.0)),
                                            scales_[along].value(next), alike, is_fold ? &opens : nullptr);
      // Near a turn the other side of the curve is near as well.
      const double reached = found ? scales_[across].coordinate(found->p) : NAN;
      constexpr double most = 2;  // steps
      if (!found || (departure && std::abs(reached - expected) > most * std::abs(next - place[along]))) {
        step *= 0.5;
        if (step >= least * longest_) continue;
        if (!is_fold && !alike) {
          alike = true, step = longest_;
          continue;
        }
        if (expected < 0 || expected > 1) return {};
        const auto passed = is_fold && cusps_ < most_cusps ? pass_cusp(long_steps, points, events) : std::nullopt;
        if (!passed) return "no such cycle follows, however near: a point of another kind";
        ++cusps_;
        opening_along = -1;
        at = passed->at, place = passed->place, tangent = passed->tangent;
        long_steps = {{at, place, tangent, points.size()}};
        step = longest_;
        continue;
      }
      alike = false;
      opening = opens, opening_along = along;
      const Place before = place;
      place[along] = next, place[across] = reached;
      tangent = {place[0] - before[0], place[1] - before[1]};
      if (!departure) departure = tangent;
      pass_level(*found, before, place, points);
      if (start_.kind == "torus") find_resonances(at, before, *found, place, along, events);
      at = *found;
      points.push_back(point(at, place, along));
      if (step == longest_) long_steps.push_back({at, place, tangent, points.size()});
      has_left = has_left || distance(place, start_place_) > 2 * longest_;
      // Behind a cusp the curve comes by in the other direction.
      const bool onwards = tangent[0] * (*departure)[0] + tangent[1] * (*departure)[1] > 0;
      if (has_left && onwards && distance(place, start_place_) < longest_) {
        points.push_back(start());
        closed_ = true;
        return "it closes on itself";
      }
      step = std::min(longest_, 2 * step);
    }
  }
  bool closed() const { return closed_; }

 private:
  using Place = std::array<double, 2>;  ///< coordinates of p and q
  /// Where a curve has been, and how many points it had until then.
  struct LongStep {
    SpecialPoint at;
    Place place, tangent;
    std::size_t points;
  };
  /// Where the curve comes back to the value of q that it began at, it passes a special point of the branches there.
  void pass_level(const SpecialPoint& at, const Place& before, const Place& place,
                  std::vector<LocusPoint>& points) const {
    const double level = start_place_[1];
    if (!((before[1] - level) * (place[1] - level) < 0) || std::abs(place[1] - level) <= on_level) return;
    const double part = (level - before[1]) / (place[1] - before[1]);
    if (const auto passed = near_[0].find(at, scales_[0].value(before[0] + part * (place[0] - before[0])), q_))
      points.push_back({passed->p, q_, passed->error, 0, passed->view.metrics});
  }

  /// Near a cusp both folds are near, and one may have been taken for the other: from two long steps before, the curve
  /// is followed by its length in the cycle and both parameters, in which it goes on through the cusp. \returns where
  /// it is well behind it; empty: there is no cusp
  std::optional<LongStep> pass_cusp(const std::vector<LongStep>& long_steps, std::vector<LocusPoint>& points,
                                    std::vector<LocusEvent>& events) const {
    const LongStep& from = long_steps[long_steps.size() - std::min<std::size_t>(2, long_steps.size())];
    FoldProblem problem(family_, scales_[0], scales_[1], from.at.view.turns);
    const auto x = problem.begin(from.at.view.start, from.at.view.metrics.at("period"), from.at.p,
                                 scales_[1].value(from.place[1]), tolerance_);
    if (!x) return std::nullopt;
    ContinuationOptions how;
    how.parameter = scales_[0], how.tolerance = tolerance_;
    how.first_step = 0.25 * longest_, how.longest_step = std::min(0.05, longest_);
    constexpr int most = 200;
    how.most_points = most;
    Continuation continuation(problem, how);
    const double length = std::hypot(from.tangent[0], from.tangent[1]);
    Direction direction{VectorXd::Zero(x->size()), from.tangent[0] / length};
    direction.x[0] = from.tangent[1] / length;
    auto start = continuation.branch_off(*x, from.at.p, direction, 0);
    if (!start) return std::nullopt;
    if (problem.refer_to(start->x, start->p, tolerance_)) return std::nullopt;
    const auto place_of = [&](const BranchPoint& point) { return Place{scales_[0].coordinate(point.p), point.x[0]}; };
    const auto side = [](const BranchPoint& point) {
      const auto& test = point.view.tests.front();
      return !test.has_sign() ? 0 : test.value > 0 ? 1 : -1;
    };
    const int before = side(*start);
    if (before == 0) return std::nullopt;
    std::optional<Place> cusp;
    bool is_inside = true;
    continuation.arrived = [&](const BranchPoint& point) {
      is_inside = point.x[0] >= 0 && point.x[0] <= 1;
      if (!cusp && side(point) == -before) cusp = place_of(point);
      return is_inside && !(cusp && distance(*cusp, place_of(point)) > longest_);
    };
    auto branch = continuation.follow(*start, direction);
    if (branch.outcome.ending == Ending::interrupted) throw Stopped{};
    if (!is_inside) branch.points.pop_back();
    if (branch.special.empty() || branch.points.size() < branch.special.front().after + 3) return std::nullopt;
    points.resize(from.points);
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      const auto &last = branch.points[i - 1], &next = branch.points[i];
      pass_level(special_at(next), place_of(last), place_of(next), points);
      points.push_back(point_at(next));
    }
    const auto &last = branch.points.back(), &second = branch.points[branch.points.size() - 2];
    const Place place = place_of(last), behind = place_of(second);
    events.push_back(cusp_at(branch.special.front(), branch));
    return LongStep{special_at(last), place, {place[0] - behind[0], place[1] - behind[1]}, 0};
  }
  SpecialPoint special_at(const BranchPoint& point) const {
    return {start_.kind, point.p, point.error, point.x, point.view, 0, start_.test};
  }
  LocusPoint point_at(const BranchPoint& point) const {
    return {point.p, scales_[1].value(point.x[0]), point.error, point.x_error * std::abs(scales_[1].slope(point.x[0])),
            point.view.metrics};
  }
  /// With what the test's error leaves open along the curve, by the farther of the two points that it lies between: at
  /// the cusp itself both parameters stand still.
  LocusEvent cusp_at(const SpecialPoint& special, const Branch& branch) const {
    const auto &before = branch.points[special.after], &after = branch.points[special.after + 1];
    const auto& test = special.view.tests.front();
    const double part = (test.error + std::abs(test.value)) /
                        std::abs(after.view.tests.front().value - before.view.tests.front().value);
    const auto farther = [&](double here, double a, double b) {
      return part * std::max(std::abs(a - here), std::abs(b - here));
    };
    const auto q = [&](const VectorXd& x) { return scales_[1].value(x[0]); };
    return {FoldProblem::cusp,
            {special.p, q(special.x), special.error + farther(special.p, before.p, after.p),
             std::max(before.x_error, after.x_error) * std::abs(scales_[1].slope(special.x[0])) +
                 farther(q(special.x), q(before.x), q(after.x)),
             special.view.metrics}};
  }

  /// Between two points of a curve of tori: where the angle of its multipliers is one of a strong resonance.
  void find_resonances(const SpecialPoint& a, const std::array<double, 2>& from, const SpecialPoint& b,
                       const std::array<double, 2>& to, int along, std::vector<LocusEvent>& events) const {
    const double at_a = cosine_of_pair(a).value, at_b = cosine_of_pair(b).value;
    const int across = 1 - along;
    std::vector<std::pair<double, LocusEvent>> found;  // by the part of the way
    for (const auto& [kind, wanted] : resonances) {
      if (!((at_a - wanted) * (at_b - wanted) < 0)) continue;
      Bracket bracket{0, 1, at_a - wanted, at_b - wanted};
      double part = 0, moved = infinity;
      std::optional<SpecialPoint> there;
      CosineOfPair cosine;
      constexpr int most = 30;
      constexpr double at_rest = 1e-12;
      for (int k = 0; k < most && bracket.width() > at_rest; ++k) {
        const double next = bracket.secant();
        const double guess = from[across] + next * (to[across] - from[across]);
        const auto here = near_[across].find(next < 0.5 ? a : b, scales_[across].value(std::clamp(guess, 0.0, 1.0)),
                                             scales_[along].value(from[along] + next * (to[along] - from[along])));
        if (!here) break;
        moved = std::abs(next - part);
        part = next, there = here, cosine = cosine_of_pair(*here);
        const double value = cosine.value - wanted;
        if (std::abs(value) <= cosine.error || moved < at_rest) break;
        bracket.take(part, value);
      }
      if (!there) continue;
      const double open = (std::abs(cosine.value - wanted) + cosine.error) / std::abs(at_b - at_a);
      std::array<double, 2> place;
      place[along] = from[along] + part * (to[along] - from[along]);
      place[across] = scales_[across].coordinate(there->p);
      LocusEvent event{kind, point(*there, place, along)};
      event.at.p_error += open * std::abs(scales_[0].value(to[0]) - scales_[0].value(from[0]));
      event.at.q_error += open * std::abs(scales_[1].value(to[1]) - scales_[1].value(from[1]));
      found.emplace_back(part, std::move(event));
    }
    std::ranges::sort(found, {}, &std::pair<double, LocusEvent>::first);
    for (auto& event : found) events.push_back(std::move(event.second));
  }
  static double distance(const Place& a, const Place& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }
  /// Whole steps of the range, so that curves have their points at the same values.
  static double next_step(double from, double towards, double step) {
    const double next = (towards > 0 ? std::floor(from / step + 1 + 1e-9) : std::ceil(from / step - 1 - 1e-9)) * step;
    return std::clamp(next, 0.0, 1.0);
  }
  LocusPoint point(const SpecialPoint& special, const Place& place, int along) const {
    const double given = scales_[along].value(place[along]);
    return along == 1 ? LocusPoint{special.p, given, special.error, 0, special.view.metrics}
                      : LocusPoint{given, special.p, 0, special.error, special.view.metrics};
  }

  const Family2& family_;
  ParameterScale scales_[2];
  double tolerance_;
  NearSpecial near_[2];  ///< along p at a value of q, and along q at a value of p
  SpecialPoint start_;
  double q_;
  Place start_place_;
  double longest_;
  bool closed_ = false;
  int cusps_ = 0;  ///< passed
};

/// Whether a curve passes a special point of the branches at q: where it comes back to q, it has a point.
bool passes(const Locus& curve, const SpecialPoint& special, double q, const LocusOptions& options) {
  constexpr double same = 1e-6;  // of the range
  return curve.kind == special.kind && std::ranges::any_of(curve.points, [&](const LocusPoint& point) {
           return std::abs(options.q.coordinate(point.q) - options.q.coordinate(q)) < on_level &&
                  std::abs(options.p.coordinate(point.p) - options.p.coordinate(special.p)) < same;
         });
}

/// A way along a curve from where it begins to be followed.
struct Half {
  std::vector<LocusPoint> points;
  std::vector<LocusEvent> events;
  std::string end;
};

/// The curve through a point from its two halves, which both lead away from it.
Locus joined(std::string kind, Half backwards, const Half& forwards) {
  const auto append = [](auto list, const auto& more) {
    std::ranges::reverse(list);
    list.insert(list.end(), more.begin(), more.end());
    return list;
  };
  return {std::move(kind), append(std::move(backwards.points), forwards.points), backwards.end, forwards.end,
          append(std::move(backwards.events), forwards.events)};
}

}  // namespace

Locus hopf_locus(const Family2& family, const steady::Crossing& crossing, double q, const LocusOptions& options) {
  Half halves[2];
  for (const int half : {0, 1}) {
    HopfProblem problem(family, options, crossing.angular_frequency);
    ContinuationOptions how;
    how.parameter = options.p, how.tolerance = options.tolerance;
    how.first_step = how.longest_step = 1.0 / options.points;
    how.most_points = 20 * options.points;
    Continuation continuation(problem, how);
    const double c_q = options.q.coordinate(q);
    const auto start =
        problem.crosses_alone(crossing.value, c_q) ? at_q(continuation, c_q, crossing.value) : std::nullopt;
    if (!start)
      return {"hopf",
              {},
              "",
              fmt::format("the Hopf point {:.9g} is not followed in two parameters: no mode crosses by itself there",
                          crossing.value)};
    auto& [points, events, end] = halves[half];
    end = follow_hopf(problem, continuation, options, *start, half == 0 ? -1 : 1, points, events);
  }
  halves[1].points.erase(halves[1].points.begin());  // the start, which both have
  return joined("hopf", std::move(halves[0]), halves[1]);
}

Locus cycle_locus(const Family2& family, const SpecialPoint& special, double q, const LocusOptions& options) {
  SpecialCurve curve(family, special, q, options);
  Half before{{curve.start()}, {}, {}}, after;
  before.end = curve.follow(-1, before.points, before.events);
  after.end = curve.closed() ? before.end : curve.follow(1, after.points, after.events);
  return joined(special.kind, std::move(before), after);
}

Loci find_loci(const Family2& family, const Branches& found, double q, const LocusOptions& options) {
  Loci loci;
  try {
    // What one curve is refused for is no reason to lose the others.
    const auto add = [&](const std::string& kind, auto curve) {
      try {
        loci.curves.push_back(curve());
      } catch (const InputError& error) {
        loci.curves.push_back(
            {kind, {}, "", fmt::format("{} is not followed in two parameters: {}", kind, error.what())});
      }
    };
    for (const auto& crossing : found.crossings)
      if (crossing.angular_frequency > 0) add("hopf", [&] { return hopf_locus(family, crossing, q, options); });
    for (const auto& cycle : found.cycles)
      for (const auto& special : cycle.branch.special)
        if (special.kind != "switching-sliding" &&
            std::ranges::none_of(loci.curves, [&](const Locus& curve) { return passes(curve, special, q, options); }))
          add(special.kind, [&] { return cycle_locus(family, special, q, options); });
  } catch (const Stopped&) {
    loci.outcome = {Ending::interrupted, "the curves that were followed until then are kept"};
  }
  return loci;
}

}  // namespace rosin::analysis::branches
