/// Dual numbers: a value with its first derivatives in n directions; nested, they give higher derivatives.
///
/// `Real` is double, Pack, or a Dual again. Functions that laws use are overloaded here, so that a law written once
/// over a scalar type yields values, Jacobians, SIMD batches of both, and the third derivatives of the first Lyapunov
/// coefficient.
#pragma once
#include <cmath>
#include <type_traits>

#include "core/pack_pair.hpp"

namespace rosin {

using std::abs;
using std::exp;
using std::expm1;
using std::log;
using std::log1p;
using std::max;
using std::min;
using std::sqrt;

ROSIN_INLINE double select(bool which, double a, double b) { return which ? a : b; }
template <class Real, int n>
struct Dual {
  Real value;
  Real slope[n];

  Dual() = default;
  ROSIN_INLINE Dual(double x) : value(x) {
    for (auto& s : slope) s = Real(0.0);
  }
  ROSIN_INLINE Dual(const Real& x) requires(!std::is_same_v<Real, double>) : value(x) {
    for (auto& s : slope) s = Real(0.0);
  }
  /// The independent variable number `direction`, at x.
  static Dual variable(const Real& x, int direction) {
    Dual d(x);
    d.slope[direction] = Real(1.0);
    return d;
  }
};

namespace detail {
/// f(a) from its value and derivative at a.value.
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> chain(const Dual<Real, n>& a, const Real& value, const Real& derivative) {
  Dual<Real, n> r;
  r.value = value;
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) r.slope[i] = derivative * a.slope[i];
  return r;
}
template <class Real, int n>
ROSIN_INLINE Dual<Real, n> chain(const Dual<Real, n>& a, const Dual<Real, n>& b, const Real& value, const Real& by_a,
                                 const Real& by_b) {
  Dual<Real, n> r;
  r.value = value;
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) r.slope[i] = by_a * a.slope[i] + by_b * b.slope[i];
  return r;
}
}  // namespace detail

// Operands are taken as (Dual, Dual); a double on either side converts through these friends-like overloads.
#define ROSIN_DUAL             \
  template <class Real, int n> \
  ROSIN_INLINE

ROSIN_DUAL Dual<Real, n> operator+(const Dual<Real, n>& a, const Dual<Real, n>& b) {
  Dual<Real, n> r;
  r.value = a.value + b.value;
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) r.slope[i] = a.slope[i] + b.slope[i];
  return r;
}
ROSIN_DUAL Dual<Real, n> operator-(const Dual<Real, n>& a, const Dual<Real, n>& b) {
  Dual<Real, n> r;
  r.value = a.value - b.value;
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) r.slope[i] = a.slope[i] - b.slope[i];
  return r;
}
ROSIN_DUAL Dual<Real, n> operator-(const Dual<Real, n>& a) {
  Dual<Real, n> r;
  r.value = -a.value;
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) r.slope[i] = -a.slope[i];
  return r;
}
ROSIN_DUAL Dual<Real, n> operator*(const Dual<Real, n>& a, const Dual<Real, n>& b) {
  return detail::chain(a, b, Real(a.value * b.value), b.value, a.value);
}
ROSIN_DUAL Dual<Real, n> operator/(const Dual<Real, n>& a, const Dual<Real, n>& b) {
  const Real inverse = 1.0 / b.value, quotient = a.value / b.value;
  return detail::chain(a, b, quotient, inverse, Real(-quotient * inverse));
}
ROSIN_DUAL Dual<Real, n> operator+(const Dual<Real, n>& a, double b) {
  return detail::chain(a, Real(a.value + b), Real(1.0));
}
ROSIN_DUAL Dual<Real, n> operator+(double a, const Dual<Real, n>& b) { return b + a; }
ROSIN_DUAL Dual<Real, n> operator-(const Dual<Real, n>& a, double b) { return a + (-b); }
ROSIN_DUAL Dual<Real, n> operator-(double a, const Dual<Real, n>& b) { return -b + a; }
ROSIN_DUAL Dual<Real, n> operator*(const Dual<Real, n>& a, double b) {
  return detail::chain(a, Real(a.value * b), Real(b));
}
ROSIN_DUAL Dual<Real, n> operator*(double a, const Dual<Real, n>& b) { return b * a; }
ROSIN_DUAL Dual<Real, n> operator/(const Dual<Real, n>& a, double b) {
  return detail::chain(a, Real(a.value / b), Real(1.0 / b));
}
ROSIN_DUAL Dual<Real, n> operator/(double a, const Dual<Real, n>& b) {
  const Real quotient = a / b.value;
  return detail::chain(b, quotient, Real(-quotient / b.value));
}

ROSIN_DUAL auto operator<(const Dual<Real, n>& a, const Dual<Real, n>& b) { return a.value < b.value; }
ROSIN_DUAL auto operator>(const Dual<Real, n>& a, const Dual<Real, n>& b) { return a.value > b.value; }
ROSIN_DUAL auto operator<(const Dual<Real, n>& a, double b) { return a.value < b; }
ROSIN_DUAL auto operator>(const Dual<Real, n>& a, double b) { return a.value > b; }

template <class Condition, class Real, int n>
ROSIN_INLINE Dual<Real, n> select(const Condition& which, const Dual<Real, n>& a, const Dual<Real, n>& b) {
  Dual<Real, n> r;
  r.value = select(which, a.value, b.value);
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) r.slope[i] = select(which, a.slope[i], b.slope[i]);
  return r;
}
ROSIN_DUAL Dual<Real, n> abs(const Dual<Real, n>& a) { return select(a < 0.0, -a, a); }
ROSIN_DUAL Dual<Real, n> max(const Dual<Real, n>& a, const Dual<Real, n>& b) { return select(a < b, b, a); }
ROSIN_DUAL Dual<Real, n> min(const Dual<Real, n>& a, const Dual<Real, n>& b) { return select(b < a, b, a); }

ROSIN_DUAL Dual<Real, n> exp(const Dual<Real, n>& a) {
  const Real e = exp(a.value);
  return detail::chain(a, e, e);
}
ROSIN_DUAL Dual<Real, n> expm1(const Dual<Real, n>& a) {
  return detail::chain(a, Real(expm1(a.value)), Real(exp(a.value)));
}
ROSIN_DUAL Dual<Real, n> log(const Dual<Real, n>& a) {
  return detail::chain(a, Real(log(a.value)), Real(1.0 / a.value));
}
ROSIN_DUAL Dual<Real, n> log1p(const Dual<Real, n>& a) {
  return detail::chain(a, Real(log1p(a.value)), Real(1.0 / (1.0 + a.value)));
}
ROSIN_DUAL Dual<Real, n> sqrt(const Dual<Real, n>& a) {
  const Real root = sqrt(a.value);
  return detail::chain(a, root, Real(0.5 / root));
}

#undef ROSIN_DUAL

/// A value with its first three derivatives along one direction.
using Tower = Dual<Dual<Dual<double, 1>, 1>, 1>;

}  // namespace rosin
