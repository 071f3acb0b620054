/// The range of slip rates near rest in which states evolve differently, measured from the law's rates.
#include "analysis/motion/reversal_steps.hpp"

#include <algorithm>
#include <cmath>

namespace rosin::analysis::motion {

namespace {
double narrowest_layer(const FrictionLaw& law, double V, double N) {
  const double far = 0.03 * V;
  const auto state = law.steady({V, N});
  const auto rate = [&](double v) { return law.rate({v, N}, state); };
  const auto at_rest = rate(0), above_layer = rate(far), slower = rate(0.5 * V);
  double width = infinity;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const double elsewhere = std::max(std::abs(above_layer[i]), std::abs(slower[i]));
    if (!(std::abs(at_rest[i]) > 2 * elsewhere)) continue;
    double low = std::log(far) - 100, high = std::log(far);
    for (int halving = 0; halving < 20; ++halving) {
      const double middle = 0.5 * (low + high);
      const bool gone = std::abs(at_rest[i] - rate(std::exp(middle))[i]) > 0.5 * std::abs(at_rest[i] - above_layer[i]);
      (gone ? high : low) = middle;
    }
    width = std::min(width, std::exp(high));
  }
  return width < infinity ? width : 0;
}

}  // namespace

double near_rest_slip_rate(const FrictionLaw& law, double lambda, double V, double N) {
  if (law.set_valued() || !law.has_states() || !(lambda > 0 && N > 0)) return 0;
  try {
    return narrowest_layer(law, V, N);
  } catch (const InputError&) {  // no rate at rest, or no steady state: no such range is known
    return 0;
  }
}

double near_rest_slip_rate(const oscillators::SliderSystem& system) {
  const auto& model = system.model();
  return near_rest_slip_rate(*model.law, model.lambda, system.reference_speed(), model.drive.normal_load.level());
}

ReversalSteps::ReversalSteps(const oscillators::SliderSystem& system, double share) : share_(share) {
  if (const double slow = near_rest_slip_rate(system); slow > 0)
    contacts_.push_back({slow, [&system](double t, const double* y) { return system.contact_slip_rate(t, y); }});
}

ReversalSteps::ReversalSteps(const oscillators::StructureSystem& system, double share) : share_(share) {
  for (int j = 0; j < system.friction_contacts(); ++j) {
    const auto& contact = system.structure().contacts[j];
    const double slow = near_rest_slip_rate(*contact.law, contact.lambda, system.reference_speed_of(j),
                                            contact.load_factor * contact.normal_load.level());
    if (slow > 0 && !contact.frictionless())
      contacts_.push_back(
          {slow, [&system, j](double t, const double* y) { return system.contact_slip_rate(j, t, y); }});
  }
}

double ReversalSteps::longest(double t0, const double* y0, double t1, const double* y1, double length) const {
  double longest = infinity;
  for (const auto& [slow, slip_rate] : contacts_) {
    const double before = slip_rate(t0, y0), now = slip_rate(t1, y1);
    if (!(before * now > 0 && std::abs(now) < std::abs(before))) continue;
    const double loss = std::max(share_ * std::abs(now), near_rest_share * slow);
    longest = std::min(longest, std::max(loss * length / std::abs(before - now), 1e-28 * std::abs(t1)));
  }
  return longest;
}

}  // namespace rosin::analysis::motion
