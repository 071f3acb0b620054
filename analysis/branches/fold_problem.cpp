/// Slopes of the fold's condition by differences of the cycle's slopes along its null vector: second derivatives are
/// symmetric, so that two of them serve for all unknowns.
#include "analysis/branches/fold_problem.hpp"

#include "core/linear_solve.hpp"

namespace rosin::analysis::branches {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd, Eigen::Vector2d;

namespace {

constexpr double along_cycle = 2e-3;      ///< differences along the null vector, in sizes of the cycle
constexpr double along_parameter = 1e-4;  ///< of the second parameter's range

bool has_slopes(const Problem::Residual& found) {
  return found.outcome.complete() && found.F.allFinite() && found.F_x.allFinite() && found.F_p.allFinite();
}

}  // namespace

Problem::Residual FoldProblem::cycle_at(const VectorXd& y, double p, double c_q, double tolerance, bool slopes) {
  if (c_q != c_q_) c_q_ = c_q, cycle_.forget_oscillator();
  return cycle_.residual(y, p, tolerance, slopes);
}

void FoldProblem::renew_scale() {
  scale_.resize(1 + cycle_.scale().size());
  scale_ << 1, cycle_.scale();
}

std::optional<VectorXd> FoldProblem::begin(const std::vector<double>& y, double period, double p, double q,
                                           double tolerance) {
  c_q_ = q_scale_.coordinate(q);
  const VectorXd cycle = cycle_.begin(y, period, p);
  renew_scale();
  const auto found = cycle_at(cycle, p, c_q_, tolerance, true);
  if (!has_slopes(found) || !(found.F_p.norm() > 0)) return std::nullopt;
  b_ = found.F_p.normalized(), c_ = VectorXd::Ones(cycle.size()).normalized();
  normal_.reset();
  constexpr int enough = 3;  // of inverse iteration
  for (int k = 0; k < enough; ++k)
    if (!renew_borders(cycle, p, tolerance)) return std::nullopt;
  VectorXd x(scale_.size());
  x << c_q_, cycle;
  return x;
}

std::optional<FoldProblem::Bordered> FoldProblem::solve(const Residual& found) const {
  const Index n = b_.size();
  MatrixXd M = MatrixXd::Zero(n + 1, n + 1);
  M.topLeftCorner(n, n) = found.F_x * cycle_.scale().asDiagonal();
  M.topRightCorner(n, 1) = b_;
  M.bottomLeftCorner(1, n) = c_.transpose();
  const VectorXd right = solve_linear(M, VectorXd::Unit(n + 1, n));
  const VectorXd left = solve_linear(M.transpose(), VectorXd::Unit(n + 1, n));
  if (!right.allFinite() || !left.allFinite()) return std::nullopt;
  return Bordered{right.head(n), left.head(n), right[n]};
}

Vector2d FoldProblem::normal(const Residual& found, const VectorXd& y, double p, const VectorXd& w, double tolerance) {
  const double c_q = c_q_;
  const VectorXd above = cycle_at(y, p, c_q + along_parameter, tolerance, false).F,
                 below = cycle_at(y, p, c_q - along_parameter, tolerance, false).F;
  if (above.size() != w.size() || below.size() != w.size()) return Vector2d::Constant(NAN);
  return {w.dot(found.F_p) * p_scale_.slope(p_scale_.coordinate(p)), w.dot(above - below) / (2 * along_parameter)};
}

bool FoldProblem::renew_borders(const VectorXd& y, double p, double tolerance) {
  const double c_q = c_q_;
  const auto found = cycle_at(y, p, c_q, tolerance, true);
  if (!has_slopes(found)) return false;
  const auto null = solve(found);
  if (!null) return false;
  VectorXd w = null->w.normalized();
  Vector2d across = normal(found, y, p, w, tolerance);
  if (!across.allFinite()) return false;
  // Along the curve the normal turns little, so that curvatures keep the meaning of their sign.
  if (normal_ && across.dot(*normal_) < 0) w *= -1, across *= -1;
  b_ = w, c_ = null->v.normalized(), normal_ = across;
  return true;
}

Problem::Residual FoldProblem::residual(const VectorXd& x, double p, double tolerance, bool slopes) {
  const Index n = x.size() - 1;
  const double c_q = x[0];
  const VectorXd y = x.tail(n);
  const auto here = cycle_at(y, p, c_q, tolerance, true);
  Residual result;
  result.outcome = here.outcome;
  if (!has_slopes(here)) {
    if (result.outcome.complete()) result.outcome = {Ending::not_finite, "the slopes of a cycle"};
    return result;
  }
  const auto null = solve(here);
  if (!null) {
    result.outcome = {Ending::not_finite, "the null vector of a fold"};
    return result;
  }
  result.F.resize(n + 1);
  result.F << null->g, here.F;
  if (!slopes) return result;
  const VectorXd v = cycle_.scale().cwiseProduct(null->v);
  const auto ahead = cycle_at(y + along_cycle * v, p, c_q, tolerance, true),
             behind = cycle_at(y - along_cycle * v, p, c_q, tolerance, true),
             above = cycle_at(y, p, c_q + along_parameter, tolerance, true),
             below = cycle_at(y, p, c_q - along_parameter, tolerance, true);
  for (const auto* beside : {&ahead, &behind, &above, &below})
    if (!has_slopes(*beside)) {
      result.outcome = {Ending::not_finite, "the slopes beside a fold"};
      return result;
    }
  result.F_x.resize(n + 1, n + 1), result.F_p.resize(n + 1);
  result.F_x(0, 0) = -null->w.dot((above.F_x - below.F_x) * v) / (2 * along_parameter);
  result.F_x.row(0).tail(n) = -(ahead.F_x - behind.F_x).transpose() * null->w / (2 * along_cycle);
  result.F_p[0] = -null->w.dot(ahead.F_p - behind.F_p) / (2 * along_cycle);
  result.F_x.col(0).tail(n) = (above.F - below.F) / (2 * along_parameter);
  result.F_x.bottomRightCorner(n, n) = here.F_x;
  result.F_p.tail(n) = here.F_p;
  return result;
}

/// By two differences, of which the wider tells the error of both.
FoldProblem::Curvature FoldProblem::curvature(const Solved& at) {
  const auto& [x, p, tolerance] = at;
  const VectorXd y = x.tail(x.size() - 1);
  const auto here = cycle_at(y, p, x[0], tolerance, true);
  if (!has_slopes(here)) return {};
  const auto null = solve(here);
  if (!null) return {};
  const double across = normal(here, y, p, null->w, tolerance).norm();
  const VectorXd unit = null->v.normalized(), v = cycle_.scale().cwiseProduct(unit);
  const auto difference = [&](double step) -> double {
    const auto ahead = cycle_at(y + step * v, p, x[0], tolerance, true),
               behind = cycle_at(y - step * v, p, x[0], tolerance, true);
    if (!has_slopes(ahead) || !has_slopes(behind)) return NAN;
    return null->w.dot((ahead.F_x - behind.F_x) * v) / (2 * step * across);
  };
  const double narrow = difference(along_cycle), wide = difference(2 * along_cycle);
  return {(4 * narrow - wide) / 3, std::abs(narrow - wide) / 3};
}

Problem::View FoldProblem::view(const Solved& at, const Solved& looser) {
  const auto of_cycle = [](const VectorXd& x) { return VectorXd(x.tail(x.size() - 1)); };
  if (c_q_ != at.x[0]) c_q_ = at.x[0], cycle_.forget_oscillator();
  const VectorXd y = of_cycle(at.x), looser_y = of_cycle(looser.x);
  View view = cycle_.view({y, at.p, at.tolerance}, {looser_y, looser.p, looser.tolerance});
  if (!view.outcome.complete()) return view;
  const auto here = curvature(at), rough = curvature(looser);
  view.tests = {{cusp, here.value, here.error + std::abs(here.value - rough.value)}};
  return view;
}

bool FoldProblem::refer_to(VectorXd& x, double p, double tolerance) {
  if (c_q_ != x[0]) c_q_ = x[0], cycle_.forget_oscillator();
  VectorXd y = x.tail(x.size() - 1);
  const bool rewritten = cycle_.refer_to(y, p, tolerance);
  if (rewritten) {
    x.conservativeResize(1 + y.size());
    x.tail(y.size()) = y;
    const auto found = cycle_at(y, p, x[0], tolerance, true);
    if (has_slopes(found)) b_ = found.F_p.normalized();
    c_ = VectorXd::Ones(y.size()).normalized();
  }
  renew_scale();
  const int times = rewritten ? 3 : 1;
  for (int k = 0; k < times; ++k) renew_borders(y, p, tolerance);
  return rewritten;
}

}  // namespace rosin::analysis::branches
