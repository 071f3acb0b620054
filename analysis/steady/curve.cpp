/// Extrema of steady friction curves from exact derivatives.
#include "analysis/steady/curve.hpp"

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>

namespace rosin::analysis::steady {

namespace {
constexpr int points_per_decade = 64;

/// dμ_ss/d ln v: of one size over all decades.
double logarithmic_slope(const FrictionLaw& law, double v, double normal_load) {
  return v * law.steady_friction({v, normal_load}).slope;
}
}  // namespace

std::vector<double> steady_curve(const FrictionLaw& law, const std::vector<double>& slip_rates, double normal_load) {
  std::vector<double> friction;
  for (const double v : slip_rates) friction.push_back(law.steady_friction({v, normal_load}).friction);
  return friction;
}

std::vector<Extremum> steady_extrema(const FrictionLaw& law, double low, double high, double normal_load) {
  require(low, {1e-300, 1e300}, "curve.from", "lowest slip rate", "m/s");
  require(high, {low, 1e300}, "curve.to", "highest slip rate", "m/s");
  std::vector<Extremum> found;
  const int count = std::max(2, int(std::ceil(points_per_decade * std::log10(high / low))) + 1);
  const auto slope = [&](double w) { return logarithmic_slope(law, std::exp(w), normal_load); };
  double w = std::log(low), before = slope(w);
  for (int i = 1; i < count; ++i) {
    const double next = std::log(low) + std::log(high / low) * i / (count - 1), after = slope(next);
    if (before != 0 && after != 0 && (before > 0) != (after > 0)) {
      std::uintmax_t iterations = 200;
      const auto [a, b] = boost::math::tools::toms748_solve(slope, w, next, before, after,
                                                            boost::math::tools::eps_tolerance<double>(52), iterations);
      const double root = std::exp(0.5 * (a + b));
      // The slope is known to rounding of its largest part; that sets how sharply its zero is.
      const double step = 1e-3, bend = (slope(0.5 * (a + b) + step) - slope(0.5 * (a + b) - step)) / (2 * step);
      const double scale = std::abs(law.steady_friction({root, normal_load}).friction);
      found.push_back({before > 0, root, law.steady_friction({root, normal_load}).friction,
                       root * ((b - a) + 4e-16 * scale / std::max(std::abs(bend), 1e-300) + 4e-16)});
    }
    if (after != 0) before = after;
    w = next;
  }
  return found;
}

bool weakens_somewhere(const FrictionLaw& law, double normal_load) {
  for (double e = -14; e <= 3; e += 0.125)
    if (logarithmic_slope(law, std::pow(10.0, e), normal_load) < 0) return true;
  return false;
}

}  // namespace rosin::analysis::steady
