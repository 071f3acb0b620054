/// Where sliding is steady, and whether it stays so: the steady curve, eigenvalues, and the borders of stability.
#pragma once
#include "analysis/steady/curve.hpp"
#include "analysis/steady/mode_tracking.hpp"
#include "analysis/steady/mode_windows.hpp"
#include "analysis/steady/plane_sliding.hpp"
#include "analysis/steady/reduction_error.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "analysis/steady/stability.hpp"
#include "analysis/steady/structure_hopf.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "analysis/steady/thresholds.hpp"
