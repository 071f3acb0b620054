/// Conversion of a start in natural quantities to unknowns.
#include "analysis/motion/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rosin::analysis::motion {

using oscillators::Mechanics;
using oscillators::SliderSystem;

namespace {
/// True where the state of steady sliding has no value at rest.
bool ages_without_end(const FrictionLaw& law, double normal_load) {
  try {
    law.steady({0, normal_load});
    return false;
  } catch (const InputError&) {
    return true;
  }
}
}  // namespace

std::vector<double> starting_point(const SliderSystem& system, const Start& start) {
  const Model& model = system.model();
  const auto& law = *model.law;
  const double V = model.drive.speed.value(0), N = model.drive.normal_load.value(0), f = model.drive.force.value(0);
  if (start.kind == Start::Kind::steady) {
    if (V == 0) throw InputError("start = \"steady\" needs drive.speed other than 0 at t = 0 (speed, m/s)");
    return system.steady(0);
  }
  double x = 0, u = 0, F = 0;
  std::vector<double> state;
  if (start.kind == Start::Kind::rest) {
    state = law.rest(N);
    if (model.lambda == 0 && ages_without_end(law, N)) {
      // A mass starts with a slip rate of 1e-14 V, too small to show; a loaded contact spring would show it.
      if (!(system.mechanics() == Mechanics::inertial && system.rigid()))
        throw InputError(fmt::format(
            "start = \"rest\" with law.lambda = 0: the state of '{}' has no value at rest; start from a slip rate, or "
            "give the law its memory (lambda > 0)",
            law.card().name));
      constexpr double unseen = 1e-14;
      u = unseen * (V != 0 ? V : law.slowest_creep);
      state = law.steady({u, N});
    }
  } else {
    if (start.velocity && start.slip_rate) throw InputError("start takes velocity or slip_rate, not both");
    u = start.slip_rate ? *start.slip_rate : V - start.velocity.value_or(0);
    // A contact that may stick has no steady state of its own at rest.
    state = u == 0 && law.set_valued() ? law.rest(N) : law.steady({u != 0 ? u : V != 0 ? V : law.slowest_creep, N});
    std::vector<std::string> known;
    for (const auto& s : law.states()) known.push_back(s.name);
    for (const auto& [name, value] : start.states) {
      const auto at = std::find(known.begin(), known.end(), name);
      if (at == known.end()) {
        const auto near = nearest_name(name, known);
        throw InputError(fmt::format("start: law '{}' has no state '{}'{}", law.card().name, name,
                                     near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
      }
      const auto& field = law.states()[at - known.begin()];
      require(value, field.range, "start." + name, field.meaning, field.unit);
      state[at - known.begin()] = value;
    }
    F = u == 0 ? 0 : N * law.friction({u, N}, state);
    // Without inertia the spring force equals the friction force, which sets the displacement.
    x = start.displacement.value_or(model.slider.stiffness > 0 && std::isfinite(model.slider.stiffness)
                                        ? (F + f - model.slider.damping * (V - u)) / model.slider.stiffness
                                        : 0);
    if (system.mechanics() == Mechanics::elastic && start.displacement && std::isfinite(model.slider.stiffness))
      F = model.slider.stiffness * x - f;
  }
  return system.unknowns_at(0, x, u, state, F);
}

}  // namespace rosin::analysis::motion
