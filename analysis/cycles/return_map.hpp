/// The map from one passage through v = V (v rising) to the next, with its derivative and a recorder of metrics.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/landing.hpp"
#include "oscillators/slider_system.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::cycles {

/// Sees each step of a passage.
class PassageObserver {
 public:
  virtual ~PassageObserver() = default;
  virtual void step(solvers::steps::Collocation&) = 0;
};

/// Collects the metrics of one period from the steps that solve it. Extremes and threshold crossings are located by
/// solving the step again, integrals by the quadrature of the collocation nodes, both at the order of the solution.
class Recorder final : public PassageObserver {
 public:
  /// `tolerance`: of the steps that will be recorded; the loop integral is refined to it.
  Recorder(const oscillators::SliderSystem&, double tolerance, double stick_threshold, bool keep_orbit);
  void step(solvers::steps::Collocation&) override;
  /// The last step's end lasts for so long (s) more, or less, than the steps show: a slip that all but rests.
  void linger(double time);
  Metrics finish(double period) const;
  std::vector<CyclePoint> orbit;

 private:
  struct Sample {
    double theta, slip_rate, friction;
  };
  struct Turn {
    double theta, value;
    bool is_maximum;
  };
  static std::vector<Turn> turns(const std::vector<Sample>&, double Sample::*quantity);
  void extreme(solvers::steps::Collocation&, const std::vector<Sample>&, const std::vector<Turn>&,
               double Sample::*quantity, double& low, double& high);
  Sample sample_at(solvers::steps::Collocation&, double theta) const;
  /// ∫ (μ − μ_ss(v)) dv over the interval of the samples, with the value of a rule on part of the nodes.
  struct Loop {
    double integral, check, magnitude;
  };
  double loop_tolerance() const;
  Loop loop(const std::vector<Sample>&) const;
  double refined_loop(solvers::steps::Collocation&, double begin, double end, double coarse, double last_change);
  double time_within(solvers::steps::Collocation&, const std::vector<Sample>&, const std::vector<Turn>& of_slip,
                     double threshold) const;

  const oscillators::SliderSystem& system_;
  double tolerance_, threshold_[3];
  bool keep_orbit_;
  bool follows_steady_curve_;  ///< friction is a function of the slip rate: the loop has no area
  Metrics sums_;
  double elapsed_ = 0, friction_ = 0;  ///< time so far, and the coefficient of friction then
  int divisions_left_ = 4000;  ///< of steps for the loop integral, so that rounding cannot ask for more and more
};

/// The normal load over the largest force of the spring in a swing as fast as the drive; infinite without mass.
double friction_over_swing(const Model&);
constexpr double weak_friction = 0.1;  ///< over a swing: below this a turn may hardly show it

/// The derivative that a passage carries along. `across_motion`: for its eigenvalues to the last digits; steps end
/// where slip reverses, where the rates of states have kinks, and what grows along the motion, which tells nothing but
/// the time, is taken out after every step, so that rounding of it does not count.
enum class Derivative { none, of_steps, across_motion };

/// Section-to-section map of a slider with a smooth law under a constant drive with V > 0.
class ReturnMap {
 public:
  explicit ReturnMap(const Model&);
  ReturnMap(const ReturnMap&) = delete;

  struct Passage {
    Outcome outcome;
    double duration = 0;
    std::vector<double> end;      ///< unknowns at the section
    double amplitude = 0;         ///< largest |v − V|/V seen
    Eigen::MatrixXd derivative;   ///< of the differential unknowns, if asked
    std::vector<double> ringing;  ///< of each unknown: Collocation::ringing_errors()
  };
  /// Follows the motion from y through `turns` passages. `from_section`: y lies on the section. Motions that dip below
  /// V by less than `dip`·V do not leave it: after a slip at 10¹⁰ V, rounding alone passes it again.
  Passage follow(const std::vector<double>& y, double tolerance, int turns, bool from_section,
                 Derivative derivative = Derivative::none, PassageObserver* observer = nullptr, double dip = least_dip);
  static constexpr double least_dip = 1e-10;
  static constexpr long most_steps = 120'000;
  /// A passage that takes more steps ends with its budget spent.
  void allow(long steps) { allowed_ = steps; }

  const oscillators::SliderSystem& system() const { return system_; }
  /// Unknowns with the slider almost stuck (slip rate 1e-3 V) and the state of steady sliding at `aged_at`.
  std::vector<double> stick(double aged_at) const;
  /// Length of a step of the differential unknowns, in units of the system's scale.
  double length(const Eigen::VectorXd& step) const { return (step.array() / scale_.array()).matrix().norm(); }
  /// Distance of two points in units of the system's scale, over differential unknowns.
  double distance(const std::vector<double>& a, const std::vector<double>& b) const;
  /// a + factor·step in the differential unknowns, put back on the section where that is a coordinate.
  std::vector<double> moved(const std::vector<double>& a, const Eigen::VectorXd& step, double factor) const;
  Eigen::VectorXd difference(const std::vector<double>& a, const std::vector<double>& b) const;
  const std::vector<int>& differential() const { return differential_; }
  const Eigen::VectorXd& scale() const { return scale_; }
  const Cycle::Cost& cost() const { return cost_; }
  double drive_speed() const { return speed_; }
  /// Time in which the fastest growing mode of steady sliding grows e-fold (s), infinite where none grows.
  double growth_time() const { return growth_time_; }
  /// No passage takes longer (s).
  double longest_passage() const { return longest_passage_; }

 private:
  double landing_time(const solvers::steps::Collocation&) const;
  std::vector<double> rates_at_end(const solvers::steps::Collocation&, double tolerance) const;
  void take_out_motion(std::vector<double>& S, int columns, const solvers::steps::Collocation&, double tolerance) const;
  oscillators::SliderSystem system_;
  motion::LandingSteps landing_{system_};
  double speed_, longest_passage_;
  double growth_time_ = infinity;  ///< 1/|s| of the fastest growing mode of steady sliding
  bool spirals_ = false;           ///< what grows there oscillates
  std::string ringing_;            ///< why a passage may take too many steps; empty where nothing rings
  long allowed_ = most_steps;
  std::vector<int> differential_;
  Eigen::VectorXd scale_;  ///< of the differential unknowns
  Cycle::Cost cost_;
};

/// What a motion of some amplitude |v − V|/V must dip below V to count as having left it.
inline double dip_of(double amplitude) { return std::max(1e-6 * std::min(1.0, amplitude), ReturnMap::least_dip); }

}  // namespace rosin::analysis::cycles
