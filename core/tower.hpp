/// Third derivatives along a line, and mixed ones of two, by nested dual numbers.
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

/// x with a slope in one direction and another in a second: what is computed from it has the derivative by the first as
/// slope[0].value.value, by the second as value.slope[0].value, and by both as slope[0].slope[0].value.
inline Tower across(double x, double first, double second) {
  Tower tower(x);
  tower.slope[0].value.value = first;
  tower.value.slope[0].value = second;
  return tower;
}

}  // namespace rosin
