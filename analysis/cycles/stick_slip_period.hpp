/// One period of stick and slip, from one onset of slip along the drive to the next.
#pragma once
#include <vector>

#include "analysis/cycles/cycle.hpp"

namespace rosin::analysis::cycles {

/// `share`: slip rate over its highest.
Outcome comes_to_rest_or_not(double share);

/// What slip along the drive begins from.
enum class Onset {
  held,      ///< stick, which has loaded the contact to its limit
  reversed,  ///< slip against the drive, or stick
};

/// What is known of such a period.
struct StickSlipPeriod {
  Outcome outcome;
  Metrics metrics;
  std::vector<CyclePoint> orbit;
  std::vector<double> onset;     ///< unknowns where the period ends
  int slips = 1;                 ///< in the period
  std::vector<double> reversed;  ///< unknowns where slip last turned to go along the drive, if each turn of it does
  double onset_displacement = 0;
  double closure = 0;  ///< relative error that is left because the period does not quite return
  bool found = false;
  bool settles = false;       ///< slip comes to steady sliding, which attracts it
  bool turned = false;        ///< Newton's method had a part in it, which finds what repels too
  double closest = infinity;  ///< lowest slip rate after the first half of a slip, over the drive speed
  bool grazes = false;        ///< slip comes to rest or not by less than the tolerance tells
  double rounding = 0;        ///< relative error that rounding of the slip rate makes where it just comes to rest
  double landing = 0;         ///< to which the times at which slip stops are known together (s)
  double friction = 0;        ///< to which friction is known where slip has just come to rest, or reverses
  double turns_back = 0;      ///< slip rate at which slip reverses (m/s), if by so little that it counts as rest
  double growth = 0;          ///< of a swing that does not stick, by the work of friction (SwingWork)
  long steps = 0, evaluations = 0;
};

constexpr long longest_period = 200'000;  ///< steps

/// The period of so many slips that begins at the `onset` of slip, or else the first full one after stick from rest.
StickSlipPeriod stick_slip_period(const oscillators::Model&, double tolerance, double stick_threshold,
                                  const std::vector<double>* onset = nullptr, int slips = 1, Onset kind = Onset::held,
                                  long most_steps = longest_period);

}  // namespace rosin::analysis::cycles
