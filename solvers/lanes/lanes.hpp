/// Steps of many systems at once, one in each lane of a vector unit.
#pragma once
#include "solvers/lanes/ensemble.hpp"
