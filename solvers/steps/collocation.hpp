/// Five-stage Radau IIA collocation (order 9) for stiff systems M·ẏ = f with algebraic rows.
/// A one-step method keeps return maps smooth; a stiffly accurate one keeps its order in near-stick and on rigid
/// contacts.
/// Events and kinks of the system are located by solving the step again with a shorter length, at the full order of the
/// method.
#pragma once
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/bracket.hpp"
#include "core/error.hpp"
#include "core/system.hpp"
#include "solvers/steps/radau_tableau.hpp"
#include "solvers/steps/stage_algebra.hpp"

namespace rosin::solvers::steps {

class Collocation {
 public:
  static constexpr int stages = RadauTableau::stages;
  /// Smaller tolerances bring no more accuracy: the error estimate is then at 1e-12.
  static constexpr double least_tolerance = 1e-18;

  /// `tolerance`: requested relative accuracy of the solution, in units of the system's scale.
  /// \throws InputError for more than 64 unknowns of a system without a pattern, or of one with far couplings.
  Collocation(const System&, double tolerance);

  /// Begins at (t, y); Newton's method makes algebraic unknowns consistent.
  /// \returns false if that fails.
  bool start(double t, std::span<const double> y);
  /// Takes one step, not past `t_limit`. On anything but reached_end the state is unchanged.
  Outcome step(double t_limit);
  /// Bounds the length of steps; infinity lifts the bound. Below tolerances of 1e-6 the bound shrinks as steps do. If
  /// it alone set the length, two tolerances would take the same steps, and their difference would show no error.
  void bound_step(double longest) { longest_step_ = longest * bound_share_; }
  /// The first step after a start stays within the fastest time of the Jacobian. A weakly excited transient is then
  /// resolved, which a longer step would damp unnoticed. Without a transient this costs a few steps.
  void resolve_starts(bool yes = true) { resolve_starts_ = yes; }
  /// Shortens the last step to `theta` of its length (0 < theta <= 1), solved again at full order.
  bool shorten(double theta);

  double time() const { return t_; }
  double time_before() const { return t_before_; }
  const std::vector<double>& state() const { return y_; }
  const std::vector<double>& state_before() const { return y_before_; }
  /// Stage values of the last step, at time_before() + node·length.
  void stage(int i, double* y) const;
  double node(int i) const { return tableau_.c[i]; }
  double stage_time(int i) const { return node_time(t_before_, tableau_.c[i] * h_last_); }
  double time_at(double theta) const { return theta >= 1 ? t_ : node_time(t_before_, theta * h_last_); }
  /// Length of the last step; time() − time_before() to within rounding error of the time.
  double length() const { return h_last_; }
  /// The collocation polynomial of the last step, at time_before() + theta·length (order 5).
  void interpolate(double theta, double* y) const;
  /// The solution at time_before() + theta·length at the full order, by a step of that length from the last start.
  /// \returns false if that step cannot be solved; y is then the value of the collocation polynomial.
  bool solve_at(double theta, double* y);

  /// The part θ of the last step at which f(t, y) changes sign, given brackets in θ and the values there; solved at the
  /// full order by the Illinois method to rounding. Nothing if a step cannot be solved.
  template <class F>
  std::optional<double> locate(F f, double low, double high, double f_low, double f_high);

  /// ∂f/∂p at (t, y), size × columns, row-major.
  using Forcing = std::function<void(double t, const double* y, double* f_p)>;
  /// Propagates the columns of S (size × columns, row-major, differential unknowns) across the last step: multiplies
  /// them by the derivative of the step with respect to its start, and adds the derivative with respect to each
  /// column's parameter p.
  /// \throws InputError for more than 64 unknowns.
  void propagate(std::vector<double>& S, int columns, const Forcing& forcing = {});
  /// Derivative of the solution in time at the end of the last step, algebraic unknowns included.
  void rate(double* rate) const;

  /// Upper bound, for each unknown, of the errors by oscillations that steps passed over, summed since construction.
  /// Each error is within the tolerance. The difference of two tolerances does not show them, because a long step damps
  /// such an oscillation at either.
  std::span<const double> ringing_errors() const { return algebra_->passed_over(); }

  struct Count {
    long steps = 0, rejected = 0, evaluations = 0, linearisations = 0, factorisations = 0;
  };
  const Count& count() const { return count_; }

 private:
  /// t + dt, kept before the limit of the step, where the drive may jump.
  double node_time(double t, double dt) const { return std::min(t + dt, last_moment_); }
  /// `rounded`: converged to within rounding error of the forces.
  enum class Newton { converged, rounded, slow, not_finite };
  /// Solves the algebraic rows for the algebraic unknowns of y_. \returns false where that fails.
  bool make_consistent();
  void search_for_corner();
  bool end_at_kink();
  double error_beside_kink(double h, double ahead) const;
  double time_to_kink(double h);
  void advance_time();
  double resolved_growth(double h) const;
  double within_growth(double h);
  Newton solve_stages(double t, const double* y0, double h, int most_iterations, bool to_rounding = false);
  double estimate_error(double t, const double* y0, double h, bool refine);
  double rounding_of_row(int row) const;
  double rounding_error();
  double beyond_rounding(const std::vector<double>& estimate);
  double norm(const double* v) const;
  double first_step(double t_limit);

  const System& system_;
  const RadauTableau& tableau_;
  int n_;
  double tolerance_, estimate_tolerance_;
  std::unique_ptr<StageAlgebra> algebra_;
  double most_rounding_;  ///< largest accepted rounding error of an unknown, in scales
  double longest_step_ = infinity, bound_share_;
  double last_moment_ = infinity;  ///< the last time before the limit of the last step
  double t_ = 0, t_before_ = 0, h_next_ = 0, h_last_ = 0, error_last_ = 0;
  bool resolve_starts_ = false;
  bool has_kinks_ = false;         ///< the system has kinks
  std::vector<double> kinks_;      ///< scratch
  std::vector<double> kink_side_;  ///< sign of each kink's function on the side of y_; 0: the next step decides
  double since_kink_ = infinity;   ///< s, from the last singular kink; infinite where the system has none
  double estimate_ = 0;            ///< the last estimate of an error, in scales
  int pieces_ = 0;                 ///< steps that ended short of the kink ahead
  bool ended_at_kink_ = false;     ///< the last step ended at a kink
  bool fresh_ = true;              ///< no polynomial of an earlier step to extrapolate
  double time_carry_ = 0, time_carry_before_ = 0;  ///< rounding error of t_ and t_before_ (compensated sum)
  std::vector<double>
      carry_;  ///< rounding error of y_ (compensated sum), without which a slowly rising load would stand still
  std::vector<double> y_, y_before_, f0_, mass_, scale_, Z_, Z_trial_, residual_, stage_mass_, work_;
  std::vector<double> real_right_;
  std::vector<std::complex<double>> pair_right_[2];
  std::vector<double> big_, big_right_, f_stage_, J_stage_;
  std::vector<int> big_pivot_;
  int iterations_ = 0;    ///< iterations of the last Newton solution
  bool rounded_ = false;  ///< the last step converged to rounding error of the forces only
  int rejections_ = 0;    ///< attempts since the last step that succeeded at once
  Count count_;
};

template <class F>
std::optional<double> Collocation::locate(F f, double low, double high, double f_low, double f_high) {
  std::vector<double> y(n_);
  Bracket bracket{low, high, f_low, f_high};
  double theta = high;
  for (int iteration = 0; iteration < 100 && bracket.width() > 2e-16; ++iteration) {
    theta = bracket.secant();
    if (!bracket.holds(theta)) theta = 0.5 * (bracket.low + bracket.high);
    if (!bracket.holds(theta)) break;
    if (!solve_at(theta, y.data())) return std::nullopt;
    const double value = f(time_at(theta), y.data());
    if (value == 0) break;
    if (!std::isfinite(value)) return std::nullopt;
    const double end = (value > 0) == (bracket.f_high > 0) ? bracket.high : bracket.low;
    if (std::abs(end - theta) < 1e-15) break;
    bracket.take(theta, value);
  }
  return theta;
}

}  // namespace rosin::solvers::steps
