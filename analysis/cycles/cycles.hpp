/// Periodic motion: the cycle of a model with its metrics and multipliers, and the return map that it is found on.
#pragma once
#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/irregular_motion.hpp"
#include "analysis/cycles/lyapunov.hpp"
#include "analysis/cycles/return_map.hpp"
#include "analysis/cycles/stepped_cycle.hpp"
#include "analysis/cycles/stepped_exponent.hpp"
#include "analysis/cycles/structure_cycle.hpp"
