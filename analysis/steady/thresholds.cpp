/// Thresholds bracketed between values and located to what rounding of the eigenvalues leaves.
#include "analysis/steady/thresholds.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <span>

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

/// Around a value without steady sliding, as where friction locks the structure: closes in on it from both sides.
void close_in(const LeadingAt& at, Point& calm, Point& growing, double lost) {
  constexpr int most = 60;
  for (Point* side : {&calm, &growing}) {
    double far = lost;
    for (int i = 0; i < most; ++i) {
      const double next = 0.5 * (side->value + far);
      if (next == side->value || next == far) break;
      const Point point{next, at(next)};
      if (std::isnan(point.leading.growth))
        far = next;
      else if ((point.leading.growth > 0) == (side == &growing))
        *side = point;
      else
        break;
    }
  }
}

/// Between a value where nothing grows and one where something does.
Crossing locate(const LeadingAt& at, Point calm, Point growing) {
  const bool neutral = calm.leading.is_neutral();
  const double reach = growing.value, low = std::min(calm.value, reach), high = std::max(calm.value, reach);
  // By the growth rates, and by halves where they do not help, until the two are neighbours.
  constexpr int most = 200;
  bool lost = false;
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
    if (std::isnan(point.leading.growth)) {
      close_in(at, calm, growing, next);
      lost = true;
      break;
    }
    const bool above = neutral ? point.leading.grows() : point.leading.growth > 0;
    (above ? growing : calm) = std::move(point);
  }
  Crossing crossing{};
  crossing.onset = growing.value > calm.value;
  crossing.angular_frequency = growing.leading.angular_frequency;
  if (neutral && !lost) {
    continue_from_growth(at, growing.value, reach, crossing);
    // Growth that hardly rises from its error is continued beyond all that was looked at: it may begin anywhere there.
    if (const double inside = std::clamp(crossing.value, low, high); inside != crossing.value)
      crossing.value = inside, crossing.error = std::max(crossing.error, high - low);
    return crossing;
  }
  crossing.value = 0.5 * (calm.value + growing.value);
  crossing.error = std::abs(growing.value - calm.value) + rounding * std::abs(crossing.value);
  if (lost) return crossing;
  // What the error of the rate leaves open, by the slope of the rate.
  const double aside = 1e-6 * std::max(std::abs(crossing.value), 1e-300);
  const double below = std::max(crossing.value - aside, low), above = std::min(crossing.value + aside, high);
  const double slope = (at(above).growth - at(below).growth) / (above - below);
  constexpr double entries = 4;  // whose own rounding, by the derivatives of laws, the error of the rate leaves out
  crossing.error += entries * growing.leading.error / std::abs(slope);
  return crossing;
}

}  // namespace

Crossing locate(const std::function<Leading(double)>& at, double calm, double growing) {
  return locate(at, Point{calm, at(calm)}, Point{growing, at(growing)});
}

std::vector<Crossing> crossings(const std::function<Leading(double)>& at, const std::vector<double>& values) {
  std::vector<Crossing> found;
  std::vector<Point> points;
  for (const double value : values)
    if (const auto there = at(value); !std::isnan(there.growth)) points.push_back({value, there});
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
    Point highest{0, {-infinity, 0, 0}};
    std::uintmax_t most = 40;
    boost::math::tools::brent_find_minima(
        [&](double value) {
          const Point here{value, at(value)};
          if (here.leading.growth > highest.leading.growth) highest = here;
          return -here.leading.growth;
        },
        points[i - 1].value, points[i + 1].value, std::numeric_limits<double>::digits / 2, most);
    if (!highest.leading.grows()) continue;
    found.push_back(locate(at, points[i - 1], highest));
    found.push_back(locate(at, points[i + 1], highest));
  }
  std::ranges::sort(found, {}, &Crossing::value);
  return found;
}

}  // namespace rosin::analysis::steady
