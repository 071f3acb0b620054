/// The return map of the section v = V (v rising), with its derivative.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/slip_record.hpp"
#include "analysis/motion/reversal_steps.hpp"
#include "oscillators/slider_system.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::cycles {

/// Normal load over the largest spring force of a free oscillation as fast as the drive; infinite without mass.
double friction_over_swing(const Model&);
constexpr double weak_friction =
    0.1;  ///< friction_over_swing below which one period may not show the effect of friction

/// The derivative that a return propagates. With `across_motion` its eigenvalues are accurate to rounding error: steps
/// end where slip reverses, where the rates of states have kinks, and the component along the motion, a mere shift in
/// time, is removed after every step, so that its rounding error does not add.
enum class Derivative { none, of_steps, across_motion };

/// Section-to-section map of a slider with a smooth law under a constant drive with V > 0.
class ReturnMap {
 public:
  explicit ReturnMap(const Model&);
  ReturnMap(const ReturnMap&) = delete;

  struct Return {
    Outcome outcome;
    double duration = 0;
    std::vector<double> end;      ///< unknowns at the section
    double amplitude = 0;         ///< largest |v − V|/V seen
    Eigen::MatrixXd derivative;   ///< derivative of the differential unknowns, if requested
    std::vector<double> ringing;  ///< amplitude for each unknown, from Collocation::ringing_errors()
  };
  /// Follows the motion from y through `returns` returns. `from_section`: y lies on the section. Motion less than
  /// `dip`·V below V has not left the section, because after a slip at 10¹⁰ V rounding error alone crosses it again.
  Return follow(const std::vector<double>& y, double tolerance, int returns, bool from_section,
                Derivative derivative = Derivative::none, StepObserver* observer = nullptr, double dip = least_dip);
  static constexpr double least_dip = 1e-10;
  static constexpr long most_steps = 120'000;
  /// A return that takes more steps ends with its budget spent.
  void allow(long steps) { allowed_ = steps; }

  const oscillators::SliderSystem& system() const { return system_; }
  /// Unknowns with the slider almost stuck (slip rate 1e-3 V) and the state of steady sliding at `aged_at`.
  std::vector<double> stick(double aged_at) const;
  /// Length of a step of the differential unknowns, in units of the system's scale.
  double length(const Eigen::VectorXd& step) const { return (step.array() / scale_.array()).matrix().norm(); }
  /// Distance of two points in units of the system's scale, over differential unknowns.
  double distance(const std::vector<double>& a, const std::vector<double>& b) const;
  /// a + factor·step in the differential unknowns, put back on the section where the section fixes an unknown.
  std::vector<double> moved(const std::vector<double>& a, const Eigen::VectorXd& step, double factor) const;
  Eigen::VectorXd difference(const std::vector<double>& a, const std::vector<double>& b) const;
  const std::vector<int>& differential() const { return differential_; }
  const Eigen::VectorXd& scale() const { return scale_; }
  const Cycle::Cost& cost() const { return cost_; }
  double drive_speed() const { return speed_; }
  /// Time in which the fastest growing mode of steady sliding grows e-fold (s), infinite where none grows.
  double growth_time() const { return growth_time_; }
  /// Upper bound of the duration of a return, s.
  double longest_return() const { return longest_return_; }

 private:
  double reversal_step(const solvers::steps::Collocation&) const;
  std::vector<double> rates_at_end(const solvers::steps::Collocation&, double tolerance) const;
  void take_out_motion(std::vector<double>& S, int columns, const solvers::steps::Collocation&, double tolerance) const;
  oscillators::SliderSystem system_;
  motion::ReversalSteps reversal_steps_{system_};
  double speed_, longest_return_;
  double growth_time_ = infinity;  ///< 1/|s| of the fastest growing mode of steady sliding
  bool spirals_ = false;           ///< a growing mode there oscillates
  std::string ringing_;            ///< the reason why a return may take too many steps; empty where nothing rings
  long allowed_ = most_steps;
  std::vector<int> differential_;
  Eigen::VectorXd scale_;  ///< scales of the differential unknowns
  Cycle::Cost cost_;
};

/// Depth below V, over V, at which motion of an amplitude |v − V|/V counts as having left the section.
inline double dip_of(double amplitude) { return std::max(1e-6 * std::min(1.0, amplitude), ReturnMap::least_dip); }

}  // namespace rosin::analysis::cycles
