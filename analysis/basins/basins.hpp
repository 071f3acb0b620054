/// Which motion a start comes to, where several exist side by side.
#pragma once
#include "analysis/basins/basin.hpp"
