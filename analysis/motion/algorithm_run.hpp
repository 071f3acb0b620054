/// Runs by the published force algorithms, with their true errors.
#pragma once
#include "analysis/motion/exact_run.hpp"
#include "solvers/force_algorithms/force_algorithms.hpp"

namespace rosin::analysis::motion {

/// The oscillator as the algorithms see it. \throws InputError for a surface whose speed varies and for friction that
/// is viscous.
solvers::force_algorithms::DryMass<1> dry_mass(const solvers::stick_slip::DryOscillator&);

/// Fills columns, events, errors and metrics of a run at the given times. Errors are the largest differences to the
/// exact motion at the samples.
/// \throws InputError as dry_mass() and the algorithm's own check.
void run_algorithm(const Model&, const solvers::stick_slip::DryOscillator&, const RunOptions&,
                   const std::vector<double>& times, Run& result);

}  // namespace rosin::analysis::motion
