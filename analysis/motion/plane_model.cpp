/// The solver of a plane slider, its start, and what its contact remembers.
#include "analysis/motion/plane_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/motion/reversal_steps.hpp"
#include "laws/plane_form.hpp"
#include "oscillators/contact_rows.hpp"
#include "oscillators/model.hpp"
#include "solvers/stick_slip/plane_creep.hpp"
#include "solvers/stick_slip/plane_stick_slip.hpp"

namespace rosin::analysis::motion {

using solvers::stick_slip::PlaneCreep;
using solvers::stick_slip::PlaneFriction;
using solvers::stick_slip::PlaneSolver;
using solvers::stick_slip::PlaneStickSlip;
using solvers::stick_slip::PlaneVector;
using solvers::stick_slip::SlipFriction;

namespace {

/// A law with an explicit slip rate is followed by its friction, which near rest says more than the slip rate.
Unknowns unknowns_of(const FrictionLaw& law) { return law.has_slip_rate() ? Unknowns::friction : Unknowns::states; }

SlipFriction slip_friction(const PlaneModel& model) {
  const auto& law = model.law;
  if (!law) return {};
  return {law->contact({.unknowns = Unknowns::states}), [law](double v) { return law->slip_kink(v); }};
}

PlaneFriction plane_friction(const PlaneModel& model) {
  const auto& law = model.law;
  if (const auto why = laws::refusal_in_plane(*law, model.mass.load.level()); !why.empty())
    throw InputError(fmt::format("law '{}' {}", law->card().name, why));
  if (!(model.lambda > 0))
    throw InputError(fmt::format("law '{}' needs its memory in the plane, law.lambda > 0", law->card().name));
  const bool carries = unknowns_of(*law) == Unknowns::friction;
  PlaneFriction friction{law->contact({.lambda = model.lambda, .unknowns = unknowns_of(*law)}),
                         carries ? 0 : laws::turning_state(*law)};
  if (carries) friction.creep = oscillators::friction_creep(model.lambda).share;
  friction.near_rest = [law, lambda = model.lambda, N = model.mass.load.level()](double fast) {
    return near_rest_slip_rate(*law, lambda, fast, N);
  };
  friction.slip_kink = [law](double v) { return law->slip_kink(v); };
  if (!carries && friction.turning < 0)
    friction.state_kink = [law, n = law->states().size()](const double* z) { return law->kink({z, n}); };
  return friction;
}

}  // namespace

std::vector<PlaneMemory> memory_of(const PlaneModel& model) {
  std::vector<PlaneMemory> memory;
  if (!model.remembers()) return memory;
  const auto& law = *model.law;
  const int turning = laws::turning_state(law);
  int place = unknowns_of(law) == Unknowns::friction ? 2 : 0;
  for (int k = 0; k < int(law.states().size()); ++k) {
    const auto& state = law.states()[std::size_t(k)];
    const auto add = [&](const char* end) {
      memory.push_back({state, place++});
      memory.back().state.name += end;
    };
    if (k == turning)
      add("_x"), add("_y");
    else
      add("");
  }
  return memory;
}

std::unique_ptr<PlaneSolver> solver_of(const PlaneModel& model, double tolerance, double stick_threshold) {
  if (model.remembers())
    return std::make_unique<PlaneCreep>(model.mass, plane_friction(model), tolerance, stick_threshold);
  return std::make_unique<PlaneStickSlip>(model.mass, tolerance, slip_friction(model));
}

std::vector<double> start_of(const PlaneModel& model) {
  const auto &x = model.displacement, &v = model.velocity, &V = model.mass.surface_velocity;
  if (!model.remembers()) return {x[0], x[1], v[0], v[1]};
  const auto& law = *model.law;
  const double N = model.mass.load.value(0);
  const PlaneVector u = {V[0] - v[0], V[1] - v[1]};
  const double s = std::hypot(u[0], u[1]);
  const PlaneVector along = {s > 0 ? u[0] / s : 0, s > 0 ? u[1] / s : 0};
  auto natural = s > 0 ? law.steady({s, N}) : law.rest(N);
  const auto given = [&](const std::string& name, double value) {
    const auto found = model.states.find(name);
    return found == model.states.end() ? value : found->second;
  };
  const int turning = laws::turning_state(law);
  const auto memory = memory_of(model);
  std::vector<double> state = {x[0], x[1], u[0], u[1]}, contact;
  std::size_t m = 0;
  for (int k = 0; k < int(natural.size()); ++k) {
    double& value = natural[std::size_t(k)];
    if (k == turning) {
      for (const double part : along) contact.push_back(given(memory[m].state.name, value * part)), ++m;
    } else {
      value = given(memory[m].state.name, value);
      contact.push_back(oscillators::to_unknown(memory[m].state, value)), ++m;
    }
  }
  if (unknowns_of(law) == Unknowns::friction)
    for (const double part : along) state.push_back(s > 0 ? law.friction({s, N}, natural) * part : 0);
  state.insert(state.end(), contact.begin(), contact.end());
  return state;
}

std::vector<double> sizes_of(const PlaneModel& model) {
  const auto& mass = model.mass;
  if (model.remembers()) {
    const PlaneCreep solver(model.mass, plane_friction(model));
    auto sizes = solver.sizes();
    for (int d = 0; d < 2; ++d)
      sizes[std::size_t(d)] = solver.speed_scale() * std::sqrt(mass.mass / mass.stiffness[d]),
      sizes[std::size_t(2 + d)] = solver.speed_scale();
    // Friction follows from the slip rate and the states.
    if (unknowns_of(*model.law) == Unknowns::friction) sizes[4] = sizes[5] = infinity;
    return sizes;
  }
  // As large as what the energy makes of each that the forces store in a spring.
  double force = mass.static_friction * mass.load.level();
  for (int d = 0; d < 2; ++d) {
    force +=
        std::abs(mass.force[d].level()) + std::abs(mass.surface_velocity[d]) * std::sqrt(mass.stiffness[d] * mass.mass);
    for (const auto& term : mass.force[d].piece(0).terms) force += std::abs(term.amplitude);
  }
  const double energy = force * force / std::min(mass.stiffness[0], mass.stiffness[1]);
  std::vector<double> sizes;
  for (const double stiffness : {mass.stiffness[0], mass.stiffness[1], mass.mass, mass.mass})
    sizes.push_back(std::sqrt(energy / stiffness));
  return sizes;
}

}  // namespace rosin::analysis::motion
