/// Tabulated friction curve: measured steady friction, interpolated without overshoot.
#pragma once
#include "core/monotone_curve.hpp"
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct Tabulated {
  static constexpr Card card{
      .name = "tabulated",
      .title = "Tabulated friction curve",
      .formula = R"(\mu = \mu(|v|) \text{ through the points } (v_i, \mu_i),\quad |F| \le \mu(0)\,N \text{ at } v = 0)",
      .source = "monotone piecewise cubic, Fritsch & Butland (1984)",
      .limits = "friction follows speed at once; constant outside the table; slope continuous, curvature not"};

  std::vector<double> slip_rates = {0, 0.01, 0.03, 0.1, 0.3, 1};
  std::vector<double> coefficients = {0.4, 0.34, 0.31, 0.3, 0.31, 0.33};
  static constexpr auto parameters =
      table(field(&Tabulated::slip_rates, "slip_rate", "m/s", {0, 1e6}, "slip rates of the points, ascending"),
            field(&Tabulated::coefficients, "friction", "1", {0, 10}, "coefficients of friction of the points"));

  MonotoneCurve curve{slip_rates, coefficients, "law.slip_rate", "law.friction"};

  Real friction(Sliding<Real> at) const { return curve(at.slip_rate); }
  Real static_limit(Sliding<Real>) const { return Real(coefficients.front()); }
};

}  // namespace rosin::laws
