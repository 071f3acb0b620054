/// Motions of many sliders at once, one in each lane of a vector unit: cycles, and blocks under a periodic force.
#pragma once
#include "analysis/lanes/cycle_lanes.hpp"
#include "analysis/lanes/driven_lanes.hpp"
