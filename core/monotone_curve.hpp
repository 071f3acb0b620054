/// A curve through points that never overshoots them: piecewise cubic, for every scalar type, with exact derivatives.
///
/// Slopes at the points are weighted harmonic means of the neighbouring secants (Fritsch & Butland 1984, the PCHIP
/// choice), 0 at local extrema; at the ends the three-point formula, limited to keep the sign and three times the
/// secant. Beyond the ends the curve is constant.
#pragma once
#include <algorithm>
#include <string_view>
#include <vector>

#include "core/dual.hpp"

namespace rosin {

class MonotoneCurve {
 public:
  /// Names stand in messages. \throws InputError unless there are at least two points, all finite, x ascending
  /// strictly.
  MonotoneCurve(const std::vector<double>& x, const std::vector<double>& y, std::string_view x_name = "x",
                std::string_view y_name = "y");

  /// The derivative of the given order (0: the value) at x.
  template <class Real>
  Real operator()(const Real& x, int order = 0) const {
    const double position = double(x);
    if (position < knots_.front()) return Real(order == 0 ? first_ : 0.0);
    if (position > knots_.back()) return Real(order == 0 ? last_ : 0.0);
    const auto after = std::upper_bound(knots_.begin(), knots_.end() - 1, position);  // NaN ends in the last piece
    const std::size_t i = std::size_t(after - knots_.begin()) - 1;
    const auto [c0, c1, c2, c3] = pieces_[i];
    const Real t = x - knots_[i];
    switch (order) {
      case 0:
        return c0 + t * (c1 + t * (c2 + t * c3));
      case 1:
        return c1 + t * (2 * c2 + t * (3 * c3));
      case 2:
        return 2 * c2 + t * (6 * c3);
      case 3:
        return Real(6 * c3);
      default:
        return Real(0.0);
    }
  }
  Pack operator()(const Pack& x, int order = 0) const {
    Pack y(0.0);
    for (int lane = 0; lane < pack_width; ++lane) y.block[lane] = (*this)(double(x.block[lane]), order);
    return y;
  }
  PackPair operator()(const PackPair& x, int order = 0) const {
    return {(*this)(x.half[0], order), (*this)(x.half[1], order)};
  }
  template <class Real, int n>
  Dual<Real, n> operator()(const Dual<Real, n>& x, int order = 0) const {
    return detail::chain(x, (*this)(x.value, order), (*this)(x.value, order + 1));
  }

 private:
  /// c0 + c1 t + c2 t² + c3 t³ with t = x − knot.
  struct Cubic {
    double c0, c1, c2, c3;
  };
  std::vector<double> knots_;
  std::vector<Cubic> pieces_;
  double first_, last_;
};

}  // namespace rosin
