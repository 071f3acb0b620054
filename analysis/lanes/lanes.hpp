/// Cycles of many sliders at once, one in each lane of a vector unit.
#pragma once
#include "analysis/lanes/cycle_lanes.hpp"
