/// Dense LU factorisation with scaled partial pivoting for the small matrices of implicit steps, real or complex.
#pragma once
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

namespace rosin::solvers::steps {

/// Size that pivots are compared by: |Re| + |Im|, cheap and safe.
inline double pivot_size(double x) { return std::abs(x); }
inline double pivot_size(const std::complex<double>& x) { return std::abs(x.real()) + std::abs(x.imag()); }

/// A product without the checks of Annex G for infinities, which would call a library function for each one.
inline double product(double a, double b) { return a * b; }
inline std::complex<double> product(const std::complex<double>& a, const std::complex<double>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// 1/a, scaled so that it neither overflows early nor calls a library function.
inline double reciprocal(double a) { return 1 / a; }
inline std::complex<double> reciprocal(const std::complex<double>& a) {
  const double size = pivot_size(a), x = a.real() / size, y = a.imag() / size, norm = (x * x + y * y) * size;
  return {x / norm, -y / norm};
}

inline constexpr int largest_lu = 320;  ///< rows: the five stages of a step of up to 64 unknowns

/// Factorises the row-major n × n matrix in place; the diagonal holds the reciprocals of the pivots. Pivots are
/// compared as parts of the largest entry of their row: rows of short steps and of stuck contacts are fifty decades
/// apart. \returns false if it is singular or not finite.
template <class Number>
bool factorise_lu(std::vector<Number>& a, std::vector<int>& pivot, int n) {
  double weight[largest_lu];
  for (int i = 0; i < n; ++i) {
    double largest = 0;
    for (int j = 0; j < n; ++j) largest = std::max(largest, pivot_size(a[i * n + j]));
    weight[i] = 1 / largest;
  }
  for (int k = 0; k < n; ++k) {
    int best = k;
    double size = pivot_size(a[k * n + k]) * weight[k];
    for (int i = k + 1; i < n; ++i)
      if (const double s = pivot_size(a[i * n + k]) * weight[i]; s > size) best = i, size = s;
    if (!(size > 0) || !std::isfinite(size)) return false;
    pivot[k] = best;
    std::swap(weight[k], weight[best]);
    if (best != k)
      for (int j = 0; j < n; ++j) std::swap(a[k * n + j], a[best * n + j]);
    const Number inverse = a[k * n + k] = reciprocal(a[k * n + k]);
    for (int i = k + 1; i < n; ++i) {
      const Number factor = product(a[i * n + k], inverse);
      a[i * n + k] = factor;
      if (factor != Number(0))
        for (int j = k + 1; j < n; ++j) a[i * n + j] -= product(factor, a[k * n + j]);
    }
  }
  return true;
}

/// The sign of the determinant of a matrix that `factorise_lu` has taken.
inline int determinant_sign(const std::vector<double>& a, const std::vector<int>& pivot, int n) {
  int sign = 1;
  for (int k = 0; k < n; ++k)
    if ((pivot[k] != k) != (a[k * n + k] < 0)) sign = -sign;
  return sign;
}

/// Solves for `columns` right-hand sides, stored row-major n × columns, in place.
template <class Number>
void solve_lu(const std::vector<Number>& a, const std::vector<int>& pivot, int n, Number* x, int columns = 1) {
  for (int k = 0; k < n; ++k)
    if (pivot[k] != k)
      for (int c = 0; c < columns; ++c) std::swap(x[k * columns + c], x[pivot[k] * columns + c]);
  for (int i = 1; i < n; ++i)
    for (int k = 0; k < i; ++k)
      for (int c = 0; c < columns; ++c) x[i * columns + c] -= product(a[i * n + k], x[k * columns + c]);
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k)
      for (int c = 0; c < columns; ++c) x[i * columns + c] -= product(a[i * n + k], x[k * columns + c]);
    const Number& inverse = a[i * n + i];
    for (int c = 0; c < columns; ++c) x[i * columns + c] = product(x[i * columns + c], inverse);
  }
}

}  // namespace rosin::solvers::steps
