/// Motion of which no two periods are alike: the rate at which neighbouring motions part (Lyapunov's exponent).
#pragma once
#include <optional>
#include <vector>

#include "analysis/cycles/return_map.hpp"

namespace rosin::analysis::cycles {

/// By how much a small distance grows in a passage, ln, on the mean over a long motion.
struct Parting {
  double rate = 0, error = 0;  ///< the error is that of the mean of parts of the motion
  int passages = 0;
};

/// The rate at which motions beside that from y, on the section, part from it, if they certainly do: measured twice, at
/// different tolerances and along different parts of the motion, whose means must agree. Nothing where they do not,
/// where the steps of a single passage leave its end in doubt, or where the motion still drifts, so that it may yet
/// come to repeat itself.
std::optional<Parting> parting_from(ReturnMap&, const std::vector<double>& y);

}  // namespace rosin::analysis::cycles
