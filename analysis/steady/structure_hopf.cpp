/// The normal form of a Hopf point of a structure, by extrapolated differences of its right-hand side.
#include "analysis/steady/structure_hopf.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace rosin::analysis::steady {

using Complex = std::complex<double>;
using Eigen::MatrixXcd, Eigen::MatrixXd, Eigen::VectorXcd, Eigen::VectorXd;

namespace {

/// M ẏ = f(y) at steady sliding, and the higher derivatives of f along directions.
class Expansion {
 public:
  explicit Expansion(const oscillators::Structure& structure)
      : system(frozen(structure), Unknowns::states), n(system.size()) {
    system.slide();
    y = system.steady(0);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows(n, n);
    f.resize(n), mass.resize(n), scale.resize(n), reach.resize(n), slip.resize(n);
    system.linearise(0, y.data(), f.data(), rows.data());
    system.mass(0, mass.data());
    system.scale(y.data(), scale.data());
    J = rows;
    reach = scale;
    std::vector<double> unit(n, 0.0);
    const double at_none = system.slip_rate(0, 0, unit.data());
    for (int i = 0; i < n; ++i) {
      unit[i] = 1;
      slip[i] = system.slip_rate(0, 0, unit.data()) - at_none;
      unit[i] = 0;
      // Slip must not reverse: as far as an unknown may go, no contact loses more than its slip rate.
      for (int j = 0; j < system.friction_contacts(); ++j) {
        const double rate = system.slip_rate(j, 0, y.data());
        unit[i] = 1;
        const double changes =
            std::abs(system.slip_rate(j, 0, unit.data()) - system.slip_rate(j, 0, std::vector<double>(n, 0.0).data()));
        unit[i] = 0;
        if (changes > 0) reach[i] = std::min(reach[i], std::abs(rate) / changes);
      }
    }
  }

  /// \param step  of the widest difference, in reaches
  void begin(double step) { step_ = step; }
  /// ∂²f(a, b)
  VectorXd bilinear(const VectorXd& a, const VectorXd& b) {
    const double sa = size(a), sb = size(b);
    if (sa == 0 || sb == 0) return VectorXd::Zero(n);
    const VectorXd u = a / sa, v = b / sb;
    return sa * sb / 4 * (along(u + v, false) - along(u - v, false));
  }
  VectorXd third(const VectorXd& d) { return along(d, true); }

  oscillators::StructureSystem system;
  int n;
  std::vector<double> y, f;
  MatrixXd J;
  VectorXd mass, scale, reach, slip;

 private:
  double size(const VectorXd& d) const { return d.cwiseQuotient(reach).cwiseAbs().maxCoeff(); }
  VectorXd at(const VectorXd& d) const {
    std::vector<double> there(y), value(n);
    for (int i = 0; i < n; ++i) there[i] += d[i];
    system.evaluate(0, there.data(), value.data());
    return Eigen::Map<const VectorXd>(value.data(), n);
  }
  /// ∂²f(d, d) or ∂³f(d, d, d): central differences of falling steps, continued to 0.
  VectorXd along(const VectorXd& d, bool third) const {
    const double s = size(d);
    if (s == 0) return VectorXd::Zero(n);
    constexpr int levels = 5;
    std::array<VectorXd, levels> table;
    double h = step_;
    for (int k = 0; k < levels; ++k, h /= 1.6) {
      const VectorXd u = h * d / s, ahead = at(u), behind = at(-u);
      if (third)
        table[k] = (at(2 * u) - at(-2 * u) - 2 * (ahead - behind)) / (2 * h * h * h);
      else
        table[k] = (ahead - 2 * at(VectorXd::Zero(n)) + behind) / (h * h);
    }
    for (int order = 1; order < levels; ++order)
      for (int k = 0; k + order < levels; ++k)
        table[k] = table[k + 1] + (table[k + 1] - table[k]) / (std::pow(1.6, 2 * order) - 1);
    return table[0] * (third ? s * s * s : s * s);
  }

  double step_ = 0;
};

}  // namespace

std::optional<NormalFormCoefficient> normal_form(const oscillators::Structure& structure, Complex eigenvalue) {
  const double omega = std::abs(eigenvalue.imag());
  if (!(omega > 0)) return std::nullopt;
  Expansion at(structure);
  const int n = at.n;
  const MatrixXcd M = at.mass.asDiagonal().toDenseMatrix().cast<Complex>(), J = at.J.cast<Complex>();
  // Null vectors of J − sM by inverse iteration, columns in their scales and rows in their own sizes.
  MatrixXcd K = (J - eigenvalue * M) * at.scale.cast<Complex>().asDiagonal();
  VectorXd row_size(n);
  for (int i = 0; i < n; ++i) {
    row_size[i] = std::max(K.row(i).cwiseAbs().maxCoeff(), 1e-300);
    K.row(i) /= row_size[i];
  }
  const auto null_vector = [&](const MatrixXcd& A) {
    const auto lu = MatrixXcd(A + 1e-14 * MatrixXcd::Identity(n, n)).partialPivLu();
    VectorXcd x = VectorXcd::LinSpaced(n, Complex(1, 0.3), Complex(0.7, -0.4));
    for (int k = 0; k < 4; ++k) x = lu.solve(x).normalized();
    return x;
  };
  VectorXcd q = at.scale.cast<Complex>().asDiagonal() * null_vector(K);
  VectorXcd p = row_size.cwiseInverse().cast<Complex>().asDiagonal() * null_vector(K.adjoint());
  const Complex together = p.dot(M * q);
  constexpr double double_root = 1e-6;
  if (std::abs(together) < double_root * p.cwiseAbs().dot((M * q).cwiseAbs())) return std::nullopt;
  const Complex slips = at.slip.cast<Complex>().dot(q);
  if (!(std::abs(slips) > 0)) return std::nullopt;
  q *= 0.5 * at.system.slip_rate(0, 0, at.y.data()) / slips;
  p /= std::conj(p.dot(M * q));

  const auto bilinear = [&](const VectorXcd& a, const VectorXcd& b) {
    VectorXcd r(n);
    r.real() = at.bilinear(a.real(), b.real()) - at.bilinear(a.imag(), b.imag());
    r.imag() = at.bilinear(a.real(), b.imag()) + at.bilinear(a.imag(), b.real());
    return r;
  };
  const auto coefficient = [&](double step) {
    at.begin(step);
    const VectorXd r = q.real(), i = q.imag();
    const VectorXd sum = at.third(r + i), difference = at.third(r - i), rrr = at.third(r), iii = at.third(i);
    VectorXcd cubic(n);  // C(q, q, q̄)
    cubic.real() = rrr + (sum + difference - 2 * rrr) / 6;
    cubic.imag() = (sum - difference - 2 * iii) / 6 + iii;
    const VectorXcd h11 = (2 * eigenvalue.real() * M - J).partialPivLu().solve(bilinear(q, q.conjugate()));
    const VectorXcd h20 = (2.0 * eigenvalue * M - J).partialPivLu().solve(bilinear(q, q));
    return 0.5 * p.dot(cubic + 2 * bilinear(q, h11) + bilinear(q.conjugate(), h20)).real();
  };
  constexpr double widest = 0.15, rounding = 1e-10;
  const double c1 = coefficient(widest), error = std::abs(c1 - coefficient(widest / 1.5));
  return NormalFormCoefficient{c1 / omega, error / omega + rounding};
}

std::optional<StructureHopf> hopf_at(const std::function<oscillators::Structure(double)>& structure_at,
                                     const Crossing& crossing) {
  const Complex at_crossing(0, crossing.angular_frequency);
  const auto form = normal_form(structure_at(crossing.value), at_crossing);
  if (!form) return std::nullopt;
  StructureHopf hopf{Criticality::degenerate, form->value, form->error, 0};
  if (!(std::abs(form->value) > form->error)) return hopf;
  hopf.criticality = form->value < 0 ? Criticality::supercritical : Criticality::subcritical;
  const double aside = 1e-5 * std::max(std::abs(crossing.value), 1e-300);
  const auto growth = [&](double value) {
    const auto modes = stability(structure_at(value)).modes;
    return std::ranges::min_element(modes, {},
                                    [&](const auto& mode) { return std::abs(mode.eigenvalue - at_crossing); })
        ->growth_rate();
  };
  const double slope = (growth(crossing.value + aside) - growth(crossing.value - aside)) / (2 * aside);
  hopf.amplitude = std::sqrt(std::abs(slope / (form->value * crossing.angular_frequency)));
  return hopf;
}

}  // namespace rosin::analysis::steady
