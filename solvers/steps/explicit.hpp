/// Explicit steps for motions that are not stiff in their unknowns, over many decades of time: Gauss collocation of
/// order 16, its eight stages in parallel in the lanes of a pack, by fixed-point iteration of the stages (after van der
/// Houwen & Sommeijer 1990).
/// The system is a set of ordinary differential equations (`System::flow`) in its own pace, with time as one more
/// unknown:
///   dy/ds = (dy/dt)/p,  dt/ds = 1/p,  p(t, y) the pace of the system (after Sundman).
/// Where rates change by decades but logarithms evenly, as in a stick-slip cycle, steps in s are few and nearly equal.
/// Near the limit of a step, and where the system has no pace of its own, s is time.
#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "core/error.hpp"
#include "core/parameters.hpp"
#include "core/system.hpp"
#include "solvers/steps/gauss_tableau.hpp"

namespace rosin::solvers::steps {

class Explicit {
 public:
  static constexpr double least_tolerance = 1e-14;  ///< smaller tolerances count as this one
  /// The system must have a flow and must outlive this. `tolerance`: local error in units of the system's scale.
  Explicit(const System&, double tolerance);

  /// Begins at (t, y), y consistent.
  void start(double t, std::span<const double> y);
  /// Takes one step, not past `t_limit`. On anything but reached_end the state is unchanged.
  Outcome step(double t_limit);
  /// True once convergence rather than accuracy has limited 15 steps: an implicit method is then faster.
  bool stiff() const { return stiff_steps_ >= enough_stiff_steps; }

  double time() const { return t_; }
  double time_before() const { return t_before_; }
  std::span<const double> state() const { return {y_.data(), std::size_t(n_)}; }
  std::span<const double> state_before() const { return {y_before_.data(), std::size_t(n_)}; }
  /// The solution at time t inside the last step, as accurate as at its end.
  void interpolate(double t, double* y);
  /// The same by the polynomial of the last step (order 8), in a fraction of the time.
  void approximate(double t, double* y);
  /// The times of the stages of the last step, in its pace.
  std::array<double, GaussTableau::stages> inner_times() const;

  struct Count {
    long steps = 0, rejected = 0, evaluations = 0;  ///< one evaluation is of eight states at once
  };
  const Count& count() const { return count_; }

 private:
  static constexpr int stages = GaussTableau::stages;
  static constexpr int enough_stiff_steps = 15;
  enum class Clock { pace, time };
  enum class Iteration { converged, slow, not_finite };

  double node_time(double t) const { return std::min(t, last_moment_); }
  /// Rates dy/dt at the stages, and their pace.
  void evaluate(double t, Pack* f);
  /// One iteration from slopes f, or from rates with their pace, which become slopes, to the stages y + h A f. \returns
  /// the change of the stages.
  double sweep(Pack* f, bool rates);
  /// Iterates the stages of a step of length h from (t, y) to convergence, starting with the slopes f.
  Iteration iterate(double t, const double* y, double h, Pack* f);
  /// Slopes of the last step's polynomial at the nodes of a step that begins at the part `from` of it and is `ratio`
  /// times as long.
  void extrapolate(double from, double ratio, Pack* f) const;
  /// y + h ∫ f.
  void advance(const double* y, double h, const Pack* f, double* to) const;
  /// Error of a step with slopes f, in units of the tolerance.
  double estimate_error(const Pack* f, double h);
  /// Computes the slope at the present state.
  void begin();
  double first_step(double t_limit) const;
  void set_clock(Clock);
  Outcome not_finite() const;
  /// The part θ of the last step at time t, from its polynomial.
  double part_of_step(double t) const;

  const System& system_;
  const GaussTableau& tableau_;
  int n_;  ///< number of unknowns; index n holds the time since the start of the step
  double tolerance_, goal_ = 0;
  double t_ = 0, t_carry_ = 0;  ///< time, and its rounding error (compensated sum)
  double t_before_ = 0, h_next_ = 0, h_last_ = 0, last_moment_ = infinity;
  Clock clock_ = Clock::pace, clock_last_ = Clock::pace;
  bool fresh_ = true;                               ///< no polynomial of an earlier step in the same clock
  double start_dt_ = 1;                             ///< dt/ds at the present state
  double contraction_ = 1, contraction_per_h_ = 0;  ///< factor on the errors of the stages in one sweep; 0: not known
  double change_ = 0;                               ///< change of the unknowns in the last step, in scales
  int stiff_steps_ = 0, easy_steps_ = 0;
  std::vector<double> y_, y_before_, y_trial_, scale_, start_slope_;
  Pack pace_ = 1.0, length_ = 0.0;  ///< pace at the stages; length of the iterated step
  std::vector<Pack> weight_, from_, stages_, rates_, slopes_, slopes_trial_;
  Count count_;
};

}  // namespace rosin::solvers::steps
