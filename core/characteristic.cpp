/// The determinant expanded into a polynomial, and its roots by the Ehrlich–Aberth iteration.
#include "core/characteristic.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace rosin {

namespace {

using Real = long double;  // for its exponents: products of rates leave the range of double
using Complex = std::complex<Real>;

/// a/b without overflow on the way (R. L. Smith, Commun. ACM 5, 435, 1962); the operator asks after infinities too.
Complex quotient(Complex a, Complex b) {
  if (std::abs(b.real()) < std::abs(b.imag())) {  // turned by a quarter
    a = {a.imag(), -a.real()};
    b = {b.imag(), -b.real()};
  }
  const Real ratio = b.imag() / b.real(), whole = 1 / (b.real() + b.imag() * ratio);
  return {(a.real() + a.imag() * ratio) * whole, (a.imag() - a.real() * ratio) * whole};
}

/// |Re x| + |Im x|.
Real size_of(Complex x) { return std::abs(x.real()) + std::abs(x.imag()); }

/// Coefficients of a polynomial in s, and the sum of the magnitudes that each was summed from.
struct Polynomial {
  std::vector<Real> value, size;
};

/// An entry J − s M with what both were summed from.
struct Entry {
  Real value, size, inertia, inertia_size;
  bool empty() const { return value == 0 && size == 0 && inertia == 0 && inertia_size == 0; }
};

/// det(J − s M) by rows: the minors of the first rows in all choices of columns follow from those of one row less.
/// Only those that are not empty are kept: of heat in many parts, which answer to the slip alone, they are few, and
/// fewest where rows of few entries come first.
/// \param at gives the Entry of a row and a column.
template <class Entries>
Polynomial expand(std::size_t n, std::span<const double> J, const Entries& at) {
  const std::size_t terms = n + 1, choices = std::size_t(1) << n;
  std::vector<std::size_t> order(n), entries(n);
  for (std::size_t i = 0; i < n; ++i) {
    order[i] = i;
    entries[i] = n - std::size_t(std::ranges::count(J.subspan(i * n, n), 0.0));
  }
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(entries[i], i); });
  constexpr std::uint32_t none = -1;
  std::vector<std::uint32_t> place(choices, none);  // of each choice among the minors
  std::vector<Real> value(terms, 0), size(terms, 0);
  if (constexpr std::size_t few = 6; n <= few)
    for (auto* numbers : {&value, &size}) numbers->reserve(choices * terms);
  place[0] = 0;
  value[0] = size[0] = 1;
  for (std::size_t columns = 0; columns + 1 < choices; ++columns) {
    if (place[columns] == none) continue;
    const std::size_t row = std::size_t(std::popcount(columns)), minor = place[columns] * terms;
    Real sign = 1;
    for (std::size_t column = 0; column < n; ++column) {
      if (columns >> column & 1) continue;
      if (const Entry entry = at(order[row], order[column]); !entry.empty()) {
        auto& further = place[columns | std::size_t(1) << column];
        if (further == none) {
          further = std::uint32_t(value.size() / terms);
          value.resize(value.size() + terms, 0);
          size.resize(value.size(), 0);
        }
        const std::size_t next = further * terms;
        for (std::size_t k = 0; k <= row + 1; ++k) {
          value[next + k] += sign * entry.value * value[minor + k];
          size[next + k] += entry.size * size[minor + k];
          if (k > 0) {
            value[next + k] -= sign * entry.inertia * value[minor + k - 1];
            size[next + k] += entry.inertia_size * size[minor + k - 1];
          }
        }
      }
      sign = -sign;
    }
  }
  if (place[choices - 1] == none) return {std::vector<Real>(terms, 0), std::vector<Real>(terms, 0)};
  const auto last = std::ptrdiff_t(place[choices - 1] * terms), end = last + std::ptrdiff_t(terms);
  return {{value.begin() + last, value.begin() + end}, {size.begin() + last, size.begin() + end}};
}

/// Starting points on circles whose radii follow from the Newton polygon of the coefficients (D. A. Bini, Numer.
/// Algorithms 13, 179-200, 1996).
std::vector<Complex> starts(const std::vector<Real>& a) {
  const int degree = int(a.size()) - 1;
  std::vector<int> hull;
  std::vector<Real> log(a.size());
  for (int k = 0; k <= degree; ++k) {
    if (a[k] == 0) continue;
    log[k] = std::log(std::abs(a[k]));
    while (hull.size() >= 2) {
      const int i = hull[hull.size() - 2], j = hull.back();
      if ((log[k] - log[j]) / (k - j) < (log[j] - log[i]) / (j - i)) break;
      hull.pop_back();
    }
    hull.push_back(k);
  }
  std::vector<Complex> points;
  for (std::size_t e = 0; e + 1 < hull.size(); ++e) {
    const int count = hull[e + 1] - hull[e];
    const Real radius = std::exp((log[hull[e]] - log[hull[e + 1]]) / count);
    for (int i = 0; i < count; ++i)
      points.push_back(std::polar(radius, 2 * std::numbers::pi_v<Real> * i / count + Real(0.7) * (e + 1)));
  }
  return points;
}

/// Newton's correction p/p' at x, without overflow at large |x| (the reversed polynomial is used there).
Complex newton_correction(const std::vector<Real>& a, Complex x) {
  const int degree = int(a.size()) - 1;
  Complex p = a[degree], d = 0;
  for (int k = degree - 1; k >= 0; --k) d = d * x + p, p = p * x + a[k];
  return quotient(p, d);
}

/// Roots of p, of degree n or less, with the errors that follow from what its coefficients were summed from.
CharacteristicRoots roots_of(Polynomial p) {
  const std::size_t n = p.value.size() - 1;
  // What is no more than the rounding of its terms is zero.
  std::size_t degree = n;
  for (std::size_t k = 0; k <= n; ++k)
    if (std::abs(p.value[k]) <= entry_rounding * p.size[k]) p.value[k] = 0;
  while (degree > 0 && p.value[degree] == 0) --degree;
  std::size_t zeros = 0;
  while (zeros < degree && p.value[zeros] == 0) ++zeros;

  CharacteristicRoots roots;
  bool finite = degree > 0 || p.value[0] != 0;
  for (std::size_t k = 0; k <= n; ++k) finite = finite && std::isfinite(p.value[k]);
  if (!finite) {
    roots.values.assign(n, {std::numeric_limits<double>::quiet_NaN(), 0});
    roots.errors.assign(n, std::numeric_limits<double>::infinity());
    roots.real_errors = roots.errors;
    return roots;
  }
  for (std::size_t z = 0; z < zeros; ++z) {
    // A vanishing coefficient may hide a root as large as its rounding allows.
    roots.values.emplace_back(0);
    const Real lowest = std::abs(p.value[zeros]);
    roots.errors.push_back(double(std::pow(entry_rounding * p.size[0] / lowest, Real(1) / zeros)));
    roots.real_errors.push_back(roots.errors.back());
  }
  const std::vector<Real> a(p.value.begin() + std::ptrdiff_t(zeros), p.value.begin() + std::ptrdiff_t(degree) + 1);
  auto x = starts(a);
  for (int iteration = 0; iteration < 300; ++iteration) {
    Real largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Complex newton = newton_correction(a, x[i]);
      Complex repulsion = 0;
      for (std::size_t j = 0; j < x.size(); ++j)
        if (const Complex apart = x[i] - x[j]; j != i) repulsion += std::conj(apart) / std::norm(apart);
      const Complex step = quotient(newton, Complex(1) - newton * repulsion);
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) continue;
      x[i] -= step;
      largest = std::max(largest, size_of(step) / std::max(size_of(x[i]), Real(1e-4000L)));
    }
    if (largest < Real(1e-18L)) break;
  }
  for (const auto& root : x) {
    // δs = −Σ δa_k s^k / p'(s) with real δa_k; near a double root the curvature of p bounds it instead.
    const int top = int(a.size()) - 1;
    Complex value = a[top], slope = 0, bend = 0;
    for (int k = top - 1; k >= 0; --k) {
      bend = bend * root + slope;
      slope = slope * root + value;
      value = value * root + a[k];
    }
    Real change = 0, error = 0, real_error = 0;
    // Coefficients that vanish, which the roots at nought or infinity are owed to, may be of the size of their
    // rounding.
    const Complex by_slope = quotient(1, slope);
    const Real size = std::abs(root), steepness = std::abs(by_slope);
    Complex power = 1;
    for (std::size_t z = 0; z < zeros; ++z) power = quotient(power, root);
    Real power_size = std::abs(power);
    for (std::size_t k = 0; k <= n; ++k, power *= root, power_size *= size) {
      const Real off = entry_rounding * p.size[k];
      change += off * power_size;
      error += off * power_size * steepness;
      // Sums of long double numbers keep 1e-18 of their terms, in any direction.
      real_error += off * std::abs((power * by_slope).real()) + Real(1e-18L) * p.size[k] * power_size * steepness;
    }
    const Real most = 2 * std::sqrt(change / std::abs(bend));
    roots.values.emplace_back(double(root.real()), double(root.imag()));
    // At a double root the slope may vanish, and what is divided by it is NaN: min() keeps its first argument then.
    roots.errors.push_back(double(std::min(most, error)));
    real_error += Real(1e-18L) * std::abs(root);  // of the iteration
    roots.real_errors.push_back(double(std::min(most, real_error)));
  }
  // Complex roots come in pairs: what is real within rounding is real.
  for (std::size_t i = 0; i < roots.values.size(); ++i)
    if (std::abs(roots.values[i].imag()) <= 1e-17 * std::abs(roots.values[i])) roots.values[i].imag(0);
  return roots;
}

}  // namespace

CharacteristicRoots characteristic_roots(std::span<const double> jacobian, std::span<const double> mass,
                                         std::span<const double> sizes) {
  const std::size_t n = mass.size();
  return roots_of(expand(n, jacobian, [&](std::size_t row, std::size_t column) -> Entry {
    const Real value = jacobian[row * n + column], inertia = row == column ? Real(mass[row]) : Real(0);
    return {value, sizes.empty() ? std::abs(value) : Real(sizes[row * n + column]), inertia, inertia};
  }));
}

CharacteristicRoots pencil_roots(std::span<const double> A, std::span<const double> E, std::span<const double> A_sizes,
                                 std::span<const double> E_sizes) {
  const auto n = std::size_t(std::lround(std::sqrt(double(A.size()))));
  return roots_of(expand(n, A_sizes, [&](std::size_t row, std::size_t column) -> Entry {
    const std::size_t at = row * n + column;
    return {A[at], A_sizes[at], E[at], E_sizes[at]};
  }));
}

}  // namespace rosin
