/// The normal form of a pair of complex modes about steady sliding, for M ẏ = f(y) with algebraic rows.
#pragma once
#include <complex>
#include <functional>
#include <optional>

#include "analysis/steady/linearised.hpp"

namespace rosin::analysis::steady {

/// f about steady sliding, to the third order.
struct Expansion {
  Linearised linear;
  /// d²f(y + ε d)/dε² and d³f(y + ε d)/dε³ at ε = 0.
  std::function<Eigen::VectorXd(const Eigen::VectorXd&d)> second, third;
  Eigen::VectorXd slip_rate_gradient;  ///< ∂(slip rate of the first contact)/∂y
  double slip_rate;                    ///< of the first contact (m/s)
  /// Sizes by which the two directions of ∂²f(a, b) are measured before they are added; empty: as they are.
  Eigen::VectorXd reach = {};
};

/// Re c₁ (1/s) of ẇ = s w + c₁ w|w|², w scaled so that the slip rate of the first contact is V(1 + |w| cos ωt). Exact
/// in the sense of the normal form where Re s = 0, continued from there elsewhere, with s itself in its equations.
/// Nothing where the pair is double or no slip moves with it. Kuznetsov (2004), eq 5.34.
std::optional<double> normal_form_coefficient(const Expansion&, std::complex<double> eigenvalue);

}  // namespace rosin::analysis::steady
