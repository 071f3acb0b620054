/// Weibull fits. A distribution below its threshold is that of 1/(x₀ − x) above zero, with the sign of b reversed.
#include "analysis/studies/weibull.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.hpp"

namespace rosin::analysis::studies {

namespace {

/// Distances from the threshold, or their inverses, in ascending order: a Weibull sample with b > 0 and x₀ = 0.
struct Prepared {
  std::vector<double> y;
  bool below;
};
Prepared prepare(std::span<const double> samples, double threshold) {
  Prepared prepared{{}, !samples.empty() && *std::ranges::max_element(samples) <= threshold};
  double least = infinity;
  for (const double x : samples) {
    const double distance = prepared.below ? threshold - x : x - threshold;
    if (distance < 0 || !std::isfinite(distance))
      throw InputError(
          fmt::format("samples on both sides of the threshold {} have no Weibull distribution", threshold));
    if (distance > 0) least = std::min(least, distance);
    prepared.y.push_back(distance);
  }
  for (double& y : prepared.y) {
    y = std::max(y, least);
    if (prepared.below) y = 1 / y;
  }
  std::ranges::sort(prepared.y);
  if (prepared.y.size() < 3 || prepared.y.front() == prepared.y.back())
    throw InputError("a Weibull fit needs three samples or more, not all the same");
  return prepared;
}

Weibull as_sampled(const Prepared& prepared, double threshold, double shape, double scale) {
  if (prepared.below) return {threshold, threshold - 1 / scale, -shape};
  return {threshold, threshold + scale, shape};
}

/// The x in [low, high] at which f passes from negative to positive.
template <class F>
double rising_zero(F f, double low, double high) {
  for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double Weibull::mean() const { return threshold + (characteristic - threshold) * std::tgamma(1 + 1 / shape); }

double Weibull::standard_deviation() const {
  if (shape < 0 && shape >= -2) return infinity;
  const double first = std::tgamma(1 + 1 / shape);
  return std::abs(characteristic - threshold) * std::sqrt(std::max(0.0, std::tgamma(1 + 2 / shape) - first * first));
}

double Weibull::quantile(double p) const {
  return threshold + (characteristic - threshold) * std::pow(-std::log1p(-p), 1 / shape);
}

Weibull weibull_by_moments(std::span<const double> samples, double threshold) {
  const auto prepared = prepare(samples, threshold);
  double mean = 0, square = 0;
  for (const double y : prepared.y) mean += prepared.below ? 1 / y : y;
  mean /= double(prepared.y.size());
  for (const double y : prepared.y) {
    const double off = (prepared.below ? 1 / y : y) - mean;
    square += off * off;
  }
  const double variation = square / double(prepared.y.size() - 1) / (mean * mean);
  // The squared coefficient of variation rises with 1/|b|.
  const double sign = prepared.below ? -1 : 1;
  const double inverse = rising_zero(
      [&](double q) {
        const double first = std::tgamma(1 + sign * q);
        return std::tgamma(1 + 2 * sign * q) / (first * first) - 1 - variation;
      },
      1e-3, prepared.below ? 0.4999 : 20);
  const double scale = mean / std::tgamma(1 + sign * inverse);
  return {threshold, threshold + sign * scale, sign / inverse};
}

Weibull weibull_by_plot(std::span<const double> samples, double threshold) {
  const auto prepared = prepare(samples, threshold);
  const double n = double(prepared.y.size());
  double x = 0, z = 0, xx = 0, xz = 0;
  for (std::size_t i = 0; i < prepared.y.size(); ++i) {
    const double a = std::log(prepared.y[i]), b = std::log(-std::log1p(-(double(i) + 0.7) / (n + 0.4)));
    x += a, z += b, xx += a * a, xz += a * b;
  }
  const double shape = (n * xz - x * z) / (n * xx - x * x);
  return as_sampled(prepared, threshold, shape, std::exp((x - z / shape) / n));
}

WeibullLikelihood weibull_by_likelihood(std::span<const double> samples, double threshold) {
  const auto prepared = prepare(samples, threshold);
  const double n = double(prepared.y.size()), largest = prepared.y.back();
  double mean_log = 0;
  for (const double y : prepared.y) mean_log += std::log(y / largest) / n;
  // Σ y^b ln y/Σ y^b − 1/b = mean ln y
  const auto slope = [&](double b) {
    double powers = 0, weighted = 0;
    for (const double y : prepared.y) {
      const double log = std::log(y / largest), power = std::exp(b * log);
      powers += power, weighted += power * log;
    }
    return weighted / powers - 1 / b - mean_log;
  };
  const double shape = rising_zero(slope, 1e-3, 1e3);
  double powers = 0;
  for (const double y : prepared.y) powers += std::pow(y / largest, shape) / n;
  const double scale = largest * std::pow(powers, 1 / shape);
  // Fisher's information: var ln b = 6/(π² n), var ln θ = (1 + 6 (1 − γ)²/π²)/(n b²).
  constexpr double within = 0.95, euler = std::numbers::egamma;
  const double normal = gsl_cdf_ugaussian_Pinv(0.5 + within / 2);
  const double share = 6 / (M_PI * M_PI), off = normal * std::sqrt(share / n);
  const double along = normal * std::sqrt((1 + share * (1 - euler) * (1 - euler)) / n) / shape;
  WeibullLikelihood result{as_sampled(prepared, threshold, shape, scale), {}, {}};
  for (const int side : {0, 1}) {
    const double sign = side == 0 ? -1 : 1;
    const Weibull end = as_sampled(prepared, threshold, shape * std::exp(sign * off), scale * std::exp(sign * along));
    result.shape_interval[side] = end.shape, result.characteristic_interval[side] = end.characteristic;
  }
  std::ranges::sort(result.shape_interval);
  std::ranges::sort(result.characteristic_interval);
  return result;
}

Summary summarise(std::span<const double> samples) {
  Summary summary;
  summary.count = samples.size();
  if (samples.empty()) return summary;
  std::vector<double> sorted(samples.begin(), samples.end());
  std::ranges::sort(sorted);
  for (const double x : sorted) summary.mean += x / double(sorted.size());
  double square = 0;
  for (const double x : sorted) square += (x - summary.mean) * (x - summary.mean);
  if (sorted.size() > 1) summary.standard_deviation = std::sqrt(square / double(sorted.size() - 1));
  const auto at = [&](double p) {
    const double place = p * double(sorted.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    return low + 1 < sorted.size() ? std::lerp(sorted[low], sorted[low + 1], place - double(low)) : sorted.back();
  };
  summary.minimum = at(0), summary.quarter = at(0.25), summary.median = at(0.5), summary.three_quarters = at(0.75);
  summary.q95 = at(0.95), summary.maximum = at(1);
  return summary;
}

}  // namespace rosin::analysis::studies
