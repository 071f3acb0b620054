/// Gauss's quadrature on −1 … 1.
#pragma once
#include <vector>

namespace rosin::oscillators {

struct GaussPoint {
  double at, weight;
};
std::vector<GaussPoint> gauss_points(int count);

}  // namespace rosin::oscillators
