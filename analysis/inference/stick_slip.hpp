/// What stick–slip shows of a law: recurrence, force drop and peak slip rate of the slider's cycle, at each drive
/// speed.
#pragma once
#include "analysis/inference/measurement.hpp"

namespace rosin::analysis::inference {

/// The events of the cycle at each x of a measurement of stick–slip, and their slopes: cycles at a relative accuracy of
/// 1e-9, slopes by differences of 3e-4 of the number, good to 1e-3 where cycles change smoothly with it.
/// \throws InputError where the slider does not stick and slip.
Prediction predict_stick_slip(const Model&, const Measurement&, const std::vector<std::string>& paths);

}  // namespace rosin::analysis::inference
