/// Irregular motion, by its Lyapunov exponent: the rate at which neighbouring motions diverge.
#pragma once
#include <optional>
#include <vector>

#include "analysis/cycles/return_map.hpp"

namespace rosin::analysis::cycles {

/// Mean growth (ln) of a small distance per return, over a long motion.
struct Divergence {
  double rate = 0, error = 0;  ///< the error is the standard error of the mean over parts of the motion
  int returns = 0;
};

/// The divergence of motions next to the one from y on the section, if it is certain: two measurements, at different
/// tolerances and along different parts of the motion, must agree. Nothing where they differ, where the error of the
/// steps in a single return is too large, or where the amplitude still changes, so that the motion may yet become
/// periodic.
std::optional<Divergence> divergence_from(ReturnMap&, const std::vector<double>& y);

}  // namespace rosin::analysis::cycles
