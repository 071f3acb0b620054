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
template <class Real>
ROSIN_INLINE auto asinh_exp_is_large(const Real& v, const Real& E) {
  return log(abs(v)) + E > Real(asinh_large);
}
}  // namespace detail

/// asinh(v·e^E): odd and smooth in v, equal to sgn(v)·(ln 2|v| + E) where v·e^E is large, and never overflowing.
template <class Real>
ROSIN_INLINE Real asinh_exp(const Real& v, const Real& E) {
  const Real w = log(abs(v)) + E;
  return select(w > Real(detail::asinh_large), sign(v) * (w + std::numbers::ln2),
                asinh(Real(v * exp(min(E, Real(700.0))))));
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> asinh_exp(const Dual<Real, n>& v, const Dual<Real, n>& E) {
  // d/dE = x/sqrt(1+x²), d/dv = e^E/sqrt(1+x²), x = v e^E; both have finite limits where x overflows.
  const auto large = detail::asinh_exp_is_large(v.value, E.value);
  const Real growth = exp(min(E.value, Real(700.0)));
  const Real x = v.value * growth, root = 1.0 / sqrt(1.0 + x * x);
  const Real by_E = select(large, sign(v.value), Real(x * root));
  const Real by_v = select(large, Real(1.0 / abs(v.value)), Real(growth * root));
  return detail::chain(v, E, asinh_exp(v.value, E.value), by_v, by_E);
}

/// e^{-E}·sinh(p), the inverse of asinh_exp: p = asinh_exp(v, E) gives v. No cancellation near p = 0, no early
/// overflow.
template <class Real>
ROSIN_INLINE Real sinh_exp(const Real& p, const Real& E) {
  const Real q = abs(p);
  return sign(p) * (-0.5 * (exp(q - E) * expm1(-2.0 * q)));
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> sinh_exp(const Dual<Real, n>& p, const Dual<Real, n>& E) {
  const Real q = abs(p.value), half = 0.5 * exp(q - E.value), fall = expm1(-2.0 * q);
  const Real value = sign(p.value) * (-half * fall), cosh = half * (2.0 + fall);
  return detail::chain(p, E, value, cosh, Real(-value));
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

}  // namespace rosin
