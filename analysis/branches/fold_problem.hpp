/// Folds of cycles in two parameters as solutions of one problem, which is regular where two curves of folds meet.
#pragma once
#include "analysis/branches/cycle_problem.hpp"
#include "analysis/branches/locus.hpp"

namespace rosin::analysis::branches {

/// A cycle, F(x, p, q) = 0, of which a multiplier is 1: F_x is singular. In its place stands g = 0, where
/// F_x v + b g = 0 and cᵀv = 1 with vectors b and c near the null vectors (Govaerts 2000, Numerical Methods for
/// Bifurcations of Dynamical Equilibria, chapter 3). Unknowns: q, as its scale has it, then those of the cycle. The
/// test "cusp" is the curvature of the branch at its fold, over lengths in sizes of the cycle and across the curve
/// of folds in the plane of both parameters' coordinates.
class FoldProblem final : public Problem {
 public:
  /// \param turns  periods of the drive in a period
  FoldProblem(const Family2& family, const ParameterScale& p, const ParameterScale& q, int turns)
      : family_(family),
        p_scale_(p),
        q_scale_(q),
        cycle_([this](double at) { return family_(at, q_scale_.value(c_q_)); }, turns) {}
  FoldProblem(const FoldProblem&) = delete;
  FoldProblem& operator=(const FoldProblem&) = delete;

  /// Near a fold, whose cycle starts at y. \returns the unknowns; empty: its equations have no slopes there
  std::optional<Eigen::VectorXd> begin(const std::vector<double>& y, double period, double p, double q,
                                       double tolerance);

  Residual residual(const Eigen::VectorXd& x, double p, double tolerance, bool slopes) override;
  const Eigen::VectorXd& scale() const override { return scale_; }
  View view(const Solved&, const Solved& looser) override;
  bool refer_to(Eigen::VectorXd& x, double p, double tolerance) override;
  int in_common() const override { return 1 + cycle_.in_common(); }

  static constexpr const char* cusp = "cusp";

 private:
  /// F_x in sizes, bordered: its null vectors to both sides where g = 0.
  struct Bordered {
    Eigen::VectorXd v, w;
    double g;
  };
  std::optional<Bordered> solve(const Residual&) const;
  Residual cycle_at(const Eigen::VectorXd& y, double p, double c_q, double tolerance, bool slopes);
  /// wᵀ F by the coordinates of both parameters: across the curve of folds.
  Eigen::Vector2d normal(const Residual&, const Eigen::VectorXd& y, double p, const Eigen::VectorXd& w,
                         double tolerance);
  struct Curvature {
    double value = NAN, error = 0;
  };
  Curvature curvature(const Solved&);
  bool renew_borders(const Eigen::VectorXd& y, double p, double tolerance);
  void renew_scale();

  const Family2& family_;
  ParameterScale p_scale_, q_scale_;
  double c_q_ = NAN;  ///< of the oscillators that the cycle's problem asks for
  CycleProblem cycle_;
  Eigen::VectorXd b_, c_, scale_;
  std::optional<Eigen::Vector2d> normal_;  ///< at the point that the borders are those of
};

}  // namespace rosin::analysis::branches
