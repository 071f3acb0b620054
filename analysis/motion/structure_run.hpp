/// The motion of a structure from a start, with its record, the switches of its contacts and its balance of energy.
#pragma once
#include "analysis/motion/run.hpp"
#include "analysis/motion/structure_start.hpp"

namespace rosin::analysis::motion {

/// Columns: coordinates, velocities, then for each contact slip rate, friction force, coefficient and states, numbered
/// from 1 where there are several, with the normal load. Errors are the difference of two passes, at a tenth and at
/// 1/300 of the tolerance; where that is above the tolerance, passes go on at 1/30 each, up to four in all. Metrics:
/// stick_time of each contact; friction_work, what friction has turned into heat; energy_residual, what the balance of
/// kinetic and elastic energy with all works leaves open, as a part of what was turned over; impact_work, what rigid
/// stops have taken of it, where there are stops; event_time_error, infinite
/// where the passes count other switches; choices, switches in which the order that contacts give way in decides
/// (balance_contacts). \throws InputError for a start that does not fit, a solver other than "auto" and "events", and a
/// steady start
///         without steady sliding
Run run_structure(const StructureModel&, const RunOptions&, double stick_threshold = usual_stick_threshold);

}  // namespace rosin::analysis::motion
