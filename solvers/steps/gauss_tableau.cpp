/// Nodes by Newton's method on the Legendre polynomial, in extended precision; everything else from them.
#include "solvers/steps/gauss_tableau.hpp"

#include <cmath>
#include <numbers>

namespace rosin::solvers::steps {

namespace {
using Extended = long double;
constexpr int s = GaussTableau::stages;

/// P_n(x) of Legendre.
Extended legendre(int n, Extended x) {
  Extended before = 1, now = x;
  if (n == 0) return before;
  for (int k = 1; k < n; ++k) {
    const Extended next = ((2 * k + 1) * x * now - k * before) / (k + 1);
    before = now;
    now = next;
  }
  return now;
}

GaussTableau make() {
  GaussTableau t;
  Extended c[s], b[s];
  for (int i = 0; i < s; ++i) {
    Extended x = -std::cos(std::numbers::pi_v<Extended> * (i + 0.75L) / (s + 0.5L)), slope = 0;
    for (int iteration = 0; iteration < 20; ++iteration) {
      const Extended value = legendre(s, x);
      slope = s * (legendre(s - 1, x) - x * value) / (1 - x * x);
      x -= value / slope;
    }
    c[i] = (1 + x) / 2;
    b[i] = 1 / ((1 - x * x) * slope * slope);
    t.nodes.block[i] = double(c[i]);
    t.b.block[i] = double(b[i]);
    for (const int k : {0, 1}) t.top[k].block[i] = double((2 * (s - 1 - k) + 1) * b[i] * legendre(s - 1 - k, x));
  }
  for (int j = 0; j < s; ++j) {
    // Lagrange's polynomial j in monomials.
    Extended monomial[s] = {1}, weight = 1;
    int degree = 0;
    for (int k = 0; k < s; ++k) {
      if (k == j) continue;
      weight /= c[j] - c[k];
      for (int m = ++degree; m >= 0; --m)
        monomial[m] = (m > 0 ? monomial[m - 1] : 0) - c[k] * (m < degree ? monomial[m] : 0);
    }
    Extended end = 0;
    for (int k = 0; k < s; ++k) {
      t.lagrange[j][k] = double(weight * monomial[k]);
      end += weight * monomial[k];
    }
    t.end.block[j] = double(end);
    for (int i = 0; i < s; ++i) {
      Extended integral = 0;
      for (int k = s - 1; k >= 0; --k) integral = (integral + weight * monomial[k] / (k + 1)) * c[i];
      t.a[j].block[i] = double(integral);
    }
  }
  return t;
}
}  // namespace

const GaussTableau& GaussTableau::get() {
  static const GaussTableau tableau = make();
  return tableau;
}

}  // namespace rosin::solvers::steps
