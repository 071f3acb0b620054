/// Computes the Radau IIA coefficients in extended precision from their definition by collocation.
#include "solvers/steps/radau_tableau.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "core/eigenpairs.hpp"

namespace rosin::solvers::steps {

namespace {
constexpr int s = RadauTableau::stages;
using Extended = long double;
using MatrixX = Eigen::Matrix<Extended, s, s>;
using VectorX = Eigen::Matrix<Extended, s, 1>;

/// P_s(x) − P_{s−1}(x), whose zeros on [−1, 1] are the right Radau nodes, and its derivative.
std::pair<Extended, Extended> radau_polynomial(Extended x) {
  Extended p0 = 1, p1 = x, d0 = 0, d1 = 1;
  for (int n = 2; n <= s; ++n) {
    const Extended p = ((2 * n - 1) * x * p1 - (n - 1) * p0) / n;
    const Extended d = d0 + (2 * n - 1) * p1;
    p0 = p1, p1 = p, d0 = d1, d1 = d;
  }
  return {p1 - p0, d1 - d0};
}

VectorX nodes() {
  VectorX c;
  // Zeros are separated by sign changes on a fine grid; Newton polishes them. The last node is 1.
  int found = 0;
  const int grid = 2000;
  for (int i = 0; i < grid && found < s - 1; ++i) {
    const Extended low = -1 + Extended(2) * i / grid, high = -1 + Extended(2) * (i + 1) / grid;
    if (radau_polynomial(low).first * radau_polynomial(high).first > 0) continue;
    Extended x = (low + high) / 2;
    for (int k = 0; k < 12; ++k) {
      const auto [p, d] = radau_polynomial(x);
      x -= p / d;
    }
    c[found++] = (1 + x) / 2;
  }
  c[s - 1] = 1;
  return c;
}

RadauTableau compute() {
  RadauTableau t;
  const VectorX c = nodes();
  // Collocation: Σ_j a_ij c_j^(k−1) = c_i^k / k.
  MatrixX powers, moments;
  for (int j = 0; j < s; ++j)
    for (int k = 1; k <= s; ++k) {
      powers(j, k - 1) = std::pow(c[j], Extended(k - 1));
      moments(j, k - 1) = std::pow(c[j], Extended(k)) / k;
    }
  const MatrixX A = moments * powers.inverse(), A_inverse = A.inverse();

  const auto [values, T] = eigenpairs(A_inverse.cast<double>(), true);
  const Eigen::MatrixXcd T_inverse = T.inverse();
  int pair = 0;
  for (int k = 0; k < s; ++k) {
    const std::complex<double> value = values[k];
    if (std::abs(value.imag()) < 1e-10) {
      // The real eigenvector may come with a complex factor; the factor cancels against that of the row.
      const std::complex<double> factor = T(0, k) / std::abs(T(0, k));
      t.gamma = value.real();
      for (int i = 0; i < s; ++i) {
        t.real_column[i] = (T(i, k) / factor).real();
        t.real_row[i] = (T_inverse(k, i) * factor).real();
      }
    } else if (value.imag() > 0) {
      t.pair[pair] = value;
      for (int i = 0; i < s; ++i) {
        t.pair_column[pair][i] = T(i, k);
        t.pair_row[pair][i] = T_inverse(k, i);
      }
      ++pair;
    }
  }

  // Embedded quadrature of order s on (0, c) with weight 1/γ at 0: Σ b̂_i c_i^(k−1) = 1/k − δ_k1/γ.
  VectorX right;
  for (int k = 1; k <= s; ++k) right[k - 1] = Extended(1) / k - (k == 1 ? 1 / Extended(t.gamma) : 0);
  const VectorX b = A.row(s - 1).transpose();
  const VectorX embedded = powers.transpose().inverse() * right;
  const VectorX e = A_inverse.transpose() * (embedded - b);

  // Interpolation through (0, 0) and (c_i, Z_i): θ·Σ_k d_ik θ^k with Σ_k d_ik c_j^(k+1) = δ_ij.
  MatrixX shifted;
  for (int j = 0; j < s; ++j)
    for (int k = 0; k < s; ++k) shifted(k, j) = std::pow(c[j], Extended(k + 1));
  const MatrixX dense = shifted.inverse();
  for (int i = 0; i < s; ++i) {
    t.c[i] = double(c[i]);
    t.b[i] = double(b[i]);
    t.error_weights[i] = double(e[i]);
    for (int j = 0; j < s; ++j) {
      t.a_inverse[i][j] = double(A_inverse(i, j));
      t.dense[i][j] = double(dense(i, j));
    }
  }
  return t;
}
}  // namespace

double RadauTableau::error_over_estimate(Complex z) const {
  // Orders 10 and 6; below |z| = 1 the first is soon lost in rounding.
  const double size = std::abs(z), small = std::min(1.0, size);
  if (size < 1) z /= size;
  // (A⁻¹ − z) Z = z·1 by the eigenvectors of A⁻¹, for a start of 1.
  const auto along = [](const auto& row) {
    Complex sum = 0;
    for (const auto& x : row) sum += x;
    return sum;
  };
  const Complex real = z * along(real_row) / (gamma - z);
  Complex end = 1, estimate = z;
  for (int i = 0; i < s; ++i) {
    Complex Z = real_column[i] * real;
    for (int p = 0; p < 2; ++p) {
      Z += pair_column[p][i] * z * along(pair_row[p]) / (pair[p] - z);
      // The other of the pair: the conjugate eigenvalue, row and column.
      Z += std::conj(pair_column[p][i]) * z * std::conj(along(pair_row[p])) / (std::conj(pair[p]) - z);
    }
    estimate += gamma * error_weights[i] * Z;
    if (i == s - 1) end += Z;
  }
  return std::abs(end - std::exp(z)) / std::abs(estimate / (gamma - z)) * std::pow(small, 4);
}

const RadauTableau& RadauTableau::get() {
  static const RadauTableau tableau = compute();
  return tableau;
}

}  // namespace rosin::solvers::steps
