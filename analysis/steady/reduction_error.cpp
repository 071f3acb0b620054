/// Modes of a reduced structure, continued on the whole one.
#include "analysis/steady/reduction_error.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/steady/sliding_modes.hpp"

namespace rosin::analysis::steady {

namespace {

using Complex = std::complex<double>;
using Eigen::VectorXcd, Eigen::VectorXd;
using oscillators::Reduction, oscillators::StationForces, oscillators::Structure;

/// Steady sliding of the whole structure, in which contacts bear what they bear in the reduced one.
class Whole {
 public:
  Whole(const Reduction& reduction, const StructureStability& reduced) : reduction_(reduction), reduced_(reduced) {
    const Structure structure = frozen(reduction.whole);
    const StationForces contacts(structure);
    const Eigen::Map<const VectorXd> q(reduced.coordinates.data(), Eigen::Index(reduced.coordinates.size()));
    StationForces::Forces forces;
    contacts.evaluate(0, contacts.rows() * (reduction.basis * q), VectorXd::Zero(contacts.size()), forces);
    pencil_ = pencil_of_sliding(structure, contacts, forces);
  }

  /// The mode that continues one of the reduced structure's.
  PencilMode mode(const ComplexMode& of_reduced) const {
    double gap = infinity;
    for (const Complex z : reduced_.eigenvalues)
      if (z != of_reduced.eigenvalue) gap = std::min(gap, std::abs(z - of_reduced.eigenvalue));
    const Eigen::Map<const VectorXcd> shape(of_reduced.shape.data(), Eigen::Index(of_reduced.shape.size()));
    return mode_near(pencil_, of_reduced.eigenvalue, reduction_.basis * shape, gap);
  }

 private:
  const Reduction& reduction_;
  const StructureStability& reduced_;
  QuadraticPencil pencil_;
};

}  // namespace

std::vector<double> reduction_errors(const Reduction& reduction, const StructureStability& reduced) {
  std::vector<double> errors(reduced.modes.size(), infinity);
  try {
    const Whole whole(reduction, reduced);
    std::ranges::transform(reduced.modes, errors.begin(), [&](const ComplexMode& mode) {
      const auto continued = whole.mode(mode);
      return std::abs(continued.eigenvalue - mode.eigenvalue) + continued.error;
    });
  } catch (const InputError&) {  // contacts with states
  }
  return errors;
}

double reduction_error(const Crossing& crossing, const std::function<Reduction(double)>& reduction_at,
                       const std::function<StructureStability(const Structure&)>& stability_of) {
  struct Growth {
    double reduced, whole, error;
  };
  // Two modes merge at a crossing without damping.
  const auto growth_at = [&](double value) {
    const auto reduction = reduction_at(value);
    auto stability = stability_of(reduction.reduced);
    const auto distance = [&](const ComplexMode& mode) {
      return std::abs(mode.eigenvalue - Complex(0, crossing.angular_frequency));
    };
    std::ranges::sort(stability.modes, {}, distance);
    const Whole whole(reduction, stability);
    Growth growth{-infinity, -infinity, 0};
    for (std::size_t k = 0; k < std::min<std::size_t>(2, stability.modes.size()); ++k) {
      growth.reduced = std::max(growth.reduced, stability.modes[k].growth_rate());
      if (const auto mode = whole.mode(stability.modes[k]); mode.eigenvalue.real() > growth.whole)
        growth.whole = mode.eigenvalue.real(), growth.error = mode.error;
    }
    return growth;
  };
  const double beside = 1e-4 * std::max(std::abs(crossing.value), crossing.error);
  constexpr double most = 0.5;  // of the value
  try {
    const double slope =
        (growth_at(crossing.value + beside).reduced - growth_at(crossing.value - beside).reduced) / (2 * beside);
    const double first = std::abs(growth_at(crossing.value).whole / slope);
    for (double half = std::max(crossing.error, 1.05 * first); half < most * std::abs(crossing.value); half *= 2) {
      const double side = crossing.onset ? half : -half;
      const auto calm = growth_at(crossing.value - side), growing = growth_at(crossing.value + side);
      if (std::isfinite(calm.error) && calm.whole <= calm.error && growing.whole > growing.error) return half;
    }
  } catch (const InputError&) {  // contacts with states, or no steady sliding beside the crossing
  }
  return infinity;
}

}  // namespace rosin::analysis::steady
