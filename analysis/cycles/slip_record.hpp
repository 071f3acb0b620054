/// Record of the slip of a contact over a period: its time at low slip rates, its friction loop and its extremes.
#pragma once
#include <functional>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "oscillators/slider_system.hpp"
#include "oscillators/structure_system.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::cycles {

/// Sees each step of a return.
class StepObserver {
 public:
  virtual ~StepObserver() = default;
  virtual void step(solvers::steps::Collocation&) = 0;
};

/// A contact as a record sees it. Where the surface moves backwards, slip rate and friction have the other sign.
struct SlipSeen {
  std::function<double(double t, const double*y)> slip_rate, friction;  ///< m/s, coefficient
  std::function<double(double v)> steady_friction;                      ///< coefficient, at the level of the load
  double speed;                                                         ///< V > 0, of the surface (m/s)
  bool follows_steady_curve;  ///< friction is a function of the slip rate: the loop has no area
};
SlipSeen slip_seen(const oscillators::SliderSystem&);
SlipSeen slip_seen(const oscillators::StructureSystem&, int friction_contact);

/// Times at low slip rates and friction loop, from the steps that solve a period. Threshold crossings
/// are located by solving the step again, integrals by the quadrature of the collocation nodes, at the order of the
/// solution.
class SlipRecord {
 public:
  /// \param tolerance  of the steps that will be recorded; the loop integral is refined to it
  SlipRecord(SlipSeen, int unknowns, double tolerance, double stick_threshold);

  struct Sample {
    double theta, slip_rate, friction;
  };
  struct Extremum {
    double theta, value;
    bool is_maximum;
  };
  /// At the start of the step and at its nodes.
  std::vector<Sample> samples(solvers::steps::Collocation&) const;
  Sample sample_at(solvers::steps::Collocation&, double theta) const;
  static std::vector<Extremum> extrema(const std::vector<Sample>&, double Sample::*quantity);
  /// ∫ |v| dθ over a step, m/s.
  static double distance(const std::vector<Sample>&, const std::vector<Extremum>& of_slip);
  /// \param fastest, strongest  largest slip rate and friction before the step, by which the loop's accuracy is
  /// measured
  void add(solvers::steps::Collocation&, const std::vector<Sample>&, const std::vector<Extremum>& of_slip,
           double fastest, double strongest);

  double loop_integral() const { return loop_; }  ///< ∮ (μ − μ_ss(v)) dv, m/s
  double time_within[3] = {};                     ///< s at |v| ≤ ε V, 0.01 V and 0.5 V
  const SlipSeen& seen() const { return seen_; }

 private:
  /// ∫ (μ − μ_ss(v)) dv over the interval of the samples, with the value of a rule on part of the nodes.
  struct Loop {
    double integral, check, magnitude;
  };
  Loop loop(const std::vector<Sample>&) const;
  double refined_loop(solvers::steps::Collocation&, const Sample& begin, const Sample& end, double coarse,
                      double last_change, double accuracy);
  double time_below(solvers::steps::Collocation&, const std::vector<Sample>&, const std::vector<Extremum>& of_slip,
                    double threshold) const;

  SlipSeen seen_;
  int unknowns_;
  double tolerance_, threshold_[3], loop_ = 0;
  int divisions_left_ =
      4000;  ///< refinements of the loop integral left, which rounding error would otherwise continue without end
};

/// Collects the metrics of one period of a slider. Extremes are located by solving the step again.
class Recorder final : public StepObserver {
 public:
  Recorder(const oscillators::SliderSystem&, double tolerance, double stick_threshold, bool keep_orbit);
  void step(solvers::steps::Collocation&) override;
  /// Adds `time` (s) of rest at the end of the last step, negative for less; for slip that nearly stops.
  void add_rest(double time);
  Metrics finish(double period) const;
  std::vector<CyclePoint> orbit;

 private:
  using Sample = SlipRecord::Sample;
  void extreme(solvers::steps::Collocation&, const std::vector<Sample>&, const std::vector<SlipRecord::Extremum>&,
               double Sample::*quantity, double& low, double& high);

  const oscillators::SliderSystem& system_;
  SlipRecord slip_;
  bool keep_orbit_;
  Metrics sums_;
  double elapsed_ = 0, friction_ = 0;  ///< time so far, and the coefficient of friction then
};

}  // namespace rosin::analysis::cycles
