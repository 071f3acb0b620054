/// A mass on springs and dampers under dry friction, in D directions.
#pragma once
#include <array>
#include <cmath>

#include "core/signal.hpp"

namespace rosin::solvers::stick_slip {

template <int D>
using Vector = std::array<double, D>;

template <int D>
double dot(const Vector<D>& a, const Vector<D>& b) {
  double sum = 0;
  for (int i = 0; i < D; ++i) sum += a[i] * b[i];
  return sum;
}
template <int D>
double length(const Vector<D>& a) {
  if constexpr (D == 1) return std::abs(a[0]);
  return std::sqrt(dot<D>(a, a));
}

/// m ẍᵢ + cᵢ ẋᵢ + kᵢ xᵢ = fᵢ(t) + Fᵢ on a surface of constant velocity; friction F opposes the slip, |F| = μd N in
/// motion, |F| ≤ μs N at rest on the surface.
template <int D>
struct DryMass {
  double mass = 1;                   ///< kg
  Vector<D> stiffness{}, damping{};  ///< N/m, N s/m
  double static_friction = 0.4, dynamic_friction = 0.3;
  Vector<D> surface_velocity{};  ///< m/s
  Signal load = 1.0;             ///< N
  std::array<Signal, D> force;   ///< N
};

}  // namespace rosin::solvers::stick_slip
