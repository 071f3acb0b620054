/// A positive number that may know its logarithm.
#pragma once
#include "core/dual.hpp"

namespace rosin {

namespace detail {
/// A double that can be derived from.
struct PlainDouble {
  double number;
  PlainDouble() = default;
  ROSIN_INLINE PlainDouble(double x) : number(x) {}
  ROSIN_INLINE operator double() const { return number; }
};
template <class Real>
struct BaseNumber {
  using type = Real;
};
template <>
struct BaseNumber<double> {
  using type = PlainDouble;
};
}  // namespace detail

/// A state that solvers carry as its logarithm, as laws see it: a Real in every respect, but log() of it costs nothing
/// where the number was made from its logarithm. (The compiler knows where: what is not used is not computed.)
template <class Real>
class WithLog : public detail::BaseNumber<Real>::type {
  using Base = typename detail::BaseNumber<Real>::type;

 public:
  WithLog() = default;
  ROSIN_INLINE WithLog(const Real& x) : Base(x), known_(false) {}
  /// e^logarithm.
  ROSIN_INLINE static WithLog from_log(const Real& logarithm) {
    WithLog x(exp(logarithm));
    x.log_ = logarithm;
    x.known_ = true;
    return x;
  }
  ROSIN_INLINE friend Real log(const WithLog& x) { return x.known_ ? x.log_ : log(x.base()); }

 private:
  ROSIN_INLINE Real base() const { return *this; }
  Real log_;
  bool known_;
};

}  // namespace rosin
