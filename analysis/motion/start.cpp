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

/// \throws InputError for values that leave no room for each other: one of them would be dropped.
void check_contradictions(const SliderSystem& system, const Start& start, double u, double balanced_displacement,
                          double force) {
  const Model& model = system.model();
  if (!start.slip_rate && !start.velocity) return;
  const double V = model.drive.speed.value(0), k = model.slider.stiffness;
  const char* name = start.slip_rate ? "slip_rate" : "velocity";
  const double given = start.slip_rate ? *start.slip_rate : *start.velocity;
  constexpr double rounding = 1e-9;
  if (std::isinf(k) && std::abs(u - V) > rounding * std::abs(V))
    throw InputError(
        fmt::format("start.{} = {} m/s cannot be kept: under an infinite stiffness the drive imposes a "
                    "slip rate of {} m/s; leave it out",
                    name, given, V));
  if (system.mechanics() == Mechanics::inertial || !system.rigid() || !start.displacement || u == 0 || !(k > 0) ||
      std::isinf(k))
    return;
  if (const double off = k * std::abs(*start.displacement - balanced_displacement); off > rounding * force)
    throw InputError(
        fmt::format("start.displacement = {} m and start.{} = {} m/s contradict each other: without mass the spring "
                    "balances friction, whose displacement at that slip rate and state is {:.10g} m; leave out one of "
                    "them, or give the state that belongs to both",
                    *start.displacement, name, given, balanced_displacement));
}

/// \throws InputError for a state that is not kept: without a clock it follows the slip rate.
void check_equilibrium(const FrictionLaw& law, const std::vector<double>& equilibrium,
                       const std::vector<double>& state) {
  constexpr double rounding = 1e-9;
  for (std::size_t i = 0; i < state.size(); ++i)
    if (const auto& field = law.states()[i]; std::abs(state[i] - equilibrium[i]) > rounding * std::abs(equilibrium[i]))
      throw InputError(
          fmt::format("start.{} = {} {} cannot be kept: with law.lambda = 0 states are in equilibrium with the slip "
                      "rate, at {:.10g} {}; leave it out",
                      field.name, state[i], field.unit, equilibrium[i], field.unit));
}
}  // namespace

void take_states(const FrictionLaw& law, const std::map<std::string, double>& given, std::vector<double>& state) {
  std::vector<std::string> known;
  for (const auto& s : law.states()) known.push_back(s.name);
  for (const auto& [name, value] : given) {
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
}

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
    const auto equilibrium = state;
    take_states(law, start.states, state);
    if (model.lambda == 0) check_equilibrium(law, equilibrium, state);
    F = u == 0 ? 0 : N * law.friction({u, N}, state);
    // Without inertia the spring force equals the friction force, which sets the displacement.
    const double damper = model.slider.damping * (V - u);
    const double balanced = model.slider.stiffness > 0 && std::isfinite(model.slider.stiffness)
                                ? (F + f - damper) / model.slider.stiffness
                                : 0;
    check_contradictions(system, start, u, balanced, std::abs(F) + std::abs(f) + std::abs(damper));
    x = start.displacement.value_or(balanced);
    if (system.mechanics() == Mechanics::elastic && start.displacement && std::isfinite(model.slider.stiffness))
      F = model.slider.stiffness * x - f;
  }
  return system.unknowns_at(0, x, u, state, F);
}

}  // namespace rosin::analysis::motion
