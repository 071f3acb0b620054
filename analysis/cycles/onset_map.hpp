/// The map of a contact's states from onset to onset of slip, and its fixed point.
#pragma once
#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "analysis/cycles/stick_slip_period.hpp"
#include "oscillators/slider_system.hpp"

namespace rosin::analysis::cycles {

/// The return map from onset to onset of slip, near the fixed point that motion from stick converges to. It maps the
/// states of the contact where stick has loaded it to its limit; where slip reverses instead, the displacement too. The
/// model must outlive the map.
class OnsetMap {
 public:
  OnsetMap(const Model&, double tolerance, double stick_threshold, Onset, int slips = 1);
  /// The period that repeats itself, found from one that starts at rest, or at a reversal into the drive's direction.
  StickSlipPeriod cycle(const std::vector<double>* reversed = nullptr);
  /// Multipliers of the period from `onset` to `onset`, largest first; none where neighbouring periods do not return.
  /// `share`: factor on the finite differences.
  std::vector<std::complex<double>> multipliers(const std::vector<double>& onset, double share = 1) const;

 private:
  class OnsetSearch;
  static constexpr int displacement = 0, mechanical = 2;

  Eigen::VectorXd gather(const std::vector<double>& y) const;
  /// Sizes of the states, by their values: a time at rest may be far below or above its natural size.
  Eigen::VectorXd sizes_at(const Eigen::VectorXd& z) const;
  double size_of_step(const Eigen::VectorXd& step, const Eigen::VectorXd& z) const;
  /// Error of the states at the period's last onset, from the errors of the times at which slip stops.
  double scatter(const StickSlipPeriod&);
  /// Largest change of a metric, relative to its size.
  double largest_change(const Metrics&, const Metrics&) const;
  StickSlipPeriod period_from(const Eigen::VectorXd& z, long most_steps = longest_period) const;
  /// Not finite where neighbouring periods do not return, or would take too long.
  Eigen::MatrixXd derivative(const Eigen::VectorXd& z, double share = 1) const;
  /// Newton's step from z, where one period changes the states by `step`. Nothing where neighbouring periods do not
  /// return.
  std::optional<Eigen::VectorXd> newton_step(const Eigen::VectorXd& z, const Eigen::VectorXd& step) const;
  /// A period from z brought closer to the fixed point by Newton's method, while each step is at most half of the last.
  /// Where attraction is weak, as at a reversal, the change in one period understates the distance to the fixed point.
  /// The remaining distance adds to the closure; where neighbouring periods do not return, `without_newton` does.
  StickSlipPeriod refined_by_newton(StickSlipPeriod, Eigen::VectorXd z, double without_newton, long& steps,
                                    long& evaluations) const;
  /// True if slips that differed in the transient are all alike on the cycle; a period then holds fewer.
  bool reduce_to_fewer_slips(const Eigen::VectorXd& z, double same);

  const Model& model_;
  oscillators::SliderSystem system_;
  double tolerance_, stick_threshold_;
  Onset kind_;
  int slips_;                ///< in a period
  std::vector<int> mapped_;  ///< unknowns that a period maps
  Eigen::VectorXd scale_;    ///< natural sizes of the mapped unknowns
};

}  // namespace rosin::analysis::cycles
