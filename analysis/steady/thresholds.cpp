/// Thresholds bracketed between values and located to what rounding of the eigenvalues leaves.
#include "analysis/steady/thresholds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "core/stop.hpp"

namespace rosin::analysis::steady {

namespace {

using LeadingAt = std::function<Leading(double)>;

struct Point {
  double value;
  Leading leading;
};

/// y at x = 0 of the polynomial through the points (Neville), and the change by the last of them.
struct Continued {
  double value, change;
};
Continued continue_to_0(std::span<const double> x, std::span<const double> of) {
  std::vector<double> y(of.begin(), of.end());
  double before = y[0];
  for (std::size_t column = 1; column < y.size(); ++column) {
    before = y[0];
    for (std::size_t k = 0; k + column < y.size(); ++k)
      y[k] = (x[k] * y[k + 1] - x[k + column] * y[k]) / (x[k] - x[k + column]);
  }
  return {y[0], std::abs(y[0] - before)};
}

constexpr double rounding = 4e-16;

/// Where the rate is neutral up to the threshold, the value and the frequency are continued to it from growth: as
/// functions of the rate, or of its square where it begins as a root. \param reach  a value up to which it grows
void continue_from_growth(const LeadingAt& at, double edge, double reach, Crossing& crossing) {
  constexpr std::size_t points = 7;
  const double size = std::max(std::abs(edge), 1e-300);
  crossing.value = edge, crossing.error = infinity;
  constexpr double first = 0.03, last = 1e-9, finer = 0.25;
  for (double distance = std::min(std::abs(reach - edge), first * size); distance > last * size; distance *= finer) {
    std::array<double, points> value, rate, frequency;
    double noise = 0;
    bool usable = true;
    for (std::size_t k = 0; k < points; ++k) {
      value[k] = edge + std::copysign(distance, reach - edge) * double(k + 1) / points;
      const auto there = at(value[k]);
      rate[k] = there.growth, frequency[k] = there.angular_frequency;
      usable = usable && there.grows() && (k == 0 || rate[k] > rate[k - 1]);
      noise = std::max(noise, there.error / rate[k]);
    }
    if (!usable) continue;
    // A root doubles from the first to the fourth point, a line makes four of one.
    const bool is_root = rate[3] / rate[0] < 2.8;
    if (is_root)
      for (auto& r : rate) r *= r;
    // Points more bring the polynomial closer, and amplify rounding.
    for (std::size_t count = 3; count <= points; ++count) {
      const std::span<const double> rates(rate.data(), count);
      const auto there = continue_to_0(rates, std::span(value).first(count)),
                 turns = continue_to_0(rates, std::span(frequency).first(count));
      const double amplifies = double(1 << count) * double(count) / points;
      const double error = there.change + amplifies * noise * distance + rounding * size;
      if (error < crossing.error)
        crossing.value = there.value, crossing.error = error, crossing.angular_frequency = turns.value;
    }
  }
  if (!std::isfinite(crossing.error)) crossing.error = std::sqrt(rounding) * size;
}

/// Between a value where nothing grows and one where something does.
Crossing locate(const LeadingAt& at, Point calm, Point growing) {
  const bool neutral = calm.leading.is_neutral();
  const double reach = growing.value;
  // By the growth rates, and by halves where they do not help, until the two are neighbours.
  constexpr int most = 200;
  for (int i = 0; i < most; ++i) {
    const double width = std::abs(growing.value - calm.value);
    if (width <= rounding * std::max(std::abs(growing.value), std::abs(calm.value))) break;
    double next = 0.5 * (calm.value + growing.value);
    if (const double a = calm.leading.growth, b = growing.leading.growth; i % 3 != 2 && a < 0 && !neutral) {
      next = calm.value - a / (b - a) * (growing.value - calm.value);
      // A little beyond the root: the end that is farther comes close too.
      if (i % 3 == 1) next += (-a < b ? 1 : -1) * 1e-3 * std::min(-a, b) / (b - a) * (growing.value - calm.value);
    }
    if (!(next > std::min(calm.value, growing.value) && next < std::max(calm.value, growing.value)))
      next = 0.5 * (calm.value + growing.value);
    if (next == calm.value || next == growing.value) break;
    Point point{next, at(next)};
    const bool above = neutral ? point.leading.grows() : point.leading.growth > 0;
    (above ? growing : calm) = std::move(point);
  }
  Crossing crossing{};
  crossing.onset = growing.value > calm.value;
  crossing.angular_frequency = growing.leading.angular_frequency;
  if (neutral) {
    continue_from_growth(at, growing.value, reach, crossing);
    return crossing;
  }
  crossing.value = 0.5 * (calm.value + growing.value);
  // What the error of the rate leaves open, by the slope of the rate.
  const double size = std::max(std::abs(crossing.value), 1e-300), aside = 1e-6 * size;
  const double slope = (at(crossing.value + aside).growth - at(crossing.value - aside).growth) / (2 * aside);
  crossing.error = std::abs(growing.value - calm.value) + growing.leading.error / std::abs(slope) + rounding * size;
  return crossing;
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

std::vector<Crossing> crossings(const std::function<Leading(double)>& at, const std::vector<double>& values) {
  std::vector<Crossing> found;
  std::vector<Point> points;
  for (const double value : values) points.push_back({value, at(value)});
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Leading &low = points[i].leading, &high = points[i + 1].leading;
    if (low.grows() != high.grows()) {
      found.push_back(high.grows() ? locate(at, points[i], points[i + 1]) : locate(at, points[i + 1], points[i]));
      continue;
    }
    // A window of growth may lie between the values where the rate has a maximum near 0.
    if (low.grows() || i == 0 || low.growth < points[i - 1].leading.growth || low.growth < high.growth ||
        low.is_neutral() || points[i - 1].leading.grows())
      continue;
    double left = points[i - 1].value, right = points[i + 1].value;
    constexpr double golden = 0.6180339887498949;
    for (int k = 0; k < 40; ++k) {
      const double a = right - golden * (right - left), b = left + golden * (right - left);
      const Point at_a{a, at(a)}, at_b{b, at(b)};
      const bool falls = at_a.leading.growth > at_b.leading.growth;
      if (const Point& higher = falls ? at_a : at_b; higher.leading.grows()) {
        found.push_back(locate(at, points[i - 1], higher));
        found.push_back(locate(at, points[i + 1], higher));
        break;
      }
      (falls ? right : left) = falls ? b : a;
    }
  }
  std::ranges::sort(found, {}, &Crossing::value);
  return found;
}

Scan scan(const std::function<StructureStability(double)>& stability_at, std::vector<double> values) {
  Scan result;
  std::map<double, Leading> known;
  const auto leading = [&](const StructureStability& stability) {
    const auto& mode = stability.modes.front();
    return Leading{mode.growth_rate(), mode.error, std::abs(mode.eigenvalue.imag())};
  };
  for (const double value : values) {
    end_if_stopped();
    const auto there = stability_at(value);
    known[value] = leading(there);
    result.eigenvalues.push_back(
        result.eigenvalues.empty() ? there.eigenvalues : in_order_of(result.eigenvalues.back(), there.eigenvalues));
  }
  const auto at = [&](double value) {
    const auto found = known.find(value);
    return found != known.end() ? found->second : leading(stability_at(value));
  };
  for (const auto& crossing : crossings(at, values))
    result.thresholds.push_back({crossing, stability_at(crossing.value)});
  result.values = std::move(values);
  return result;
}

}  // namespace rosin::analysis::steady
