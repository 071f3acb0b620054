/// Extremes of the polynomials of a cycle's steps.
#include "analysis/cycles/structure_extremes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/steps/radau_tableau.hpp"

namespace rosin::analysis::cycles {

namespace {

using solvers::steps::RadauTableau;

/// Least and largest of a number that is known at the beginning of the period and at the stages of each step.
std::pair<double, double> extremes_of_steps(const std::vector<double>& number) {
  const auto& tableau = RadauTableau::get();
  constexpr int parts = 16, thirds = 40;
  double low = number.front(), high = low;
  for (std::size_t first = 0; first + RadauTableau::stages < number.size(); first += RadauTableau::stages) {
    std::array<double, RadauTableau::stages + 1> nodes;
    std::copy_n(number.begin() + std::ptrdiff_t(first), nodes.size(), nodes.begin());
    for (const double sign : {1.0, -1.0}) {
      const auto at = [&](double theta) { return sign * tableau.interpolate(nodes, theta); };
      int best = 0;
      for (int i = 1; i <= parts; ++i)
        if (at(double(i) / parts) > at(double(best) / parts)) best = i;
      double left = double(std::max(best - 1, 0)) / parts, right = double(std::min(best + 1, parts)) / parts;
      for (int i = 0; i < thirds; ++i) {
        const double a = left + (right - left) / 3, b = right - (right - left) / 3;
        if (at(a) > at(b))
          right = b;
        else
          left = a;
      }
      const double most = std::max(at(double(best) / parts), at((left + right) / 2));
      if (sign > 0)
        high = std::max(high, most);
      else
        low = std::min(low, -most);
    }
  }
  return {low, high};
}

}  // namespace

ExtremesOfPeriod extremes_of(const StructureCycle& cycle, const Eigen::VectorXd& weights) {
  std::vector<double> sum(cycle.time.size());
  double error = 0;
  for (std::size_t i = 0; i < std::size_t(weights.size()); ++i) {
    const double weight = weights[Eigen::Index(i)];
    if (weight == 0) continue;
    const auto& q = cycle.columns[i];
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * q[k];
    const auto [low, high] = extremes_of_steps(q);
    const auto& name = cycle.column_names[i];
    const double stated = std::max(cycle.metrics.at(name + "_max").error, cycle.metrics.at(name + "_min").error),
                 missed = std::max(std::abs(high - cycle.coordinate_max[i]), std::abs(low - cycle.coordinate_min[i]));
    error += std::abs(weight) * (stated + missed);
  }
  const auto [low, high] = extremes_of_steps(sum);
  return {low, high, error};
}

}  // namespace rosin::analysis::cycles
