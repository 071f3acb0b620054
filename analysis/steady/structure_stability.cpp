/// Eigenvalues and shapes of a structure in steady sliding.
#include "analysis/steady/structure_stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/steady/linearised.hpp"
#include "analysis/steady/verdict.hpp"
#include "oscillators/profile.hpp"

namespace rosin::analysis::steady {

using Eigen::MatrixXd, Eigen::VectorXd;

double ComplexMode::frequency() const { return std::abs(eigenvalue.imag()) / (2 * std::numbers::pi); }

double ComplexMode::damping_ratio() const {
  const double size = std::abs(eigenvalue);
  return size > 0 ? -eigenvalue.real() / size : 0;
}

oscillators::Structure frozen(oscillators::Structure structure) {
  for (auto& force : structure.force) force = force.level();
  for (auto& limited : structure.limited) limited.command = limited.command.level();
  for (auto& contact : structure.contacts) {
    contact.speed = contact.speed.level();
    contact.normal_load = contact.normal_load.level();
    if (const auto* profile = oscillators::profile_under(contact.normal_law.get()))
      contact.normal_law = profile->on_level();
  }
  return structure;
}

void require_sliding(const oscillators::Structure& structure) {
  for (std::size_t j = 0; j < structure.contacts.size(); ++j) {
    const auto& contact = structure.contacts[j];
    const bool is_spring = contact.law->set_valued() && contact.stiffness.present();  // at rest
    if (contact.speed.level() == 0 && !contact.frictionless() && !is_spring)
      throw InputError(fmt::format("contact {} is at rest, so that it has no steady sliding (speed, m/s)", j + 1));
  }
}

namespace {

void require_numbers(const std::vector<std::complex<double>>& eigenvalues) {
  for (const auto& z : eigenvalues)
    if (!std::isfinite(z.real()) || !std::isfinite(z.imag()))
      throw InputError("the eigenvalues of steady sliding could not be computed here");
}

}  // namespace

Spectrum spectrum_of_sliding(const MovingPart& part) {
  if (!part.A.allFinite()) throw InputError("steady sliding cannot be linearised here: its derivatives are not finite");
  auto spectrum = spectrum_of(part.A);
  require_numbers(spectrum.values);
  return spectrum;
}

void conclude(StructureStability& result, double fastest_growth, double error) {
  require_numbers(result.eigenvalues);
  std::ranges::stable_sort(result.modes, std::greater(), &ComplexMode::growth_rate);
  std::ranges::stable_sort(result.eigenvalues, std::greater(), [](auto z) { return z.real(); });
  result.marginal = std::abs(fastest_growth) <= error;
  result.stable = fastest_growth < 0 && !result.marginal;
}

StructureStability stability(const oscillators::Structure& moving) {
  oscillators::StructureSystem system(frozen(moving), Unknowns::states);
  const auto& structure = system.structure();
  require_sliding(structure);
  system.slide();
  const auto at = linearise(system, system.steady(0));
  const auto& y = at.y;
  const int n = system.coordinates();

  StructureStability result;
  result.coordinates.assign(y.begin(), y.begin() + n);
  const VectorXd inertia = structure.M.diagonal();
  result.inertia.assign(inertia.begin(), inertia.end());
  std::vector<double> force(system.friction_contacts());
  system.friction_forces(0, y.data(), force.data());
  for (int j = 0; j < system.friction_contacts(); ++j)
    result.contacts.push_back({system.normal_load(j, 0, y.data()), force[j], system.slip_rate(j, 0, y.data())});

  const auto part = at.moving();
  const Spectrum spectrum = spectrum_of_sliding(part);
  const Eigenpairs pairs = eigenpairs(part.A, true);
  double most = -infinity, error_of_most = 0;
  for (Eigen::Index k = 0; k < pairs.values.size(); ++k) {
    // The spectrum's own value, whose error is known.
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < spectrum.values.size(); ++i)
      if (std::abs(spectrum.values[i] - pairs.values[k]) < std::abs(spectrum.values[nearest] - pairs.values[k]))
        nearest = i;
    const auto value = spectrum.values[nearest];
    result.eigenvalues.push_back(value);
    if (value.real() > most) most = value.real(), error_of_most = spectrum.errors[nearest];
    if (value.imag() < 0) continue;
    ComplexMode mode{value, spectrum.errors[nearest], std::vector<std::complex<double>>(n)};
    for (std::size_t i = 0; i < part.unknowns.size(); ++i)
      if (part.unknowns[i] < n)
        mode.shape[part.unknowns[i]] = pairs.vectors(Eigen::Index(i), k) * at.scale[part.unknowns[i]];
    const auto largest = *std::ranges::max_element(mode.shape, {}, [](auto z) { return std::abs(z); });
    if (std::abs(largest) > 0)
      for (auto& z : mode.shape) z /= largest;
    result.modes.push_back(std::move(mode));
  }
  conclude(result, most, error_of_most);
  return result;
}

}  // namespace rosin::analysis::steady
