/// Steps without linear algebra for motions that are not stiff in their unknowns, however many decades of time they
/// span: Gauss collocation of order 16, its eight stages side by side in the lanes of a pack, iterated by inserting one
/// approximation of the stages into the next (after van der Houwen & Sommeijer 1990).
///
/// The system is followed as ordinary differential equations (`System::flow`) in its own pace, with time as one more
/// unknown:
///   dy/ds = (dy/dt)/p,  dt/ds = 1/p,  p(t, y) the pace of the system (after Sundman).
/// Where rates change by decades but logarithms evenly, as in a stick-slip cycle, steps in s are few and alike. Near
/// the limit of a step, and where the system has no pace of its own, s is time.
#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "core/error.hpp"
#include "core/parameters.hpp"
#include "core/system.hpp"
#include "solvers/steps/gauss_tableau.hpp"

namespace rosin::solvers::steps {

class Explicit {
 public:
  static constexpr double least_tolerance = 1e-14;  ///< smaller ones are taken for this
  /// The system must have a flow and must outlive this. `tolerance`: local error in units of the system's scale.
  Explicit(const System&, double tolerance);

  /// Begins at (t, y), y consistent.
  void start(double t, std::span<const double> y);
  /// Takes one step, not past `t_limit`. On anything but reached_end the state is unchanged.
  Outcome step(double t_limit);
  /// True once convergence rather than accuracy has held the steps for a while: an implicit method will do better.
  bool stiff() const { return stiff_steps_ >= enough_stiff_steps; }

  double time() const { return t_; }
  double time_before() const { return t_before_; }
  std::span<const double> state() const { return {y_.data(), std::size_t(n_)}; }
  std::span<const double> state_before() const { return {y_before_.data(), std::size_t(n_)}; }
  /// The solution at time t inside the last step, as accurate as at its end.
  void interpolate(double t, double* y);

  struct Count {
    long steps = 0, rejected = 0, evaluations = 0;  ///< evaluations: of eight states at once
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
  /// From slopes f, or rates with their pace, which become slopes, to the stages y + h A f. \returns how far they move.
  double sweep(Pack* f, bool rates);
  /// Iterates the stages of a step of length h from (t, y) to convergence, beginning with their slopes f.
  Iteration iterate(double t, const double* y, double h, Pack* f);
  /// Slopes of the last step's polynomial at the nodes of a step that begins at the part `from` of it and is `ratio`
  /// times as long.
  void extrapolate(double from, double ratio, Pack* f) const;
  /// y + h ∫ f.
  void advance(const double* y, double h, const Pack* f, double* to) const;
  /// Of a step with slopes f, in units of the tolerance.
  double estimate_error(const Pack* f, double h);
  /// The slope at the present state.
  void begin();
  double first_step(double t_limit) const;
  void set_clock(Clock);
  Outcome not_finite() const;
  /// The part of the last step at which time is t, by its polynomial.
  double part_of_step(double t) const;

  const System& system_;
  const GaussTableau& tableau_;
  int n_;  ///< unknowns; behind them, at n, goes time since the start of the step
  double tolerance_, goal_ = 0;
  double t_ = 0, t_low_ = 0;  ///< time, and what rounding has kept from it
  double t_before_ = 0, h_next_ = 0, h_last_ = 0, last_moment_ = infinity;
  Clock clock_ = Clock::pace, clock_last_ = Clock::pace;
  bool fresh_ = true;                               ///< no polynomial of a step before, in the same clock
  double start_dt_ = 1;                             ///< dt/ds at the present state
  double contraction_ = 1, contraction_per_h_ = 0;  ///< of the errors of the stages in one sweep; 0: not known
  double change_ = 0;                               ///< of the unknowns in the last step, in scales
  int stiff_steps_ = 0, easy_steps_ = 0;
  std::vector<double> y_, y_before_, y_trial_, scale_, start_slope_;
  Pack pace_ = 1.0, length_ = 0.0;  ///< at the stages; of the step that is iterated
  std::vector<Pack> weight_, from_, stages_, rates_, slopes_, slopes_trial_;
  Count count_;
};

}  // namespace rosin::solvers::steps
