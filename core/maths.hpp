/// Overflow-free functions that friction laws are built from, for every scalar type (double, Pack, Dual).
#pragma once
#include <numbers>

#include "core/dual.hpp"

namespace rosin {

/// The sign of x: -1, 0 or 1.
template <class Real>
ROSIN_INLINE Real sign(const Real& x) {
  return select(x > Real(0.0), Real(1.0), select(x < Real(0.0), Real(-1.0), Real(0.0)));
}

/// asinh(x), accurate to rounding for small and large x.
template <class Real>
ROSIN_INLINE Real asinh(const Real& x) {
  const Real q = abs(x);
  return sign(x) * log1p(q + q * q / (1.0 + sqrt(1.0 + q * q)));
}

namespace detail {
inline constexpr double asinh_large = 20;  // from here on asinh(e^w) = w + ln 2 to rounding
/// Exponents beyond these have no effect; contacts of e^−500 hold nothing, and the slopes of their slip rate would
/// leave the range of numbers.
inline constexpr double least_exponent = -500, largest_exponent = 700;
template <class Real>
ROSIN_INLINE Real exp_within(const Real& E) {
  return exp(min(max(E, Real(least_exponent)), Real(largest_exponent)));
}
template <class Real>
ROSIN_INLINE auto asinh_exp_is_large(const Real& v, const Real& E) {
  return log(abs(v)) + E > Real(asinh_large);
}
}  // namespace detail

/// asinh(v·e^E): odd and smooth in v, equal to sgn(v)·(ln 2|v| + E) where v·e^E is large, and never overflowing. From
/// E = −500 down as there.
template <class Real>
ROSIN_INLINE Real asinh_exp(const Real& v, const Real& E) {
  const Real w = log(abs(v)) + E;
  return select(w > Real(detail::asinh_large), sign(v) * (w + std::numbers::ln2),
                asinh(Real(v * detail::exp_within(E))));
}
/// asinh(v·e^E) and its derivatives.
template <class Real>
struct AsinhExp {
  Real value, by_v, by_E;
};
template <class Real>
ROSIN_INLINE AsinhExp<Real> asinh_exp_with_slopes(const Real& v, const Real& E) {
  // d/dE = x/sqrt(1+x²), d/dv = e^E/sqrt(1+x²), x = v e^E; both have finite limits where x overflows.
  const auto large = detail::asinh_exp_is_large(v, E);
  const Real growth = detail::exp_within(E);
  const Real x = v * growth, root = 1.0 / sqrt(1.0 + x * x);
  return {asinh_exp(v, E), select(large, Real(1.0 / abs(v)), Real(growth * root)),
          select(large, sign(v), Real(x * root))};
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> asinh_exp(const Dual<Real, n>& v, const Dual<Real, n>& E) {
  const auto f = asinh_exp_with_slopes(v.value, E.value);
  return detail::chain(v, E, f.value, f.by_v, f.by_E);
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> asinh(const Dual<Real, n>& x) {
  return asinh_exp(x, Dual<Real, n>(0.0));
}

/// e^{-E}·sinh(p) and e^{-E}·cosh(p).
template <class Real>
struct SinhCoshExp {
  Real sinh, cosh;
};
template <class Real>
ROSIN_INLINE SinhCoshExp<Real> sinh_cosh_exp(const Real& p, const Real& E) {
  const Real q = abs(p), half = 0.5 * exp(q - max(E, Real(detail::least_exponent))), fall = expm1(-2.0 * q);
  return {sign(p) * (-half * fall), half * (2.0 + fall)};
}
/// e^{-E}·sinh(p), the inverse of asinh_exp: p = asinh_exp(v, E) gives v. No cancellation near p = 0, no early
/// overflow.
template <class Real>
ROSIN_INLINE Real sinh_exp(const Real& p, const Real& E) {
  const Real q = abs(p);
  return sign(p) * (-0.5 * (exp(q - max(E, Real(detail::least_exponent))) * expm1(-2.0 * q)));
}
/// e^{-E}·cosh(p), without early overflow.
template <class Real>
ROSIN_INLINE Real cosh_exp(const Real& p, const Real& E) {
  const Real q = abs(p);
  return 0.5 * (exp(q - max(E, Real(detail::least_exponent))) * (1.0 + exp(-2.0 * q)));
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> sinh_exp(const Dual<Real, n>& p, const Dual<Real, n>& E) {
  const auto f = sinh_cosh_exp(p.value, E.value);
  return detail::chain(p, E, f.sinh, f.cosh, Real(-f.sinh));
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> cosh_exp(const Dual<Real, n>& p, const Dual<Real, n>& E) {
  const auto f = sinh_cosh_exp(p.value, E.value);
  return detail::chain(p, E, f.cosh, f.sinh, Real(-f.cosh));
}

/// tanh(x), accurate to rounding for small and large x.
template <class Real>
ROSIN_INLINE Real tanh(const Real& x) {
  const Real fall = expm1(-2.0 * abs(x));
  return sign(x) * (-fall / (2.0 + fall));
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> tanh(const Dual<Real, n>& x) {
  const Real inverse = 1.0 / cosh_exp(x.value, Real(0.0));
  return detail::chain(x, Real(tanh(x.value)), Real(inverse * inverse));
}

/// arctan(x), accurate to rounding: twice the angle is halved, to where few terms of the series are left.
template <class Real>
ROSIN_INLINE Real arctan(const Real& x) {
  const Real size = abs(x), small = select(size > Real(1.0), Real(1.0 / size), size);  // ≤ 1
  const Real half = small / (1.0 + sqrt(1.0 + small * small)), quarter = half / (1.0 + sqrt(1.0 + half * half));
  const Real square = quarter * quarter;  // ≤ tan²(π/16) = 0.0396
  Real sum = Real(1.0 / 23);
  ROSIN_UNROLL
  for (int k = 21; k > 0; k -= 2) sum = 1.0 / k - square * sum;
  const Real angle = 4.0 * (quarter * sum);
  return sign(x) * select(size > Real(1.0), Real(0.5 * std::numbers::pi - angle), angle);
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> arctan(const Dual<Real, n>& x) {
  return detail::chain(x, Real(arctan(x.value)), Real(1.0 / (1.0 + x.value * x.value)));
}

/// ln(2 sinh p) for p > 0, without overflow.
template <class Real>
ROSIN_INLINE Real log_two_sinh(const Real& p) {
  return p + log(-expm1(-2.0 * p));
}

/// x·ln x for x >= 0, with the limit 0 at x = 0.
template <class Real>
ROSIN_INLINE Real xlogx(const Real& x) {
  return x * log(max(x, Real(1e-300)));
}

/// x^c for x >= 0 and constant c > 0, with 0^c = 0.
template <class Real>
ROSIN_INLINE Real power(const Real& x, const Real& c) {
  return exp(c * log(max(x, Real(1e-300))));
}

/// x^c for x >= 0; NaN for x < 0.
template <class Real>
ROSIN_INLINE Real real_power(const Real& x, const Real& c) {
  return exp(c * log(x));
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> real_power(const Dual<Real, n>& x, const Dual<Real, n>& c) {
  const Real value = real_power(x.value, c.value);
  return detail::chain(x, c, value, Real(c.value * real_power(x.value, Real(c.value - 1.0))),
                       Real(value * log(max(x.value, Real(1e-300)))));
}

/// The greater eigenvalue of a real 2 × 2 matrix with the diagonal (a, d) whose other two elements have the product
/// `feedback` > 0: the rate at which two unknowns grow that feed each other, however fast either forgets.
template <class Real>
ROSIN_INLINE Real greater_eigenvalue(const Real& a, const Real& d, const Real& feedback) {
  const Real middle = 0.5 * (a + d), half = 0.5 * (a - d), root = sqrt(half * half + feedback);
  return select(middle > Real(0.0), Real(middle + root), Real((feedback - a * d) / (root - middle)));
}

}  // namespace rosin
