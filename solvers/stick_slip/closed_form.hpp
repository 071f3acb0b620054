/// Motions in closed form, as sums of exponentials and a polynomial, and the certain location of their first zero.
#pragma once
#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "core/signal.hpp"

namespace rosin::solvers::stick_slip {

/// g(τ) = p₀ + p₁τ + p₂τ² + Σ Re(c e^{λτ}) + Σ Re(c (e^{λτ} − e^{μτ})/(λ − μ)), τ ≥ 0. The divided differences stand
/// for what would cancel: resonance and critical damping, exact or nearly so. Real: double or long double.
template <class Real>
class ClosedForm {
 public:
  using Complex = std::complex<Real>;

  /// A constant.
  explicit ClosedForm(Real constant = 0) { polynomial_[0] = constant; }
  /// value + rate·τ + cosines of absolute time, τ = t − t0.
  ClosedForm(const Signal::Piece&, Real t0);
  /// The free and forced motion of m ẍ + c ẋ + k x = f(τ), a signal's piece, with m, k > 0 from x(0), ẋ(0).
  static ClosedForm response(Real mass, Real damping, Real stiffness, const ClosedForm& force, Real x, Real v);

  ClosedForm derivative() const;
  /// The integral from 0, of a signal's piece (no real exponents, polynomial up to τ).
  ClosedForm integral() const;
  ClosedForm& add(Real factor, const ClosedForm&);

  Real operator()(Real tau) const { return derivatives(tau)[0]; }
  /// g and its first three derivatives.
  std::array<Real, 4> derivatives(Real tau) const;
  /// Bounds of |g| … |g''''| from τ on, over a time `window` where terms may grow.
  std::array<Real, 5> bounds(Real tau, Real window) const;
  /// The largest rate |λ| (1/s) of a term that still counts at τ.
  Real fastest(Real tau) const;

  /// The first zero in (from, to] of g, which is positive just after `from`; nothing if there is none. With `leaving`,
  /// g(from) = 0 whatever rounding has made of it, and a zero at `from` itself says that g falls from there. Steps are
  /// so short that, by the bound of g'', no zero lies within them, and double roots are not missed; at a simple root
  /// they converge quadratically.
  std::optional<Real> first_zero(Real from, Real to, bool leaving) const;

 private:
  struct Term {
    Complex coefficient, exponent;
  };
  struct Pair {
    Complex coefficient, first, second;
  };
  struct Fast {  ///< a term with its derivatives' coefficients, as the march evaluates it
    Real decay, frequency, re[3], im[3], size[3];
  };
  bool may_grow() const;
  bool never_negative(Real from, Real to) const;

  std::array<Real, 3> polynomial_{};
  std::vector<Term> terms_;
  std::vector<Pair> pairs_;
};

extern template class ClosedForm<double>;
extern template class ClosedForm<long double>;

}  // namespace rosin::solvers::stick_slip
