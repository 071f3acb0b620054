/// The few accelerations that contacts feel, at the end of a step: Newton's method on the contacts' rows alone.
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "core/error.hpp"
#include "oscillators/station_forces.hpp"

namespace rosin::analysis::motion {

/// Solves x = free + G f(place + by_place x, rate + by_rate x), G what forces on rows do to the accelerations of rows.
class RowSolver {
 public:
  /// The forces outlive it.
  RowSolver(const oscillators::StationForces&, Eigen::MatrixXd G, double by_place, double by_rate);

  Eigen::VectorXd place, rate, free;  ///< of the rows without the contacts, given for each step
  /// From x on, where it leaves the solution, with the forces of the contacts there.
  /// \returns tolerance_not_met or not_finite where there is none
  Outcome solve(double t, Eigen::VectorXd& x, oscillators::StationForces::Forces&);
  long iterations() const { return iterations_; }

 private:
  void evaluate(double t, const Eigen::VectorXd& x, oscillators::StationForces::Forces&, Eigen::VectorXd& residual);
  void find_change(const oscillators::StationForces::Forces&);

  const oscillators::StationForces& contacts_;
  Eigen::MatrixXd G_, size_;  ///< size_: |G|
  double by_place_, by_rate_;
  long iterations_ = 0;
  Eigen::VectorXd residual_, next_, next_residual_, change_, at_place_, at_rate_, of_few_;
  std::vector<int> felt_;  ///< rows on which forces depend
  Eigen::MatrixXd columns_, few_;
  Eigen::PartialPivLU<Eigen::MatrixXd> few_lu_;
};

}  // namespace rosin::analysis::motion
