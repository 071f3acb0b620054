/// Explicit Runge-Kutta steps of order 8 (Dormand & Prince), taken in the system's own pace: for motions that are not
/// stiff in their unknowns, however many decades of time they span.
///
/// The system is followed as ordinary differential equations (`System::flow`), with time as one more unknown:
///   dy/ds = (dy/dt)/p,  dt/ds = 1/p,  p(t, y) the pace of the system (after Sundman).
/// Where rates change by decades but logarithms evenly, as in a stick-slip cycle, steps in s are few and alike. Near
/// the limit of a step, and where the system has no pace of its own, s is time.
#pragma once
#include <span>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/system.hpp"
#include "solvers/explicit_tableau.hpp"

namespace rosin::solvers {

class Explicit {
 public:
  static constexpr double least_tolerance = 1e-14;  ///< smaller ones are taken for this
  /// The system must have a flow and must outlive this. `tolerance`: local error in units of the system's scale.
  Explicit(const System&, double tolerance);

  /// Begins at (t, y), y consistent.
  void start(double t, std::span<const double> y);
  /// Takes one step, not past `t_limit`. On anything but reached_end the state is unchanged.
  Outcome step(double t_limit);
  /// True once stability rather than accuracy has held the steps for a while: an implicit method will do better.
  bool stiff() const { return stiff_steps_ >= enough_stiff_steps; }

  double time() const { return t_; }
  double time_before() const { return t_before_; }
  std::span<const double> state() const { return {y_.data(), std::size_t(n_)}; }
  std::span<const double> state_before() const { return {y_before_.data(), std::size_t(n_)}; }
  /// The solution at time t inside the last step (order 7).
  void interpolate(double t, double* y);

  struct Count {
    long steps = 0, rejected = 0, evaluations = 0;
  };
  const Count& count() const { return count_; }

 private:
  using Tableau = ExplicitTableau;
  static constexpr int enough_stiff_steps = 15;
  enum class Clock { pace, time };

  /// Four unknowns at a time: vectors are padded with zeros to whole blocks.
  using Block [[gnu::vector_size(32)]] = double;
  double* slope(int stage) { return reinterpret_cast<double*>(slopes_.data() + stage * blocks_); }
  /// dy/ds, and behind it dt/ds, at time t; false if not finite.
  bool evaluate(double t, const double* y, double* slope);
  template <int stage>
  void combine(double h, double* to) const;
  template <int... stage>
  bool stages(double h, std::integer_sequence<int, stage...>);
  double node_time(double t) const { return std::min(t, last_moment_); }
  double estimate_error(double h);
  void watch_stiffness(double h);
  double first_step(double t_limit);
  void set_clock(Clock);
  Outcome not_finite();
  void prepare_dense();
  /// Unknown i, or time since the start of the step (i = n), at the part theta of the last step.
  double dense(double theta, int i) const;

  const System& system_;
  int n_;       ///< unknowns
  int blocks_;  ///< that hold the unknowns and time
  double tolerance_;
  double t_ = 0, t_low_ = 0;  ///< time, and what rounding has kept from it
  double t_before_ = 0, h_next_ = 0, h_last_ = 0, last_moment_ = infinity;
  Clock clock_ = Clock::pace;
  bool known_ = false;  ///< slope(0) belongs to the present state
  bool dense_known_ = false;
  int stiff_steps_ = 0, easy_steps_ = 0;
  std::vector<double> y_, y_before_, y_trial_, scale_, weight_, work_, dense_;
  std::vector<Block> slopes_;
  Count count_;
};

}  // namespace rosin::solvers
