/// The normal form of a Hopf point of a structure, by extrapolated differences of its right-hand side.
#include "analysis/steady/structure_hopf.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/steady/certain_sign.hpp"
#include "analysis/steady/normal_form.hpp"

namespace rosin::analysis::steady {

using Complex = std::complex<double>;
using Eigen::VectorXd;

namespace {

/// Derivatives along directions by central differences of falling steps, continued to 0.
class Differences {
 public:
  explicit Differences(const oscillators::Structure& structure)
      : system_(frozen(structure), Unknowns::states), n_(system_.size()) {
    system_.slide();
    at.linear = linearise(system_, system_.steady(0));
    at.slip_rate = system_.slip_rate(0, 0, at.linear.y.data());
    at.slip_rate_gradient.resize(n_);
    at.reach = at.linear.scale;
    std::vector<double> unit(n_, 0.0);
    const auto change = [&](int j, int i) {  // of a slip rate with an unknown
      const double at_none = system_.slip_rate(j, 0, unit.data());
      unit[i] = 1;
      const double changed = system_.slip_rate(j, 0, unit.data()) - at_none;
      unit[i] = 0;
      return changed;
    };
    for (int i = 0; i < n_; ++i) {
      at.slip_rate_gradient[i] = change(0, i);
      // Slip must not reverse: as far as an unknown may go, no contact loses more than its slip rate.
      for (int j = 0; j < system_.friction_contacts(); ++j)
        if (const double changes = std::abs(change(j, i)); changes > 0)
          at.reach[i] = std::min(at.reach[i], std::abs(system_.slip_rate(j, 0, at.linear.y.data())) / changes);
    }
    at.second = [this](const VectorXd& d) { return along(d, false); };
    at.third = [this](const VectorXd& d) { return along(d, true); };
  }
  Differences(const Differences&) = delete;

  Expansion at;
  double step = 0;  ///< of the widest difference, in reaches

 private:
  VectorXd beside(const VectorXd& d) const {
    std::vector<double> there(at.linear.y);
    for (int i = 0; i < n_; ++i) there[i] += d[i];
    VectorXd value(n_);
    system_.evaluate(0, there.data(), value.data());
    return value;
  }
  /// ∂²f(d, d) or ∂³f(d, d, d)
  VectorXd along(const VectorXd& d, bool third) const {
    const double s = d.cwiseQuotient(at.reach).cwiseAbs().maxCoeff();
    if (s == 0) return VectorXd::Zero(n_);
    constexpr int levels = 5;
    std::array<VectorXd, levels> table;
    double h = step;
    for (int k = 0; k < levels; ++k, h /= 1.6) {
      const VectorXd u = h * d / s, ahead = beside(u), behind = beside(-u);
      if (third)
        table[k] = (beside(2 * u) - beside(-2 * u) - 2 * (ahead - behind)) / (2 * h * h * h);
      else
        table[k] = (ahead - 2 * beside(VectorXd::Zero(n_)) + behind) / (h * h);
    }
    for (int order = 1; order < levels; ++order)
      for (int k = 0; k + order < levels; ++k)
        table[k] = table[k + 1] + (table[k + 1] - table[k]) / (std::pow(1.6, 2 * order) - 1);
    return table[0] * (third ? s * s * s : s * s);
  }

  oscillators::StructureSystem system_;
  int n_;
};

}  // namespace

std::optional<NormalFormCoefficient> normal_form(const oscillators::Structure& structure, Complex eigenvalue) {
  const double omega = std::abs(eigenvalue.imag());
  if (!(omega > 0)) return std::nullopt;
  Differences differences(structure);
  constexpr double widest = 0.15, rounding = 1e-10;
  differences.step = widest;
  const auto c1 = normal_form_coefficient(differences.at, eigenvalue);
  if (!c1) return std::nullopt;
  differences.step = widest / 1.5;
  const double error = std::abs(*c1 - *normal_form_coefficient(differences.at, eigenvalue));
  return NormalFormCoefficient{*c1 / omega, error / omega + rounding};
}

std::optional<StructureHopf> hopf_at(const std::function<oscillators::Structure(double)>& structure_at,
                                     const Crossing& crossing) {
  const Complex at_crossing(0, crossing.angular_frequency);
  const auto form = normal_form(structure_at(crossing.value), at_crossing);
  if (!form) return std::nullopt;
  StructureHopf hopf{Criticality::degenerate, form->value, form->error, 0};
  if (!(std::abs(form->value) > certain_sign * form->error)) return hopf;
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
