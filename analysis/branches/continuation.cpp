/// Predictor and corrector along a branch; zeros of tests by the Illinois method, borders by secants from one side.
#include "analysis/branches/continuation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/bracket.hpp"
#include "core/linear_solve.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::branches {

using Eigen::MatrixXd, Eigen::VectorXd;

namespace {
constexpr double finer = 1e-2;            ///< tolerance of what is told, over that of the search
constexpr double least_step = 1e-9;       ///< lengths
constexpr double nearest_parallel = 0.9;  ///< cosine between two steps
}  // namespace

double ParameterScale::coordinate(double p) const {
  return logarithmic ? std::log(p / from) / std::log(to / from) : (p - from) / (to - from);
}
double ParameterScale::value(double c) const {
  return logarithmic ? from * std::pow(to / from, c) : from + c * (to - from);
}
double ParameterScale::slope(double c) const { return logarithmic ? value(c) * std::log(to / from) : to - from; }

Direction Continuation::parameter_alone(Eigen::Index unknowns) const { return {VectorXd::Zero(unknowns), 1.0}; }

MatrixXd Continuation::bordered(const Problem::Residual& found, const Solution& at, const Direction& normal) const {
  const Eigen::Index n = at.x.size();
  MatrixXd A(n + 1, n + 1);
  A.topLeftCorner(n, n) = found.F_x * problem_.scale().asDiagonal();
  A.topRightCorner(n, 1) = found.F_p * options_.parameter.slope(at.c);
  A.bottomLeftCorner(1, n) = normal.x.transpose();
  A(n, n) = normal.c;
  return A;
}

bool Continuation::iterate(Solution& at, const Direction& normal, const Solution& from, double length, double tolerance,
                           double& last, int most, MatrixXd& A, bool always) {
  constexpr double farthest = 0.5, slow = 0.1, noise = 100;
  double before = infinity;
  for (int k = 0; k < most; ++k) {
    end_if_stopped();
    const bool renew = always || A.size() == 0 || last > slow * before;
    before = last;
    const auto found = problem_.residual(at.x, options_.parameter.value(at.c), tolerance, renew);
    ++residuals_, ++at.iterations;
    if (!found.outcome.complete() || !found.F.allFinite()) return false;
    const VectorXd& size = problem_.scale();
    const Eigen::Index n = at.x.size();
    if (renew) {
      if (!found.F_x.allFinite() || !found.F_p.allFinite()) return false;
      A = bordered(found, at, normal);
    }
    VectorXd F(n + 1);
    F.head(n) = found.F;
    F[n] = normal.x.dot((at.x - from.x).cwiseQuotient(size)) + normal.c * (at.c - from.c) - length;
    const VectorXd step = solve_linear(A, -F);
    if (!step.allFinite()) return false;
    last = step.cwiseAbs().maxCoeff();
    if (last > farthest) return false;
    at.looser_x = at.x, at.looser_c = at.c;
    at.x += size.cwiseProduct(step.head(n));
    at.c += step[n];
    if (last < tolerance) return true;
    if (k > 2 && last > 0.5 * before) return last < noise * tolerance;
  }
  return last < noise * tolerance;
}

std::optional<Continuation::Solution> Continuation::correct(const Solution& guess, const Direction& normal,
                                                            const Solution& from, double length, bool smooth) {
  constexpr int most = 8;
  Solution at = guess;
  at.iterations = 0;
  double last = infinity;
  MatrixXd A;
  if (!iterate(at, normal, from, length, options_.tolerance, last, most, A, true)) return std::nullopt;
  const Solution coarse = at;
  // Its multipliers are those at the last Jacobian where the correction from there moves them little.
  constexpr double little = 0.1;
  const bool as_corrected = !(last < little * options_.tolerance);
  last = infinity;
  if (!smooth) A.resize(0, 0);
  // Where rounding keeps the finer tolerance out of reach, the error says so.
  if (!iterate(at, normal, from, length, finer * options_.tolerance, last, most, A, false) &&
      !(last < options_.tolerance))
    at = coarse, last = options_.tolerance;
  at.iterations = coarse.iterations;
  at.looser_x = as_corrected ? coarse.x : coarse.looser_x, at.looser_c = as_corrected ? coarse.c : coarse.looser_c;
  at.c_error = std::abs(at.c - coarse.c) + last;
  at.x_error = (at.x - coarse.x).cwiseQuotient(problem_.scale()).cwiseAbs().maxCoeff() + last;
  return at;
}

std::optional<Direction> Continuation::tangent(const Solution& at, const Direction& along) {
  const auto found = problem_.residual(at.x, options_.parameter.value(at.c), options_.tolerance, true);
  if (!found.outcome.complete() || !found.F_x.allFinite() || !found.F_p.allFinite()) return std::nullopt;
  const Eigen::Index n = at.x.size();
  VectorXd t = solve_linear(bordered(found, at, along), VectorXd::Unit(n + 1, n));
  if (!t.allFinite() || !(t.norm() > 0)) return std::nullopt;
  t.normalize();
  return Direction{t.head(n), t[n]};
}

BranchPoint Continuation::point_of(const Solution& at) {
  BranchPoint point;
  point.p = options_.parameter.value(at.c);
  point.error = at.c_error * std::abs(options_.parameter.slope(at.c));
  point.x = at.x;
  point.x_error = at.x_error;
  point.view = view_of(at);
  return point;
}

Problem::View Continuation::view_of(const Solution& at) {
  return problem_.view({at.x, options_.parameter.value(at.c), finer * options_.tolerance},
                       {at.looser_x, options_.parameter.value(at.looser_c), options_.tolerance});
}

std::optional<BranchPoint> Continuation::close(VectorXd x, double p) {
  Solution guess{std::move(x), options_.parameter.coordinate(p)};
  const auto at = correct(guess, parameter_alone(guess.x.size()), guess, 0);
  if (!at) return std::nullopt;
  auto point = point_of(*at);
  if (!point.view.outcome.complete()) return std::nullopt;
  point.p = p;
  return point;
}

std::optional<BranchPoint> Continuation::branch_off(const VectorXd& x, double p, const Direction& direction,
                                                    double step) {
  const Solution from{x, options_.parameter.coordinate(p)};
  Solution guess = from;
  guess.x += step * problem_.scale().cwiseProduct(direction.x);
  guess.c += step * direction.c;
  const auto at = correct(guess, direction, from, step);
  if (!at) return std::nullopt;
  auto point = point_of(*at);
  if (!point.view.outcome.complete()) return std::nullopt;
  return point;
}

namespace {
const Problem::Test* find(const Problem::View& view, const std::string& kind) {
  const auto found = std::ranges::find(view.tests, kind, &Problem::Test::kind);
  return found == view.tests.end() ? nullptr : &*found;
}
}  // namespace

/// Zeros of tests between two solutions, `length` apart along the direction. A sign counts where the error of the test
/// leaves no doubt about it.
void Continuation::find_special(Branch& branch, Signs& signs, const Solution& a, const BranchPoint& before,
                                const BranchPoint& after, const Direction& direction, double length) {
  std::vector<SpecialPoint> found;
  for (const auto& test : after.view.tests) {
    if (test.border) continue;
    const auto known = signs.find(test.kind);
    if (!std::isfinite(test.value)) {
      signs.erase(test.kind);
    } else if (test.has_sign()) {
      const bool positive = test.value > 0;
      if (known != signs.end() && known->second.positive != positive) {
        if (const auto& [was, open, spread] = known->second; open) {
          const auto& there = *find(open->view, test.kind);
          const double slope = std::abs((test.value - there.value) / (after.p - open->p));
          const double error = 3 * there.error / slope + spread + open->error;
          found.push_back({test.kind, open->p, error, open->x, open->view, 0, test.kind});
        } else if (auto special = locate(test.kind, a, before, after, direction, length)) {
          found.push_back(std::move(*special));
        }
      }
      signs.insert_or_assign(test.kind, Sign{positive, {}});
    } else if (known != signs.end()) {
      auto& [positive, open, spread] = known->second;
      if (open) spread += std::abs(after.p - before.p);
      if (!open || std::abs(test.value) < std::abs(find(open->view, test.kind)->value)) open = after;
    }
  }
  const double c = options_.parameter.coordinate(before.p);
  std::ranges::sort(found, {}, [&](const auto& f) { return std::abs(options_.parameter.coordinate(f.p) - c); });
  for (auto& special : found) {
    special.after = branch.points.size() - 1;
    branch.special.push_back(std::move(special));
  }
}

/// The zero of a test, by the Illinois method.
std::optional<SpecialPoint> Continuation::locate(const std::string& kind, const Solution& a, const BranchPoint& before,
                                                 const BranchPoint& after, const Direction& direction, double length) {
  const double c_after = options_.parameter.coordinate(after.p);
  const double at_before = find(before.view, kind)->value, at_after = find(after.view, kind)->value;
  Bracket bracket{0, length, at_before, at_after};
  std::optional<Solution> best;
  BranchPoint there;
  double moved = infinity, theta_before = infinity;
  constexpr int most = 30;
  constexpr double at_rest = 1e-12;
  for (int k = 0; k < most && bracket.width() > at_rest * length; ++k) {
    double l = bracket.secant();
    if (!bracket.holds(l)) l = 0.5 * (bracket.low + bracket.high);
    const auto solution_at = [&](double along) {
      Solution guess;
      guess.x = a.x + along / length * (after.x - a.x);
      guess.c = a.c + along / length * (c_after - a.c);
      return correct(guess, direction, a, along);
    };
    auto at = solution_at(l);
    // At the zero itself there may be no solution, as where stiffness vanishes.
    constexpr double aside = 1e-7;
    if (!at && !best) at = solution_at(l += aside * bracket.width());
    if (!at) break;
    auto point = point_of(*at);
    const auto* test = find(point.view, kind);
    if (!point.view.outcome.complete() || !test) break;
    if (best) moved = std::abs(at->c - best->c);
    best = at, there = std::move(point);
    const double value = test->value;
    if (value == 0 || std::abs(l - theta_before) < at_rest * length) break;
    theta_before = l;
    bracket.take(l, value);
  }
  if (!best) return std::nullopt;
  // What the tolerance leaves open of the test, by its slope along the branch.
  const double open = find(there.view, kind)->error * length / std::abs(at_after - at_before);
  const double per_length = std::abs(c_after - a.c) / length;
  constexpr double rounding = 4e-16;
  const double error = std::abs(options_.parameter.slope(best->c)) *
                           (std::min(moved, best->c_error) + best->c_error + open * per_length) +
                       rounding * std::abs(there.p);
  return SpecialPoint{kind, there.p, error, there.x, there.view, 0, kind};
}

/// Where the smallest of the border tests comes to 0 ahead of a solution, from this side alone.
std::optional<SpecialPoint> Continuation::approach_border(const Solution& from, const BranchPoint& before,
                                                          const Direction& direction, double length) {
  struct Seen {
    double l, value;
    Solution at;
  };
  std::optional<SpecialPoint> best;
  double least_change = infinity;
  for (const auto& [kind, first, open, border] : before.view.tests) {
    if (!border || !std::isfinite(first)) continue;
    std::vector<Seen> seen{{0, first, from}};
    double l = length, zero_before = infinity, c_zero = 0, change = infinity;
    double farthest = infinity;  // a length at which the motion was another
    constexpr int most = 60;
    constexpr double enough = 1e-13;
    for (int k = 0; k < most && change > enough; ++k) {
      Solution guess = seen.back().at;
      guess.x += (l - seen.back().l) * problem_.scale().cwiseProduct(direction.x);
      guess.c += (l - seen.back().l) * direction.c;
      if (seen.size() > 1) {
        const auto &a = seen[seen.size() - 2], &b = seen.back();
        const double ahead = (l - b.l) / (b.l - a.l);
        guess.x = b.at.x + ahead * (b.at.x - a.at.x), guess.c = b.at.c + ahead * (b.at.c - a.at.c);
      }
      const auto at = correct(guess, direction, from, l, false);
      std::optional<BranchPoint> point;
      if (at) point = point_of(*at);
      const auto* test = point ? find(point->view, kind) : nullptr;
      if (!test || point->view.pattern != before.view.pattern || !(test->value > 0)) {
        farthest = l;
        l = seen.back().l + 0.5 * (l - seen.back().l);
        if (l - seen.back().l < enough * length) break;
        continue;
      }
      seen.push_back({l, test->value, *at});
      const auto &a = seen[seen.size() - 2], &b = seen.back();
      if (!(b.value < a.value)) {
        if (seen.size() > 3) break;  // it does not come to 0
        l = b.l + (b.l - a.l);
        if (l >= farthest) break;
        continue;
      }
      const double zero = b.l + b.value * (b.l - a.l) / (a.value - b.value);
      c_zero = b.at.c + (zero - b.l) / (b.l - a.l) * (b.at.c - a.at.c);
      change = std::abs(c_zero - zero_before);
      zero_before = c_zero;
      constexpr double most_of_way = 0.95;
      l = std::min(b.l + most_of_way * (zero - b.l), std::isfinite(farthest) ? 0.5 * (b.l + farthest) : infinity);
      if (std::isfinite(farthest) && zero < farthest) l = b.l + most_of_way * (zero - b.l);
      if (l <= b.l * (1 + enough)) break;
    }
    constexpr double reached = 1e-2;
    if (seen.size() < 3 || seen.back().value > reached * first || !std::isfinite(zero_before)) continue;
    SpecialPoint special{.kind = kind,
                         .p = options_.parameter.value(c_zero),
                         .error = 0,
                         .x = seen.back().at.x,
                         .view = {},
                         .after = 0,
                         .test = kind};
    const auto &a = seen[seen.size() - 2], &b = seen.back();
    const double per_value = std::abs((b.at.c - a.at.c) / (b.value - a.value));
    if (best && change + b.at.c_error >= least_change) continue;  // the one that comes to 0 most surely
    least_change = change + b.at.c_error;
    special.error = std::abs(options_.parameter.slope(c_zero)) * (least_change + open * per_value);
    special.view = view_of(seen.back().at);  // just before
    best = std::move(special);
  }
  return best;
}

Branch Continuation::follow(const BranchPoint& start, int sign) {
  Direction along = parameter_alone(start.x.size());
  along.c = sign;
  return follow(start, along);
}

Branch Continuation::follow(const BranchPoint& start, Direction along) {
  Branch branch;
  try {
    follow_into(branch, start, std::move(along));
  } catch (const Stopped&) {
    branch.outcome = {Ending::interrupted, "interrupted"};
  } catch (const InputError& error) {
    branch.outcome = {Ending::none_exists, error.what()};
  }
  return branch;
}

void Continuation::follow_into(Branch& branch, const BranchPoint& start, Direction along) {
  branch.points.push_back(start);
  Solution now{start.x, options_.parameter.coordinate(start.p), start.x_error, 0, 0};
  double h = options_.first_step;
  Direction bend{VectorXd::Zero(start.x.size()), 0};
  Signs signs;
  const auto know_signs = [&](const BranchPoint& point) {
    signs.clear();
    for (const auto& test : point.view.tests)
      if (!test.border && test.has_sign()) signs.insert({test.kind, {test.value > 0, {}}});
  };
  know_signs(start);
  const auto end = [&](Ending ending, std::string why) { branch.outcome = {ending, std::move(why)}; };
  // At a border the branch leaves in another direction, from another motion.
  const auto go_beyond = [&](SpecialPoint special) {
    special.after = branch.points.size() - 1;
    branch.special.push_back(special);
    if (!cross) return false;
    auto beyond = cross(special);
    if (!beyond) return false;
    problem_.refer_to(beyond->x, beyond->p, options_.tolerance);
    const auto point = close(beyond->x, beyond->p);
    if (!point) return false;
    branch.points.push_back(*point);
    know_signs(*point);
    now = {point->x, options_.parameter.coordinate(point->p), point->x_error, 0, 0};
    bend = {VectorXd::Zero(now.x.size()), 0};
    along = parameter_alone(now.x.size());
    along.c = beyond->sign;
    h = options_.first_step;
    return !arrived || arrived(branch.points.back());
  };
  while (int(branch.points.size()) < options_.most_points) {
    const auto t = tangent(now, along);
    if (!t) return end(Ending::not_finite, "the branch has no direction here");
    const Direction direction = *t;
    const VectorXd size = problem_.scale();
    // A step ends at the end of the range.
    const double to_end = direction.c > 0   ? (1 - now.c) / direction.c
                          : direction.c < 0 ? -now.c / direction.c
                                            : infinity;
    std::optional<Solution> next;
    BranchPoint point;
    bool leaves = false;
    std::optional<SpecialPoint> border;
    double length = 0;
    for (h = std::min(h, options_.longest_step);; h *= 0.5) {
      if (h < least_step) {
        if (!border) border = approach_border(now, branch.points.back(), direction, options_.first_step);
        if (border && go_beyond(*border)) break;
        return border ? end(Ending::event, fmt::format("{}: the branch ends", border->kind))
                      : end(Ending::tolerance_not_met, "no solution follows, however near");
      }
      leaves = to_end <= h;
      length = std::min(h, std::max(to_end, 0.0));
      Solution guess = now;
      guess.x += length * size.cwiseProduct(direction.x + length * bend.x);
      guess.c += length * (direction.c + length * bend.c);
      next = leaves ? correct({guess.x, direction.c > 0 ? 1.0 : 0.0}, parameter_alone(guess.x.size()),
                              {guess.x, direction.c > 0 ? 1.0 : 0.0}, 0)
                    : correct(guess, direction, now, length);
      if (next) {
        const VectorXd d = (next->x - now.x).cwiseQuotient(size);
        const double norm = std::hypot(d.norm(), next->c - now.c),
                     cosine = (direction.x.dot(d) + direction.c * (next->c - now.c)) / norm;
        if (cosine < nearest_parallel || norm > 2 * length) next.reset();
      }
      if (next) {
        point = point_of(*next);
        if (!point.view.outcome.complete()) next.reset();
      }
      if (next && point.view.pattern == branch.points.back().view.pattern) break;
      // A border may stand between.
      constexpr double small = 0.1;
      if (!border && h < small * options_.longest_step)
        border = approach_border(now, branch.points.back(), direction, length);
      if (border && !next) {
        if (go_beyond(*border)) break;
        return end(Ending::event, fmt::format("{}: the branch ends", border->kind));
      }
      if (next && (border || h < small * options_.first_step)) break;
    }
    if (!next) continue;  // gone beyond a border
    if (point.view.pattern != branch.points.back().view.pattern) {
      if (border) {
        border->after = branch.points.size() - 1;
        branch.special.push_back(*border);
      }
      know_signs(point);
    } else {
      find_special(branch, signs, now, branch.points.back(), point, direction, length);
    }
    const Direction bent{((next->x - now.x).cwiseQuotient(size) - length * direction.x) / (length * length),
                         (next->c - now.c - length * direction.c) / (length * length)};
    for (const double wanted : options_.at) {
      const double c = options_.parameter.coordinate(wanted) - now.c;
      if (c * (options_.parameter.coordinate(wanted) - next->c) >= 0) continue;
      // c = l (t + l b), whose root is between the two points.
      const double root = std::sqrt(direction.c * direction.c + 4 * bent.c * c);
      const double nearer = 2 * c / (direction.c + std::copysign(root, direction.c)),
                   l = nearer >= 0 && nearer <= length ? nearer : length * c / (next->c - now.c);
      if (auto there = close(now.x + l * size.cwiseProduct(direction.x + l * bent.x), wanted)) {
        there->asked = true;
        branch.points.push_back(std::move(*there));
        if (arrived) arrived(branch.points.back());
      }
    }
    branch.points.push_back(point);
    const int iterations = next->iterations;
    now = *next;
    const VectorXd size_before = problem_.scale();
    const bool rewritten = problem_.refer_to(now.x, point.p, options_.tolerance);
    branch.points.back().x = now.x;
    if (arrived && !arrived(branch.points.back())) return end(Ending::event, "it ends in steady sliding");
    if (leaves) return end(Ending::reached_end, "");
    // The direction goes on in what the unknowns have in common, and in their new sizes.
    const Eigen::Index common = rewritten ? problem_.in_common() : now.x.size();
    const auto onwards = [&](const VectorXd& before) {
      VectorXd x = VectorXd::Zero(now.x.size());
      x.head(common) =
          before.head(common).cwiseProduct(size_before.head(common)).cwiseQuotient(problem_.scale().head(common));
      return x;
    };
    along = {onwards(direction.x), direction.c};
    bend = rewritten ? Direction{VectorXd::Zero(now.x.size()), 0} : Direction{onwards(bent.x), bent.c};
    constexpr int few = 4, many = 7;
    if (iterations <= few) h *= 1.5;
    if (iterations >= many) h *= 0.7;
  }
  return end(Ending::budget_spent, fmt::format("{} points", options_.most_points));
}

}  // namespace rosin::analysis::branches
