/// The border of stability on the grid lines, joined to polylines.
#include "analysis/planes/borders.hpp"

#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "analysis/steady/stability.hpp"

namespace rosin::analysis::planes {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

class Tracer {
 public:
  Tracer(const Model& model, const Axis& x, const Axis& y) : model_(model), x_(x), y_(y) {}

  Polyline trace(const std::vector<Side>& sides) {
    Polyline line;
    auto &line_x = line.x, &line_y = line.y;
    const int nx = x_.regular, ny = y_.regular;
    const auto side = [&](int i, int j) { return sides[std::size_t(j) * x_.values.size() + i]; };
    // Only the points beside the border matter.
    std::vector<double> growth(nx * ny, nothing);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        bool near = side(i, j) == Side::unknown;
        for (const auto& [di, dj] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
          if (i + di >= 0 && i + di < nx && j + dj >= 0 && j + dj < ny) near |= side(i + di, j + dj) != side(i, j);
        if (near) growth[j * nx + i] = growth_at(x_.values[i], y_.values[j]);
      }
    // Zeros on the edges of the grid: horizontal edges first, then vertical ones.
    std::vector<std::optional<Point>> crossing(nx * ny * 2);
    const auto edge = [&](int i, int j, bool vertical) { return (j * nx + i) * 2 + vertical; };
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (i + 1 < nx) crossing[edge(i, j, false)] = locate(growth[j * nx + i], growth[j * nx + i + 1], i, j, false);
        if (j + 1 < ny) crossing[edge(i, j, true)] = locate(growth[j * nx + i], growth[(j + 1) * nx + i], i, j, true);
      }
    // Within each cell the line runs from crossing to crossing.
    std::vector<std::vector<int>> neighbours(crossing.size());
    for (int j = 0; j + 1 < ny; ++j)
      for (int i = 0; i + 1 < nx; ++i) {
        std::vector<int> met;  // around the cell
        for (const int e : {edge(i, j, false), edge(i + 1, j, true), edge(i, j + 1, false), edge(i, j, true)})
          if (crossing[e]) met.push_back(e);
        for (std::size_t k = 0; k + 1 < met.size(); k += 2) {
          neighbours[met[k]].push_back(met[k + 1]);
          neighbours[met[k + 1]].push_back(met[k]);
        }
      }
    std::vector<bool> used(crossing.size());
    const auto follow = [&](int first) {
      if (!line_x.empty()) line_x.push_back(nothing), line_y.push_back(nothing);
      for (int at = first; at >= 0;) {
        used[at] = true;
        line_x.push_back(crossing[at]->x);
        line_y.push_back(crossing[at]->y);
        int next = -1;
        for (const int n : neighbours[at])
          if (!used[n]) next = n;
        at = next;
      }
    };
    for (const bool ends_only : {true, false})  // open lines from an end, then closed ones
      for (int e = 0; e < int(crossing.size()); ++e)
        if (crossing[e] && !used[e] && (!ends_only || neighbours[e].size() < 2)) follow(e);
    return line;
  }

 private:
  struct Point {
    double x, y;
  };
  /// Largest real part of the eigenvalues; NaN where sliding has none or it is within rounding of zero.
  double growth_at(double x, double y) const {
    try {
      const auto s = steady::stability(model_.with(x_.parameter, x).with(y_.parameter, y));
      return s.eigenvalues.empty() || s.marginal ? nothing : s.eigenvalues.front().real();
    } catch (const InputError&) {
      return nothing;
    }
  }
  std::optional<Point> locate(double low, double high, int i, int j, bool vertical) const {
    if (!std::isfinite(low) || !std::isfinite(high) || (low > 0) == (high > 0)) return std::nullopt;
    const Axis& axis = vertical ? y_ : x_;
    const int first = vertical ? j : i;
    const double a = axis.values[first], b = axis.values[first + 1];
    const auto value = [&](double w) { return axis.logarithmic ? std::exp(w) : w; };
    const auto coordinate = [&](double v) { return axis.logarithmic ? std::log(v) : v; };
    const auto point = [&](double v) { return vertical ? Point{x_.values[i], v} : Point{v, y_.values[j]}; };
    std::uintmax_t iterations = 100;
    const auto rate = [&](double w) {
      const Point p = point(value(w));
      const double g = growth_at(p.x, p.y);
      return std::isfinite(g) ? g : 0.0;  // within rounding of zero: found
    };
    const bool ascending = a < b;  // as the root finder wants it, whichever way the axis runs
    const auto [l, h] = boost::math::tools::toms748_solve(
        rate, coordinate(ascending ? a : b), coordinate(ascending ? b : a), ascending ? low : high,
        ascending ? high : low, boost::math::tools::eps_tolerance<double>(52), iterations);
    const Point numeric = point(value(0.5 * (l + h)));
    // Where the load is one of the axes, its closed form is free of the eigenvalues' rounding.
    for (const bool load_is_y : {false, true}) {
      if ((load_is_y ? y_ : x_).parameter != "drive.normal_load") continue;
      const auto closed = steady::critical_load(model_.with(x_.parameter, numeric.x).with(y_.parameter, numeric.y));
      const double here = load_is_y ? numeric.y : numeric.x;
      if (closed && std::abs(closed->normal_load / here - 1) < 1e-6)
        return load_is_y ? Point{numeric.x, closed->normal_load} : Point{closed->normal_load, numeric.y};
    }
    return numeric;
  }

  const Model& model_;
  const Axis &x_, &y_;
};

}  // namespace

Polyline threshold_of_sliding(const Model& model, const Axis& x, const Axis& y, const std::vector<Side>& sides) {
  return Tracer(model, x, y).trace(sides);
}

}  // namespace rosin::analysis::planes
