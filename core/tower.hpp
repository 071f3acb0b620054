/// Third derivatives along a line, by nested dual numbers.
#pragma once
#include "core/dual.hpp"

namespace rosin {

/// x + ε d with its three first-order parts, one per level of nesting: what is computed from it has d/dε as slope[0],
/// d²/dε² as slope[0].slope[0] and d³/dε³ as slope[0].slope[0].slope[0].
inline Tower along(double x, double d) {
  Tower tower(x);
  tower.slope[0].value.value = d;
  tower.value.slope[0].value = d;
  tower.value.value.slope[0] = d;
  return tower;
}

}  // namespace rosin
