/// Null vectors of the pair, and the quadratic and cubic terms along them.
#include "analysis/steady/normal_form.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace rosin::analysis::steady {

using Complex = std::complex<double>;
using Eigen::MatrixXcd, Eigen::MatrixXd, Eigen::VectorXcd, Eigen::VectorXd;

std::optional<double> normal_form_coefficient(const Expansion& at, Complex eigenvalue) {
  const auto& [y, rows, f, mass, scale] = at.linear;
  const Eigen::Index n = mass.size();
  const MatrixXcd M = mass.asDiagonal().toDenseMatrix().cast<Complex>(), J = rows.cast<Complex>();
  // Null vectors of J − sM by inverse iteration, columns in their scales and rows in their own sizes.
  MatrixXcd K = (J - eigenvalue * M) * scale.cast<Complex>().asDiagonal();
  VectorXd row_size(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    row_size[i] = std::max(K.row(i).cwiseAbs().maxCoeff(), 1e-300);
    K.row(i) /= row_size[i];
  }
  const auto null_vector = [&](const MatrixXcd& A) {
    const auto lu = MatrixXcd(A + 1e-14 * MatrixXcd::Identity(n, n)).partialPivLu();
    VectorXcd x = VectorXcd::LinSpaced(n, Complex(1, 0.3), Complex(0.7, -0.4));
    for (int k = 0; k < 4; ++k) x = lu.solve(x).normalized();
    return x;
  };
  VectorXcd q = scale.cast<Complex>().asDiagonal() * null_vector(K);
  VectorXcd p = row_size.cwiseInverse().cast<Complex>().asDiagonal() * null_vector(K.adjoint());
  const Complex together = p.dot(M * q);
  constexpr double double_root = 1e-6;
  if (std::abs(together) < double_root * p.cwiseAbs().dot((M * q).cwiseAbs())) return std::nullopt;
  const Complex slips = at.slip_rate_gradient.cast<Complex>().dot(q);
  if (!(std::abs(slips) > 0)) return std::nullopt;
  q *= 0.5 * at.slip_rate / slips;
  p /= std::conj(p.dot(M * q));  // pᴴ M q = 1; Eigen's dot conjugates its left argument

  const auto size = [&](const VectorXd& d) {
    return at.reach.size() > 0 ? d.cwiseQuotient(at.reach).cwiseAbs().maxCoeff() : 1;
  };
  const auto real_bilinear = [&](const VectorXd& a, const VectorXd& b) -> VectorXd {
    const double sa = size(a), sb = size(b);
    if (sa == 0 || sb == 0) return VectorXd::Zero(n);
    const VectorXd u = a / sa, v = b / sb;
    return sa * sb / 4 * (at.second(u + v) - at.second(u - v));
  };
  const auto bilinear = [&](const VectorXcd& a, const VectorXcd& b) {
    const VectorXd ar = a.real(), ai = a.imag(), br = b.real(), bi = b.imag();
    VectorXcd r(n);
    r.real() = real_bilinear(ar, br) - real_bilinear(ai, bi);
    r.imag() = real_bilinear(ar, bi) + real_bilinear(ai, br);
    return r;
  };
  const VectorXd r = q.real(), i = q.imag();
  const VectorXd sum = at.third(r + i), difference = at.third(r - i), rrr = at.third(r), iii = at.third(i);
  VectorXcd cubic(n);  // C(q, q, q̄)
  cubic.real() = rrr + (sum + difference - 2 * rrr) / 6;
  cubic.imag() = (sum - difference - 2 * iii) / 6 + iii;
  const VectorXcd h11 = (2 * eigenvalue.real() * M - J).partialPivLu().solve(bilinear(q, q.conjugate()));
  const VectorXcd h20 = (2.0 * eigenvalue * M - J).partialPivLu().solve(bilinear(q, q));
  return 0.5 * p.dot(cubic + 2 * bilinear(q, h11) + bilinear(q.conjugate(), h20)).real();
}

}  // namespace rosin::analysis::steady
