/// What stick–slip shows of a law: recurrence, force drop and peak slip rate of the cycle of a slider or of another
/// machine, at each drive speed.
#pragma once
#include "analysis/inference/measurement.hpp"

namespace rosin::analysis::inference {

/// The events of the cycle at each x of a measurement of stick–slip, and their slopes: cycles at a relative accuracy of
/// 1e-9, slopes by differences of 3e-4 of the number, good to 1e-3 where cycles change smoothly with it. Of a machine
/// force is that of the springs on its contacts (oscillators::spring_force).
/// \throws InputError where the machine does not stick and slip, and where a contact slips several times in a period,
///         so that events differ
Prediction predict_stick_slip(const Subject&, const Measurement&, const std::vector<std::string>& paths);

}  // namespace rosin::analysis::inference
