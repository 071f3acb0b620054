/// Points and weights of Gauss's quadrature.
#include "oscillators/gauss_points.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace rosin::oscillators {

/// Zeros of the Legendre polynomial by Newton's method from Tricomi's estimate.
std::vector<GaussPoint> gauss_points(int count) {
  std::vector<GaussPoint> points;
  for (int i = count; i >= 1; --i) {
    double x = std::cos(std::numbers::pi * (i - 0.25) / (count + 0.5)), slope = 0;
    for (int k = 0; k < 8; ++k) {
      double before = 1, now = x;
      for (int degree = 2; degree <= count; ++degree)
        before = std::exchange(now, ((2 * degree - 1) * x * now - (degree - 1) * before) / degree);
      slope = count * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    points.push_back({x, 2 / ((1 - x * x) * slope * slope)});
  }
  return points;
}

}  // namespace rosin::oscillators
