/// What a solver advances in time: M(t)·ẏ = f(t, y) with a diagonal M whose zero rows are algebraic.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/pack.hpp"
#include "core/parameters.hpp"

namespace rosin {

/// Where entries of a Jacobian may stand, row by row: row i has the columns column[row_begin[i]] … column[row_begin[i +
/// 1] − 1], which ascend, its own among them.
struct Pattern {
  std::vector<int> row_begin, column;
  int size() const { return int(row_begin.size()) - 1; }
  int entries() const { return int(column.size()); }
  /// Place of an entry among all.
  int place(int row, int of) const {
    return int(std::lower_bound(column.begin() + row_begin[row], column.begin() + row_begin[row + 1], of) -
               column.begin());
  }
};

/// A system of ordinary differential and algebraic equations of index 1. Immutable during a solution.
class System {
 public:
  virtual ~System() = default;
  virtual int size() const = 0;
  /// Diagonal of M at time t (size entries).
  virtual void mass(double t, double* m) const = 0;
  /// f(t, y).
  virtual void evaluate(double t, const double* y, double* f) const = 0;
  /// f and ∂f/∂y, row-major size × size.
  virtual void linearise(double t, const double* y, double* f, double* jacobian) const = 0;
  /// Where entries of ∂f/∂y may stand; nullptr: anywhere, as of every small system.
  virtual const Pattern* pattern() const { return nullptr; }
  /// f, and the entries of ∂f/∂y at the places of pattern(), which is not nullptr.
  virtual void linearise_entries(double /*t*/, const double* /*y*/, double* /*f*/, double* /*entries*/) const {}
  /// The sizes by which errors in each unknown are measured, at y.
  virtual void scale(const double* y, double* s) const = 0;
  /// Name of an unknown for messages.
  virtual std::string unknown(int i) const = 0;
  /// The next time after t at which the equations jump; infinity if none.
  virtual double next_break(double) const { return infinity; }
  /// Carries y across the break at t: continues what is continuous and makes algebraic unknowns consistent.
  virtual void cross_break(double, double*) const {}
  /// True if the equations do not change with time: then steps may be shorter than the clock can show.
  virtual bool autonomous() const { return false; }
  /// Longest step that resolves prescribed motion; infinity if none is prescribed.
  virtual double resolution() const { return infinity; }
  /// Smooth functions of (t, y) that change sign, in numbers of the size of 1, each where f has a kink, at which a step
  /// must end to keep its order: always as many, NaN where one is none.
  virtual void kinks(double /*t*/, const double* /*y*/, std::vector<double>& values) const { values.clear(); }
  /// True where solutions go with a power of the distance from a kink that is no whole number, as on a contact whose
  /// pressure does: the error of a step next to it falls no faster than its estimate.
  virtual bool kinks_are_singular() const { return false; }
  /// True if the system can be followed as ordinary differential equations, by `flow` and `restore`.
  virtual bool has_flow() const { return false; }
  /// At eight times t and consistent states y, one in each lane: dy/dt of every unknown, algebraic ones by
  /// differentiating their rows in time; and the pace at which the system changes (1/s, > 0, smooth in y), a natural
  /// unit for steps.
  virtual void flow(const Pack& /*t*/, const Pack* /*y*/, Pack* /*rate*/, Pack& /*pace*/) const {}
  /// Removes what steps along the flow have left of a defect in the algebraic rows.
  virtual void restore(double, double*) const {}
};

/// Σ|J_ij y_j| of one row of a Jacobian: the size of the terms that cancel where a row of f is in balance, and of which
/// rounding leaves some last digits.
inline double size_of_terms(const double* row, const double* y, int n) {
  double sum = 0;
  for (int j = 0; j < n; ++j) sum += std::abs(row[j] * y[j]);
  return sum;
}
inline double size_of_terms(const Pattern& pattern, const double* entries, int row, const double* y) {
  double sum = 0;
  for (int e = pattern.row_begin[row]; e < pattern.row_begin[row + 1]; ++e)
    sum += std::abs(entries[e] * y[pattern.column[e]]);
  return sum;
}
/// What may be wrong with a row of f by that.
inline double last_digits_of_terms(double size_of_terms) {
  constexpr double rounding = 2.3e-16;
  return 4 * rounding * size_of_terms;
}
inline double last_digits_of_terms(const double* row, const double* y, int n) {
  return last_digits_of_terms(size_of_terms(row, y, n));
}

}  // namespace rosin
