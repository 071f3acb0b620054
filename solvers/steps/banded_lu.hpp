/// LU factorisation of band matrices with scaled partial pivoting, real or complex, and an order of unknowns that makes
/// the band narrow.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/system.hpp"
#include "solvers/steps/lu.hpp"

namespace rosin::solvers::steps {

/// An order of the unknowns in which those that stand in each other's equations are close: by neighbourhood, from an
/// unknown at an end of it (Cuthill & McKee 1969). order[k] is the unknown at place k.
std::vector<int> narrow_order(const Pattern&);

/// n × n, entries (i, j) with −below ≤ j − i ≤ above. Time of `factorise` is n·below·(below + above).
template <class Number>
class BandedLu {
 public:
  BandedLu(int n, int below, int above)
      : n_(n), below_(below), width_(2 * below + above + 1), a_(std::size_t(n) * width_), pivot_(n), weight_(n) {}

  /// Where entry (i, j) is stored in entries().
  std::size_t place(int i, int j) const { return std::size_t(i) * width_ + std::size_t(j - i + below_); }
  std::vector<Number>& entries() { return a_; }
  void clear() { std::fill(a_.begin(), a_.end(), Number(0)); }

  /// As `factorise_lu`: the diagonal holds the reciprocals of pivots, which are compared as parts of the largest entry
  /// of their row. \returns false if the matrix is singular or not finite.
  bool factorise() {
    for (int i = 0; i < n_; ++i) {
      double largest = 0;
      const Number* row = &a_[std::size_t(i) * width_];
      for (int c = 0; c < width_; ++c) largest = std::max(largest, pivot_size(row[c]));
      weight_[i] = 1 / largest;
    }
    for (int k = 0; k < n_; ++k) {
      const int last_row = std::min(n_ - 1, k + below_), last_column = std::min(n_ - 1, k + width_ - 1 - below_);
      int best = k;
      double size = pivot_size(at(k, k)) * weight_[k];
      for (int i = k + 1; i <= last_row; ++i)
        if (const double s = pivot_size(at(i, k)) * weight_[i]; s > size) best = i, size = s;
      if (!(size > 0) || !std::isfinite(size)) return false;
      pivot_[k] = best;
      std::swap(weight_[k], weight_[best]);
      Number* row = &at(k, k);
      if (best != k) std::swap_ranges(row, row + (last_column - k + 1), &at(best, k));
      const Number inverse = *row = reciprocal(*row);
      for (int i = k + 1; i <= last_row; ++i) {
        Number* other = &at(i, k);
        if (*other == Number(0)) continue;
        const Number factor = *other = product(*other, inverse);
        for (int j = 1; j <= last_column - k; ++j) other[j] -= product(factor, row[j]);
      }
    }
    return true;
  }

  void solve(Number* x) const {
    for (int k = 0; k < n_; ++k) {
      if (pivot_[k] != k) std::swap(x[k], x[pivot_[k]]);
      const int last_row = std::min(n_ - 1, k + below_);
      for (int i = k + 1; i <= last_row; ++i) x[i] -= product(at(i, k), x[k]);
    }
    for (int i = n_ - 1; i >= 0; --i) {
      const int last_column = std::min(n_ - 1, i + width_ - 1 - below_);
      const Number* row = &at(i, i);
      for (int j = i + 1; j <= last_column; ++j) x[i] -= product(row[j - i], x[j]);
      x[i] = product(x[i], row[0]);
    }
  }

  /// Of a real matrix that `factorise` has taken.
  int determinant_sign() const {
    int sign = 1;
    for (int k = 0; k < n_; ++k)
      if ((pivot_[k] != k) != (at(k, k) < 0)) sign = -sign;
    return sign;
  }

 private:
  Number& at(int i, int j) { return a_[place(i, j)]; }
  const Number& at(int i, int j) const { return a_[place(i, j)]; }
  int n_, below_, width_;
  std::vector<Number> a_;
  std::vector<int> pivot_;
  std::vector<double> weight_;
};

}  // namespace rosin::solvers::steps
