/// The map of a contact's states from onset to onset of slip, and its fixed point.
#pragma once
#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "analysis/cycles/stick_slip_period.hpp"
#include "oscillators/slider_system.hpp"

namespace rosin::analysis::cycles {

/// The return from onset to onset of slip, about the fixed point that periods from stick lead to: of the contact's
/// states where stick has loaded it to its limit; also of the displacement where slip reverses. The model must outlive
/// the map.
class OnsetMap {
 public:
  OnsetMap(const Model&, double tolerance, double stick_threshold, Onset, int slips = 1);
  /// The period that repeats itself, beginning with one from rest, or from where slip has turned to go along the drive.
  StickSlipPeriod cycle(const std::vector<double>* reversed = nullptr);
  /// Multipliers of the period that ends, and so begins, at `onset`, largest first; none where neighbouring periods
  /// do not return. `share`: of the differences that they are taken over.
  std::vector<std::complex<double>> multipliers(const std::vector<double>& onset, double share = 1) const;

 private:
  class Search;
  static constexpr int displacement = 0, mechanical = 2;

  Eigen::VectorXd gather(const std::vector<double>& y) const;
  /// States are measured by themselves: a time at rest may be small or large beside its natural size.
  Eigen::VectorXd sizes_at(const Eigen::VectorXd& z) const;
  double size_of_step(const Eigen::VectorXd& step, const Eigen::VectorXd& z) const;
  /// Of the states at the onset that ends a period, by the times at which slip stops.
  double scatter(const StickSlipPeriod&);
  /// Of metrics, relative to their sizes.
  double largest_change(const Metrics&, const Metrics&) const;
  StickSlipPeriod period_from(const Eigen::VectorXd& z, long most_steps = longest_period) const;
  /// Not finite where neighbouring periods do not return, or would take too long.
  Eigen::MatrixXd derivative(const Eigen::VectorXd& z, double share = 1) const;
  /// From z, where a period changes the states by `step`, to where Newton's method has none change. Nothing where
  /// neighbouring periods do not return.
  std::optional<Eigen::VectorXd> newton_step(const Eigen::VectorXd& z, const Eigen::VectorXd& step) const;
  /// What a period hardly forgets, such as a reversal, is far from where it repeats itself although nothing shows in a
  /// period. From one that begins at z to that, by Newton's method for as long as that halves the way. What is left of
  /// it counts as open; where neighbouring periods do not return, `open`.
  StickSlipPeriod closer(StickSlipPeriod, Eigen::VectorXd z, double open, long& steps, long& evaluations) const;
  /// True if slips that were taken for several kinds, on the way to the cycle, are one and the same there.
  bool fewer_slips_do(const Eigen::VectorXd& z, double same);

  const Model& model_;
  oscillators::SliderSystem system_;
  double tolerance_, stick_threshold_;
  Onset kind_;
  int slips_;                   ///< in a period
  std::vector<int> returning_;  ///< unknowns that a period maps
  Eigen::VectorXd scale_;       ///< of these
};

}  // namespace rosin::analysis::cycles
