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

double near_rest_slip_rate(const oscillators::SliderSystem& system) {
  const auto& model = system.model();
  const double N = model.drive.normal_load.level();
  if (model.law->set_valued() || !model.law->has_states() || !(model.lambda > 0 && N > 0)) return 0;
  try {
    return narrowest_layer(*model.law, system.reference_speed(), N);
  } catch (const InputError&) {  // no rate at rest, or no steady state: no such range is known
    return 0;
  }
}

double ReversalSteps::longest(double t0, const double* y0, double t1, const double* y1, double length) const {
  if (!(near_rest_ > 0)) return infinity;
  const double before = system_.contact_slip_rate(t0, y0), now = system_.contact_slip_rate(t1, y1);
  if (!(before * now > 0 && std::abs(now) < std::abs(before))) return infinity;
  // The time must still advance: a step stays above rounding error of t where the drive depends on time.
  const double clock = (system_.autonomous() ? 1e-28 : 1e-12) * std::abs(t1);
  return std::max(std::max(share_ * std::abs(now), near_rest_share * near_rest_) * length / std::abs(before - now),
                  clock);
}

}  // namespace rosin::analysis::motion
