/// Friction as a function of the contact's temperature, calibrated so that steady sliding has a given curve.
#pragma once
#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"
#include "core/maths.hpp"

namespace rosin::laws {

/// Heat that slip makes, μv, leaves by conduction, h₀ΔT, and with the surface that slips out of the contact, h₁vΔT.
/// Steady sliding at w is to have μ(w) = μ_∞ + μ₁ e^{−w/v₁} + μ₂ e^{−w/v₂}, hence the rise ΔT(w) = μ(w) w/(h₀ + h₁w),
/// and from both μ(ΔT). A temperature is given as the slip rate y = w/(1 + (h₁/h₀)w) that would heat to it were nothing
/// swept away: ΔT = μ y/h₀. So no table of μ against temperature is needed, and the calibration is exact. Temperatures
/// beyond those of fastest sliding, y ≥ h₀/h₁, have the friction μ_∞.
template <class Real>
struct HeatedCurve {
  Real mu_inf, mu_1, v_1, mu_2, v_2, h0, h1;

  /// w(y)
  ROSIN_INLINE Real slip_rate(const Real& y) const {
    const Real left = 1.0 - h1 / h0 * y;
    constexpr double hottest = 1e100;  // beyond all sliding, and far from overflow where it is divided by v_1
    return select(left > 0.0, Real(y / left), Real(hottest));
  }
  struct Point {
    Real friction;
    Real fall;        ///< w dμ/dw
    Real rise_slope;  ///< h₀² d(ΔT)/dy, of the sign of d(ΔT)/dw
  };
  ROSIN_INLINE Point at(const Real& w) const {
    const Real first = exp(-w / v_1), second = exp(-w / v_2);
    const Real friction = mu_inf + mu_1 * first + mu_2 * second;
    const Real fall = -(mu_1 / v_1 * first + mu_2 / v_2 * second) * w;
    return {friction, fall, friction * h0 + fall * (h0 + h1 * w)};
  }
  ROSIN_INLINE Real friction(const Real& w) const { return mu_inf + mu_1 * exp(-w / v_1) + mu_2 * exp(-w / v_2); }

  /// The temperature must rise with the steady slip rate, else μ(T) is not a function.
  void check() const {
    const double slow = 1e-3 * std::min(v_1, v_2), fast = 40 * std::max(v_1, v_2);
    for (double w = slow; w < fast; w *= 1.01)
      if (!(at(w).rise_slope > 0))
        throw InputError(
            fmt::format("law.h1 = {:.6g} J/(m K N) is too large for this curve: steady sliding at {:.3g} m/s would be "
                        "colder than slower sliding, and friction no function of temperature; take h1/h0 below about "
                        "{:.3g} s/m, or a curve that falls less steeply",
                        h1, w, steepest_ratio()));
  }

 private:
  /// The largest h₁/h₀ that the curve allows.
  double steepest_ratio() const {
    double least = INFINITY;
    const double fast = 40 * std::max(v_1, v_2);
    for (double w = 1e-3 * std::min(v_1, v_2); w < fast; w *= 1.01)
      if (const auto here = at(w); here.fall < 0)
        least = std::min(least, (here.friction + here.fall) / (-here.fall * w));
    return std::max(least, 0.0);
  }
};

}  // namespace rosin::laws
