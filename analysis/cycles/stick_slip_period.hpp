/// One period of stick and slip, from one onset of slip along the drive to the next.
#pragma once
#include <vector>

#include "analysis/cycles/cycle.hpp"

namespace rosin::analysis::cycles {

/// The outcome where rounding error decides whether slip comes to rest. `share`: slip rate over its highest.
Outcome grazing_outcome(double share);

/// The state of the contact before slip along the drive.
enum class Onset {
  held,      ///< stick, loaded to the limit of the contact
  reversed,  ///< slip against the drive, or stick
};

/// One period, with the errors of its times and forces.
struct StickSlipPeriod {
  Outcome outcome;
  Metrics metrics;
  std::vector<CyclePoint> orbit;
  std::vector<double> onset;     ///< unknowns where the period ends
  int slips = 1;                 ///< in the period
  std::vector<double> reversed;  ///< unknowns at the last reversal into the drive's direction; empty where slip sticks
  double onset_displacement = 0;
  double closure = 0;  ///< relative error from the mismatch of the period's two ends
  bool found = false;
  bool settles = false;           ///< slip comes to steady sliding, which attracts it
  bool used_newton = false;       ///< found with Newton's method, which finds repelling periods too
  double lowest_slip = infinity;  ///< lowest slip rate after the first half of a slip, over the drive speed
  bool grazes = false;            ///< the lowest slip rate is within the tolerance of rest (grazing)
  double rounding = 0;            ///< relative error from rounding of the slip rate where slip just comes to rest
  double stop_time_error = 0;     ///< sum of the errors of the times at which slip stops (s)
  double friction_error = 0;      ///< error of the friction coefficient where slip has just come to rest, or reverses
  double reversal_slip_rate = 0;  ///< reversed slip rate (m/s) where it is so small that it counts as rest
  double growth = 0;  ///< ln of the amplitude growth of slip without stick, from the work of friction (SwingWork)
  long steps = 0, evaluations = 0;
};

constexpr long longest_period = 200'000;  ///< steps

/// The period of `slips` slips from the `onset` of slip, or the first full period after stick from rest.
StickSlipPeriod stick_slip_period(const oscillators::Model&, double tolerance, double stick_threshold,
                                  const std::vector<double>* onset = nullptr, int slips = 1, Onset kind = Onset::held,
                                  long most_steps = longest_period);

}  // namespace rosin::analysis::cycles
