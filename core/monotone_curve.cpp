/// Slopes and pieces of a monotone piecewise cubic (Fritsch & Butland 1984).
#include "core/monotone_curve.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace rosin {

namespace {

/// Weighted harmonic mean of the secants on both sides, d₁ over h₁ and d₂ over h₂; 0 where they differ in sign.
double inner_slope(double h1, double d1, double h2, double d2) {
  if (d1 * d2 <= 0) return 0;
  const double w1 = 2 * h2 + h1, w2 = h2 + 2 * h1;
  return (w1 + w2) / (w1 / d1 + w2 / d2);
}

/// Three-point slope at an end, from the secant d₁ beside it and the next d₂.
double end_slope(double h1, double d1, double h2, double d2) {
  const double slope = ((2 * h1 + h2) * d1 - h1 * d2) / (h1 + h2);
  if (slope * d1 <= 0) return 0;
  if (d1 * d2 <= 0 && std::abs(slope) > 3 * std::abs(d1)) return 3 * d1;
  return slope;
}

}  // namespace

MonotoneCurve::MonotoneCurve(const std::vector<double>& x, const std::vector<double>& y, std::string_view x_name,
                             std::string_view y_name)
    : knots_(x) {
  const std::size_t n = x.size();
  if (n != y.size())
    throw InputError(
        fmt::format("{} has {} values but {} has {}: give one for each point", x_name, n, y_name, y.size()));
  if (n < 2) throw InputError(fmt::format("{} has {} value(s): a curve needs at least 2 points", x_name, n));
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(x[i])) throw InputError(fmt::format("{}[{}] = {} is not finite", x_name, i, x[i]));
    if (!std::isfinite(y[i])) throw InputError(fmt::format("{}[{}] = {} is not finite", y_name, i, y[i]));
    if (i > 0 && !(x[i - 1] < x[i]))
      throw InputError(fmt::format("{}[{}] = {} does not exceed {}[{}] = {}: sort the points by {}, each value once",
                                   x_name, i, x[i], x_name, i - 1, x[i - 1], x_name));
  }

  std::vector<double> h(n - 1), secant(n - 1), slope(n);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = x[i + 1] - x[i];
    secant[i] = (y[i + 1] - y[i]) / h[i];
  }
  for (std::size_t i = 1; i + 1 < n; ++i) slope[i] = inner_slope(h[i - 1], secant[i - 1], h[i], secant[i]);
  if (n == 2) {
    slope[0] = slope[1] = secant[0];
  } else {
    slope[0] = end_slope(h[0], secant[0], h[1], secant[1]);
    slope[n - 1] = end_slope(h[n - 2], secant[n - 2], h[n - 3], secant[n - 3]);
  }

  for (std::size_t i = 0; i + 1 < n; ++i)
    pieces_.push_back({y[i], slope[i], (3 * secant[i] - 2 * slope[i] - slope[i + 1]) / h[i],
                       (slope[i] + slope[i + 1] - 2 * secant[i]) / (h[i] * h[i])});
  first_ = y.front(), last_ = y.back();
}

}  // namespace rosin
