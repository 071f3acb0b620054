/// Coefficients of the five-stage Radau IIA collocation method (order 9), computed rather than listed.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace rosin::solvers::steps {

/// Radau IIA with s = 5. Hairer & Wanner (1996), Solving ODEs II, IV.5 and IV.8.
struct RadauTableau {
  static constexpr int stages = 5;
  using Vector = std::array<double, stages>;
  using Matrix = std::array<Vector, stages>;
  using Complex = std::complex<double>;

  Vector c;                     ///< nodes, c[4] = 1
  Matrix a_inverse;             ///< A⁻¹
  Vector b;                     ///< weights of the quadrature (last row of A)
  double gamma;                 ///< real eigenvalue of A⁻¹
  std::array<Complex, 2> pair;  ///< one of each complex pair of eigenvalues
  Vector real_column;           ///< eigenvector of gamma
  std::array<std::array<Complex, stages>, 2> pair_column;
  Vector real_row;  ///< rows of the inverse of the eigenvector matrix
  std::array<std::array<Complex, stages>, 2> pair_row;
  /// Weights on Z of the embedded error estimate of order 5: err = h/γ f₀ + Σ e_i Z_i.
  Vector error_weights;
  /// Lagrange basis through 0, c₁ … c₅ in monomials of θ: basis[i][k] multiplies θ^(k+1) Z_i.
  Matrix dense;

  /// Value at θ of the polynomial through values[0] at 0 and values[i + 1] at the nodes.
  double interpolate(const std::array<double, stages + 1>& values, double theta) const {
    double result = values[0];
    for (int i = 0; i < stages; ++i) {
      double weight = 0;
      for (int k = stages - 1; k >= 0; --k) weight = (weight + dense[i][k]) * theta;
      result += weight * (values[i + 1] - values[0]);
    }
    return result;
  }

  /// |R(z) − e^z|/|ρ(z)| for y' = λy and z = hλ: what a step errs by over what the embedded estimate, filtered once by
  /// (γ/h − λ)⁻¹, says.
  double error_over_estimate(Complex z) const;
  /// A |z| below which error_over_estimate(z) < ratio wherever |Im z| ≥ |Re z|; at most 2.
  static double size_below(double ratio) { return std::min(2.0, std::sqrt(std::sqrt(ratio / 3.7e-4))); }

  static const RadauTableau& get();
};

}  // namespace rosin::solvers::steps
