/// Runs in closed form, for sliders whose motion is linear between events.
#pragma once
#include <string>
#include <variant>

#include "analysis/motion/run.hpp"
#include "solvers/stick_slip/exact.hpp"

namespace rosin::analysis::motion {

/// The slider as its closed form sees it, or why there is none.
std::variant<solvers::stick_slip::DryOscillator, std::string> dry_oscillator(const Model&);

/// Fills columns, events, errors and metrics of a run at the given times. Errors are what extended arithmetic changes.
void run_exactly(const Model&, const solvers::stick_slip::DryOscillator&, const RunOptions&,
                 const std::vector<double>& times, Run& result);

}  // namespace rosin::analysis::motion
