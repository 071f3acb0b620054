/// A block on a tilted table, in the slider's terms: no spring, no drive; it slides down with slip rate u > 0.
#pragma once
#include "analysis/lab/tools.hpp"

namespace rosin::analysis::lab {

/// m u̇ = m g sin α − F(u, m g cos α), so that f = −m g sin α, with α = slope + rate·t (rad).
Model block(const Task&, double slope, double rate = 0);

/// The states of contacts made by sliding at `prior_speed` that then rested for `rest_time` on the level table.
motion::Start rested(const Task&);
/// The states in a start, in the law's order; none if it gives none.
std::vector<double> states_of(const FrictionLaw&, const motion::Start&);

/// α with tan α = μ(m g cos α): the slope at which a coefficient that may depend on load balances weight.
double balance_slope(const Task&, const std::function<double(double)>& coefficient_at_load);

/// Settings that all experiments with a block share.
std::vector<Setting> block_settings();

}  // namespace rosin::analysis::lab
