/// Sums of exponentials: building them from an oscillator's data, evaluating, bounding, and marching to a zero.
#include "solvers/stick_slip/closed_form.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rosin::solvers::stick_slip {

namespace {

template <class Real>
constexpr Real epsilon = std::numeric_limits<Real>::epsilon();
template <class Real>
constexpr Real endless = std::numeric_limits<Real>::infinity();

/// e^z − 1 without cancellation.
template <class Real>
std::complex<Real> exp_minus_one(std::complex<Real> z) {
  const Real half = std::sin(z.imag() / 2), growth = std::expm1(z.real());
  return {growth * std::cos(z.imag()) - 2 * half * half, (growth + 1) * std::sin(z.imag())};
}

/// (e^{λτ} − e^{μτ})/(λ − μ), also where λ and μ coincide.
template <class Real>
std::complex<Real> divided_difference(std::complex<Real> first, std::complex<Real> second, Real tau) {
  const auto difference = first - second;
  const auto z = difference * tau;
  const auto quotient = std::abs(z) < Real(1e-12L) ? tau * (Real(1) + z / Real(2)) : exp_minus_one(z) / difference;
  return std::exp(second * tau) * quotient;
}

}  // namespace

template <class Real>
ClosedForm<Real>::ClosedForm(const Signal::Piece& piece, Real t0) {
  polynomial_ = {Real(piece.value), Real(piece.rate), 0};
  for (const auto& term : piece.terms) {
    const Real omega = term.angular_frequency;
    terms_.push_back({std::polar(Real(1), omega * t0 + Real(term.phase)) * Real(term.amplitude), {0, omega}});
  }
}

template <class Real>
ClosedForm<Real> ClosedForm<Real>::response(Real m, Real c, Real k, const ClosedForm& force, Real x0, Real v0) {
  ClosedForm x;
  const auto& f = force.polynomial_;
  x.polynomial_ = {(f[0] - c * f[1] / k) / k, f[1] / k, 0};
  const Real alpha = c / (2 * m), natural = std::sqrt(k / m);
  // β² = α² − ω₀², free of cancellation
  const Real beta = std::sqrt(std::abs((alpha - natural) * (alpha + natural)));
  const bool over = alpha > natural;
  const Complex slow = over ? Complex(-natural * natural / (alpha + beta)) : Complex(-alpha, beta);
  const Complex quick = over ? Complex(-alpha - beta) : Complex(-alpha, -beta);

  for (const auto& [amplitude, exponent] : force.terms_) {
    const Real omega = exponent.imag();
    const Complex dynamic{m * (natural - omega) * (natural + omega), c * omega};
    if (over || std::abs(dynamic) > Real(1e-3) * k) {
      x.terms_.push_back({amplitude / dynamic, exponent});
    } else {  // near resonance: the particular motion that begins from rest
      const Complex share = amplitude / (m * (slow - quick)), far = share / (exponent - quick);
      x.pairs_.push_back({share, exponent, slow});
      x.terms_.push_back({-far, exponent});
      x.terms_.push_back({far, quick});
    }
  }

  const auto particular = x.derivatives(0);
  const Real X = x0 - particular[0], V = v0 - particular[1];
  if (beta < Real(0.03) * natural) {  // near critical damping
    x.terms_.push_back({Complex(X), slow});
    x.pairs_.push_back({V - slow * X, slow, quick});
  } else if (over) {
    const Real gap = 2 * beta;
    x.terms_.push_back({Complex((V - quick.real() * X) / gap), slow});
    x.terms_.push_back({Complex((slow.real() * X - V) / gap), quick});
  } else {
    x.terms_.push_back({Complex(X, -(V + alpha * X) / beta), slow});
  }
  return x;
}

template <class Real>
ClosedForm<Real> ClosedForm<Real>::derivative() const {
  ClosedForm d;
  d.polynomial_ = {polynomial_[1], 2 * polynomial_[2], 0};
  for (const auto& [c, lambda] : terms_) d.terms_.push_back({c * lambda, lambda});
  for (const auto& [c, lambda, mu] : pairs_) {
    d.pairs_.push_back({c * lambda, lambda, mu});
    d.terms_.push_back({c, mu});
  }
  return d;
}

template <class Real>
ClosedForm<Real> ClosedForm<Real>::integral() const {
  ClosedForm sum;
  sum.polynomial_ = {0, polynomial_[0], polynomial_[1] / 2};
  for (const auto& [c, lambda] : terms_) {
    sum.terms_.push_back({c / lambda, lambda});
    sum.polynomial_[0] -= (c / lambda).real();
  }
  return sum;
}

template <class Real>
ClosedForm<Real>& ClosedForm<Real>::add(Real factor, const ClosedForm& other) {
  if (factor == 0) return *this;
  for (int i = 0; i < 3; ++i) polynomial_[i] += factor * other.polynomial_[i];
  for (const auto& [c, lambda] : other.terms_) terms_.push_back({factor * c, lambda});
  for (const auto& [c, lambda, mu] : other.pairs_) pairs_.push_back({factor * c, lambda, mu});
  return *this;
}

template <class Real>
std::array<Real, 4> ClosedForm<Real>::derivatives(Real tau) const {
  const auto& p = polynomial_;
  std::array<Real, 4> g = {p[0] + tau * (p[1] + tau * p[2]), p[1] + 2 * p[2] * tau, 2 * p[2], 0};
  for (const auto& [c, lambda] : terms_) {
    Complex value = c * std::exp(lambda * tau);
    for (int n = 0; n < 4; ++n, value *= lambda) g[n] += value.real();
  }
  for (const auto& [c, lambda, mu] : pairs_) {
    Complex value = c * divided_difference(lambda, mu, tau), rest = c * std::exp(mu * tau);
    for (int n = 0; n < 4; ++n, value = lambda * value + rest, rest *= mu) g[n] += value.real();
  }
  return g;
}

template <class Real>
std::array<Real, 5> ClosedForm<Real>::bounds(Real tau, Real window) const {
  const auto& p = polynomial_;
  const Real end = tau + (may_grow() ? window : 0);
  const auto growth = [&](Real rate) { return std::exp(rate * (rate > 0 ? end : tau)); };
  std::array<Real, 5> most = {std::abs(p[0]) + end * (std::abs(p[1]) + end * std::abs(p[2])),
                              std::abs(p[1]) + 2 * std::abs(p[2]) * end, 2 * std::abs(p[2]), 0, 0};
  for (const auto& [c, lambda] : terms_) {
    Real value = std::abs(c) * growth(lambda.real());
    for (int n = 0; n < 5; ++n, value *= std::abs(lambda)) most[n] += value;
  }
  for (const auto& [c, lambda, mu] : pairs_) {
    const Real e = std::abs(c) * growth(std::max(lambda.real(), mu.real()));
    Real value = e * std::min(end, 2 / std::abs(lambda - mu)), rest = e;
    for (int n = 0; n < 5; ++n, value = std::abs(lambda) * value + rest, rest *= std::abs(mu)) most[n] += value;
  }
  return most;
}

template <class Real>
Real ClosedForm<Real>::fastest(Real tau) const {
  Real fastest = 0, largest = 0;
  const auto size = [&](const Term& term) { return std::abs(term.coefficient) * std::exp(term.exponent.real() * tau); };
  for (const auto& term : terms_) largest = std::max(largest, size(term));
  for (const auto& term : terms_)
    if (size(term) > Real(1e-18) * largest) fastest = std::max(fastest, std::abs(term.exponent));
  for (const auto& pair : pairs_) fastest = std::max({fastest, std::abs(pair.first), std::abs(pair.second)});
  return fastest;
}

template <class Real>
bool ClosedForm<Real>::may_grow() const {
  return !pairs_.empty() ||
         std::any_of(terms_.begin(), terms_.end(), [](const auto& term) { return term.exponent.real() > 0; });
}

/// True if the polynomial stays above all that the exponentials may add up to.
template <class Real>
bool ClosedForm<Real>::never_negative(Real from, Real to) const {
  if (may_grow()) return false;
  const auto& p = polynomial_;
  const auto value = [&](Real tau) { return p[0] + tau * (p[1] + tau * p[2]); };
  Real lowest = std::min(value(from), value(to));
  if (p[2] > 0) lowest = std::min(lowest, value(std::clamp(-p[1] / (2 * p[2]), from, to)));
  for (const auto& [c, lambda] : terms_) lowest -= std::abs(c) * std::exp(lambda.real() * from);
  return lowest > 0;
}

template <class Real>
std::optional<Real> ClosedForm<Real>::first_zero(Real from, Real to, bool leaving) const {
  if (!(from < to)) return std::nullopt;
  const Real window = may_grow() ? 2 / fastest(from) : endless<Real>;
  const auto floor_of = [](Real size) { return 4 * epsilon<Real> * size; };
  Real tau = from;
  if (leaving) {
    // The first derivative that rounding leaves certain decides; by the next one's bound its sign lasts for a while.
    const auto g = derivatives(from);
    const auto most = bounds(from, window);
    int order = 1;
    while (order < 3 && std::abs(g[order]) <= 1024 * floor_of(most[order])) ++order;
    if (g[order] < 0) return from;
    Real step = most[order + 1] > 0 ? std::min(window, (order + 1) * g[order] / most[order + 1]) : endless<Real>;
    step = std::max(step, std::max(from, 1 / std::max(fastest(from), 1 / to)) * 4 * epsilon<Real>);
    tau = from + step;
    // Too small yet to be told from zero: goes on as long as it rises.
    for (; tau < to; step *= 2, tau = from + step) {
      const auto here = derivatives(tau);
      if (here[0] > floor_of(bounds(tau, window)[0])) break;
      if (here[1] <= 0) return tau;
    }
    if (tau >= to) return std::nullopt;
  }
  if (never_negative(tau, to)) return std::nullopt;

  std::array<Fast, 8> fast;
  const bool quick = pairs_.empty() && terms_.size() <= fast.size();
  const std::size_t count = quick ? terms_.size() : 0;
  for (std::size_t i = 0; i < count; ++i) {
    Complex c = terms_[i].coefficient;
    fast[i].decay = terms_[i].exponent.real(), fast[i].frequency = terms_[i].exponent.imag();
    for (int n = 0; n < 3; ++n, c *= terms_[i].exponent)
      fast[i].re[n] = c.real(), fast[i].im[n] = c.imag(), fast[i].size[n] = std::abs(c);
  }
  const auto& p = polynomial_;
  while (true) {
    Real g = 0, slope = 0, size = 0, bend = 0;
    if (quick) {
      size = std::abs(p[0]) + tau * (std::abs(p[1]) + tau * std::abs(p[2]));
      g = p[0] + tau * (p[1] + tau * p[2]), slope = p[1] + 2 * p[2] * tau, bend = 2 * std::abs(p[2]);
      for (std::size_t i = 0; i < count; ++i) {
        const auto& term = fast[i];
        const Real e = term.decay == 0 ? 1 : std::exp(term.decay * tau);
        Real re = e, im = 0;
        if (term.frequency != 0) re = e * std::cos(term.frequency * tau), im = e * std::sin(term.frequency * tau);
        g += term.re[0] * re - term.im[0] * im;
        slope += term.re[1] * re - term.im[1] * im;
        const Real growth = term.decay > 0 ? e * std::exp(term.decay * window) : e;
        size += term.size[0] * e;
        bend += term.size[2] * growth;
      }
    } else {
      const auto values = derivatives(tau);
      const auto most = bounds(tau, window);
      g = values[0], slope = values[1], size = most[0], bend = most[2];
    }
    if (!(g > floor_of(size))) {
      const Real newton = slope < 0 ? g / slope : 0;
      return std::clamp(tau - newton, from, to);
    }
    if (tau >= to) return std::nullopt;
    Real step = endless<Real>;
    if (bend > 0) {
      const Real root = std::sqrt(slope * slope + 2 * bend * g);
      step = slope > 0 ? (slope + root) / bend : 2 * g / (root - slope);
    } else if (slope < 0) {
      step = -g / slope;
    }
    step = std::min({step, window, to - tau});
    if (tau + step == tau) return tau;
    tau = step == to - tau ? to : tau + step;
  }
}

template class ClosedForm<double>;
template class ClosedForm<long double>;

}  // namespace rosin::solvers::stick_slip
