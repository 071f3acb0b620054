/// Thresholds bracketed between values and located to what rounding of the eigenvalues leaves.
#include "analysis/steady/thresholds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/stop.hpp"

namespace rosin::analysis::steady {

namespace {

double growth(const StructureStability& s) { return s.modes.front().growth_rate(); }
/// Grows by more than the error of its rate.
bool grows(const StructureStability& s) { return growth(s) > s.modes.front().error; }
bool is_neutral(const StructureStability& s) { return std::abs(growth(s)) <= s.modes.front().error; }

struct Point {
  double value;
  StructureStability stability;
};

/// y at x = 0 of the polynomial through the points (Neville), and the change by the last of them.
struct Continued {
  double value, change;
};
template <std::size_t points>
Continued continue_to_0(const std::array<double, points>& x, std::array<double, points> y) {
  double before = y[0];
  for (std::size_t column = 1; column < points; ++column) {
    before = y[0];
    for (std::size_t k = 0; k + column < points; ++k)
      y[k] = (x[k] * y[k + 1] - x[k + column] * y[k]) / (x[k] - x[k + column]);
  }
  return {y[0], std::abs(y[0] - before)};
}

constexpr double rounding = 4e-16;

/// Where the rate is neutral up to the threshold, the value and the frequency are continued to it from growth: as
/// functions of the rate, or of its square where it begins as a root.
void continue_from_growth(const std::function<StructureStability(double)>& at, double edge, Threshold& threshold) {
  constexpr std::size_t points = 7;
  const double direction = threshold.onset ? 1 : -1, size = std::max(std::abs(edge), 1e-300);
  threshold.value = edge, threshold.error = infinity;
  for (const double distance : {3e-2, 1e-2, 3e-3, 1e-3, 3e-4}) {
    std::array<double, points> value, rate, frequency;
    double noise = 0;
    bool usable = true;
    for (std::size_t k = 0; k < points; ++k) {
      value[k] = edge + direction * distance * size * double(k + 1) / points;
      const auto there = at(value[k]);
      rate[k] = growth(there), frequency[k] = std::abs(there.modes.front().eigenvalue.imag());
      usable = usable && grows(there) && (k == 0 || rate[k] > rate[k - 1]);
      noise = std::max(noise, there.modes.front().error / rate[k]);
    }
    if (!usable) continue;
    // A root doubles from the first to the fourth point, a line makes four of one.
    const bool is_root = rate[3] / rate[0] < 2.8;
    if (is_root)
      for (auto& r : rate) r *= r;
    constexpr double amplifies = 60;  // rounding, by the continuation
    const auto there = continue_to_0(rate, value), turns = continue_to_0(rate, frequency);
    const double error = there.change + amplifies * noise * distance * size + rounding * size;
    if (error < threshold.error)
      threshold.value = there.value, threshold.error = error, threshold.angular_frequency = turns.value;
  }
  if (!std::isfinite(threshold.error)) threshold.error = std::sqrt(rounding) * size;
}

/// Threshold between a value where nothing grows and one where something does.
Threshold locate(const std::function<StructureStability(double)>& at, Point calm, Point growing) {
  const bool neutral = is_neutral(calm.stability);
  // By the growth rates, and by halves where they do not help, until the two are neighbours.
  constexpr int most = 200;
  for (int i = 0; i < most; ++i) {
    const double width = std::abs(growing.value - calm.value);
    if (width <= rounding * std::max(std::abs(growing.value), std::abs(calm.value))) break;
    double next = 0.5 * (calm.value + growing.value);
    if (const double a = growth(calm.stability), b = growth(growing.stability); i % 3 != 2 && a < 0 && !neutral) {
      next = calm.value - a / (b - a) * (growing.value - calm.value);
      // A little beyond the root: the end that is farther comes close too.
      if (i % 3 == 1) next += (-a < b ? 1 : -1) * 1e-3 * std::min(-a, b) / (b - a) * (growing.value - calm.value);
    }
    if (!(next > std::min(calm.value, growing.value) && next < std::max(calm.value, growing.value)))
      next = 0.5 * (calm.value + growing.value);
    if (next == calm.value || next == growing.value) break;
    Point point{next, at(next)};
    const bool above = neutral ? grows(point.stability) : growth(point.stability) > 0;
    (above ? growing : calm) = std::move(point);
  }
  Threshold threshold{};
  threshold.onset = growing.value > calm.value;
  const auto& mode = growing.stability.modes.front();
  threshold.angular_frequency = std::abs(mode.eigenvalue.imag());
  if (neutral) {
    continue_from_growth(at, growing.value, threshold);
  } else {
    threshold.value = 0.5 * (calm.value + growing.value);
    // What the error of the rate leaves open, by the slope of the rate.
    const double size = std::max(std::abs(threshold.value), 1e-300), aside = 1e-6 * size;
    const double slope = (growth(at(threshold.value + aside)) - growth(at(threshold.value - aside))) / (2 * aside);
    threshold.error = std::abs(growing.value - calm.value) + mode.error / std::abs(slope) + rounding * size;
  }
  threshold.at = at(threshold.value);
  return threshold;
}

/// Continues each branch of eigenvalues to the nearest of the next ones.
std::vector<std::complex<double>> in_order_of(const std::vector<std::complex<double>>& before,
                                              std::vector<std::complex<double>> now) {
  std::vector<std::complex<double>> ordered;
  for (const auto& z : before) {
    if (now.empty()) break;
    const auto nearest = std::ranges::min_element(now, {}, [&](auto w) { return std::abs(w - z); });
    ordered.push_back(*nearest);
    now.erase(nearest);
  }
  ordered.insert(ordered.end(), now.begin(), now.end());
  return ordered;
}

}  // namespace

Scan scan(const std::function<StructureStability(double)>& stability_at, std::vector<double> values) {
  Scan result;
  std::vector<Point> points;
  for (const double value : values) {
    end_if_stopped();
    points.push_back({value, stability_at(value)});
    const auto& found = points.back().stability.eigenvalues;
    result.eigenvalues.push_back(points.size() == 1 ? found : in_order_of(result.eigenvalues.back(), found));
  }
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const bool low = grows(points[i].stability), high = grows(points[i + 1].stability);
    if (low != high) {
      result.thresholds.push_back(high ? locate(stability_at, points[i], points[i + 1])
                                       : locate(stability_at, points[i + 1], points[i]));
      continue;
    }
    // A window of growth may lie between the values where the rate has a maximum near 0.
    if (low || i == 0 || growth(points[i].stability) < growth(points[i - 1].stability) ||
        growth(points[i].stability) < growth(points[i + 1].stability) || is_neutral(points[i].stability) ||
        grows(points[i - 1].stability))
      continue;
    double left = points[i - 1].value, right = points[i + 1].value;
    constexpr double golden = 0.6180339887498949;
    for (int k = 0; k < 40; ++k) {
      const double a = right - golden * (right - left), b = left + golden * (right - left);
      Point at_a{a, stability_at(a)}, at_b{b, stability_at(b)};
      Point& higher = growth(at_a.stability) > growth(at_b.stability) ? at_a : at_b;
      if (grows(higher.stability)) {
        result.thresholds.push_back(locate(stability_at, points[i - 1], higher));
        result.thresholds.push_back(locate(stability_at, points[i + 1], higher));
        break;
      }
      (&higher == &at_a ? right : left) = &higher == &at_a ? b : a;
    }
  }
  result.values = std::move(values);
  std::ranges::sort(result.thresholds, {}, &Threshold::value);
  return result;
}

}  // namespace rosin::analysis::steady
