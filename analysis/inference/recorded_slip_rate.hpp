/// The motion behind recorded slip rates.
#pragma once
#include "analysis/inference/measurement.hpp"

namespace rosin::analysis::inference {

/// Slip rates as they were recorded, with a smooth course between them: each interval has the mean of the cubic that
/// has the accelerations of the smoothest course through the record, which is found as that of displacements is. Their
/// noise is found, but not taken out.
/// \param time in s, ascending, 4 or more
Measurement::History recorded_slip_rate(std::vector<double> time, std::vector<double> slip_rate,
                                        std::vector<double> normal_load);

}  // namespace rosin::analysis::inference
