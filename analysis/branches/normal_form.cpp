/// From the first Lyapunov coefficient and the slope of the growth rate.
#include "analysis/branches/normal_form.hpp"

#include <cmath>
#include <limits>

#include "analysis/steady/stability.hpp"
#include "analysis/steady/structure_hopf.hpp"

namespace rosin::analysis::branches {

double SmallCycles::amplitude(double p) const {
  const double squared = slope * (p - value);
  return squared >= 0 && squared <= 1 ? std::sqrt(squared) : std::numeric_limits<double>::quiet_NaN();
}

std::optional<SmallCycles> small_cycles(const std::function<oscillators::Structure(double)>& structure_at,
                                        const steady::Crossing& crossing) {
  const auto hopf = steady::hopf_at(structure_at, crossing);
  if (!hopf || hopf->criticality == steady::Criticality::degenerate) return std::nullopt;
  // Supercritical: small cycles on the side on which sliding is unstable.
  const bool above = crossing.onset == (hopf->criticality == steady::Criticality::supercritical);
  const double squared = hopf->amplitude * hopf->amplitude;
  return SmallCycles{crossing.value, hopf->first_lyapunov_coefficient, above ? squared : -squared};
}

std::optional<SmallCycles> small_cycles(const oscillators::Model& model, std::string_view parameter,
                                        const steady::Crossing& crossing) {
  constexpr double decades = 0.01;  // around the crossing, which is a Hopf point
  const auto points = steady::hopf_points(model.with(parameter, crossing.value), parameter, decades);
  if (points.empty() || points.front().criticality == steady::Criticality::degenerate) return std::nullopt;
  const auto& hopf = points.front();
  const double aside = 1e-5 * std::abs(hopf.value);
  const auto growth = [&](double p) { return steady::stability(model.with(parameter, p)).eigenvalues.front().real(); };
  const double slope = (growth(hopf.value + aside) - growth(hopf.value - aside)) / (2 * aside);
  return SmallCycles{hopf.value, hopf.first_lyapunov_coefficient,
                     -slope / (hopf.first_lyapunov_coefficient * hopf.angular_frequency)};
}

}  // namespace rosin::analysis::branches
