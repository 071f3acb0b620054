/// Newton's method on the rows of contacts.
#include "analysis/motion/row_solver.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rosin::analysis::motion {

using Eigen::MatrixXd, Eigen::VectorXd;
using oscillators::StationForces;

RowSolver::RowSolver(const StationForces& contacts, MatrixXd G, double by_place, double by_rate)
    : contacts_(contacts), G_(std::move(G)), size_(G_.cwiseAbs()), by_place_(by_place), by_rate_(by_rate) {}

Outcome RowSolver::solve(double t, VectorXd& x, StationForces::Forces& forces) {
  constexpr int most_iterations = 60;
  constexpr double accuracy = 1e-12, rounding = 1e-14, least_part = 1e-4;
  const double without = free.cwiseAbs().maxCoeff();
  evaluate(t, x, forces, residual_);
  for (int iteration = 0;; ++iteration) {
    const double size = residual_.cwiseAbs().maxCoeff(), known = x.cwiseAbs().maxCoeff() + without;
    if (size <= accuracy * known) return {};
    const double terms = known + (size_ * forces.value.cwiseAbs()).maxCoeff();
    if (size <= rounding * terms) return {};
    if (iteration == most_iterations || !std::isfinite(size))
      return {
          std::isfinite(size) ? Ending::tolerance_not_met : Ending::not_finite,
          fmt::format("Newton's method did not solve the step to t = {:.9g} s; give a shorter one (solver.step)", t)};
    ++iterations_;
    find_change(forces);
    // Slopes jump where a station opens or begins to slip: a shorter change then goes further.
    const double norm = residual_.norm();
    for (double part = 1;; part /= 2) {
      next_ = x + part * change_;
      evaluate(t, next_, forces, next_residual_);
      if (next_residual_.norm() < norm || part < least_part) break;
    }
    const bool stalls = next_residual_.norm() >= norm;
    x.swap(next_), residual_.swap(next_residual_);
    if (stalls && size <= 1e3 * rounding * terms) return {};
  }
}

void RowSolver::evaluate(double t, const VectorXd& x, StationForces::Forces& forces, VectorXd& residual) {
  at_place_ = place + by_place_ * x, at_rate_ = rate + by_rate_ * x;
  contacts_.evaluate(t, at_place_, at_rate_, forces);
  residual = x - free;
  residual.noalias() -= G_ * forces.value;
}

/// The change of x by (1 − G D) change = −r, where the slopes D of forces have columns of their own: friction that
/// slides answers to no acceleration along the surface, and an open station to none, so that fewer are solved for.
void RowSolver::find_change(const StationForces::Forces& forces) {
  felt_.clear();
  columns_.resize(G_.rows(), G_.cols());
  const auto slope = [&](int i, int k) { return by_place_ * forces.by_place(i, k) + by_rate_ * forces.by_rate(i, k); };
  for (const auto& [slip, first, stations, area] : contacts_.contacts()) {
    if (const double own = slope(slip, slip); own != 0) {
      columns_.col(Eigen::Index(felt_.size())) = own * G_.col(slip);
      felt_.push_back(slip);
    }
    for (int s = first; s < first + stations; ++s) {
      const double own = slope(s, s), friction = slope(slip, s);
      if (own == 0 && friction == 0) continue;
      columns_.col(Eigen::Index(felt_.size())) = own * G_.col(s) + friction * G_.col(slip);
      felt_.push_back(s);
    }
  }
  change_ = -residual_;
  const auto count = Eigen::Index(felt_.size());
  if (count == 0) return;
  few_.resize(count, count), of_few_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int row = felt_[std::size_t(i)];
    few_.row(i) = -columns_.row(row).head(count);
    few_(i, i) += 1;
    of_few_[i] = -residual_[row];
  }
  few_lu_.compute(few_);
  of_few_ = few_lu_.solve(of_few_).eval();
  change_.noalias() += columns_.leftCols(count) * of_few_;
}

}  // namespace rosin::analysis::motion
