/// Regimes, metrics and borders over a plane of two parameters.
#pragma once
#include "analysis/planes/map.hpp"
#include "analysis/planes/parts.hpp"
#include "analysis/planes/schedule.hpp"
#include "analysis/planes/structure_map.hpp"
#include "analysis/planes/sweep.hpp"
#include "analysis/planes/varied.hpp"
