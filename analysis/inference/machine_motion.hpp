/// Recorded motion of a machine: what its columns would be under a law, and how they change with its numbers.
#pragma once
#include "analysis/inference/measurement.hpp"

namespace rosin::analysis::inference {

/// Tolerance of the runs behind a prediction, and the part of a number between two runs whose difference is a slope.
/// The part is larger for a number that hardly shows in the record, and smaller for one that changes it much.
inline constexpr double motion_tolerance = 1e-9, motion_part = 3e-4;

/// A column of the motion at each x of a measurement, with its slopes: differences of runs on both sides of a number.
/// Where the two sides differ because a located stick or slip passes the sample, the side without it counts.
/// \throws InputError where the motion does not reach the end of the record
Prediction predict_motion(const Subject&, const Measurement&, const std::vector<std::string>& paths,
                          double clock_offset);

}  // namespace rosin::analysis::inference
