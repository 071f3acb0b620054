/// Laws whose friction follows the temperature of the contact alone, as heat that flows through a kernel of conduction.
#pragma once
#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "laws/conduction.hpp"
#include "laws/law.hpp"

namespace rosin::laws {

/// A curve of friction against the rise of temperature, between evenly spaced points by cubics.
class HeatedFriction {
 public:
  /// Of steady sliding at slip rates w, all conductances per unit load.
  HeatedFriction(const FrictionLaw&, double h0, double h1);
  /// μ(ϑ), that of rest below ϑ = 0 and that of fastest sliding from its temperature on.
  double operator()(double rise) const {
    const double at = std::min(std::max(0.0, rise * per_kelvin_), last_);  // 0 if it is no number
    const auto* point = &points_[std::size_t(at)];
    const double x = at - double(std::size_t(at)), difference = point[1].friction - point[0].friction;
    const double a = point[0].slope, b = point[1].slope;
    return point[0].friction + x * (a + x * (3 * difference - 2 * a - b + x * (a + b - 2 * difference)));
  }

 private:
  double per_kelvin_ = 0, last_ = 0;  ///< points
  struct Point {
    double friction, slope;  ///< slope per point
  };
  std::vector<Point> points_;
};

/// μ = μ(ϑ), ϑ = Σ ϑ_k,  τ_k ϑ̇_k = (ρ_k/h₀) [crowding·μ|v| − h₁|v|ϑ] − ϑ_k  (Smith & Woodhouse 2000; Woodhouse 2003).
struct HeatFlow {
  std::span<const HeatMode> modes;  ///< ρ_k, and τ_k in units of `time`
  double time, h0, h1;              ///< s at N_ref, W/(K N), J/(m K N)
  double area_exponent, size_exponent, N_ref;
  std::shared_ptr<const HeatedFriction> friction;

  /// Load on a part of the contact over that at N_ref.
  double crowding(double normal_load) const;
  /// Relaxation time of a mode under a load, s.
  double relaxation(std::size_t mode, double normal_load) const;
};
/// Nothing for laws of another kind.
std::optional<HeatFlow> heat_flow(const FrictionLaw&);

}  // namespace rosin::laws
