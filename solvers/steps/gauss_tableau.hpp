/// Coefficients of the eight-stage Gauss collocation method (order 16), computed rather than listed.
#pragma once
#include <array>

#include "core/pack.hpp"

namespace rosin::solvers::steps {

/// Gauss collocation with one stage in each lane of a pack. Hairer, Nørsett & Wanner (1993), Solving ODEs I, II.7.
struct GaussTableau {
  static constexpr int stages = pack_width, order = 2 * stages;
  using Vector = std::array<double, stages>;

  Pack nodes, b;               ///< nodes in (0, 1), and the weights of the quadrature
  std::array<Pack, stages> a;  ///< column j of A: what the slope at node j adds to each stage
  std::array<Pack, 2> top;     ///< a polynomial's Legendre coefficients of degree s − 1 and s − 2, from its values
  Pack end;                    ///< and its value at 1
  std::array<Vector, stages> lagrange;  ///< Lagrange's polynomial j is Σ_k lagrange[j][k] θ^k

  /// The weights of the values at the nodes in a polynomial's values at θ.
  ROSIN_INLINE std::array<Pack, stages> basis(const Pack& theta) const {
    std::array<Pack, stages> w;
    ROSIN_UNROLL
    for (int j = 0; j < stages; ++j) {
      w[j] = lagrange[j][stages - 1];
      ROSIN_UNROLL
      for (int k = stages - 2; k >= 0; --k) w[j] = w[j] * theta + lagrange[j][k];
    }
    return w;
  }

  static const GaussTableau& get();
};

}  // namespace rosin::solvers::steps
