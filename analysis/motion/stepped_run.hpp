/// The motion of a structure of many coordinates by steps of a given length, with its averages and balance of energy.
#pragma once
#include "analysis/motion/run.hpp"
#include "analysis/motion/structure_start.hpp"

namespace rosin::analysis::motion {

/// Columns: the structure's functionals, or its coordinates where it has none; friction_force and normal_load, the sums
/// over all contacts; stick_fraction and open_fraction, by area; pressure_j and slip_rate_j of each contact. Errors are
/// the largest difference to a pass with half the step.
///
/// Metrics are averages over the second half of the run: apparent_friction, mean friction over mean normal load;
/// stick_fraction, full_stick_fraction (part of the time in which every contact that is closed sticks) and
/// open_fraction; normal_load_max and _min; pressure_min, below 0 where damping holds the surfaces together; of each
/// functional _mean, _amplitude (half of the difference of its extremes) and _period (between upward passages through
/// its mean over the second quarter). energy_residual, over the whole run, is what the balance of energy leaves open,
/// as a part of the work that the surfaces have done. Each has its difference to the pass with half the step, as
/// …_error. \throws InputError for contacts with states, and a step that does not serve
Run run_stepped(const StructureModel&, const RunOptions&);

}  // namespace rosin::analysis::motion
