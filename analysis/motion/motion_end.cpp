/// The reasons why a motion ends, from the limits of the law and from the slip rate reached.
#include "analysis/motion/motion_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/steady/curve.hpp"

namespace rosin::analysis::motion {

namespace {
constexpr double nearly_rest = 1e-140;  // m/s: ages L/v and their slopes stay finite

double reference_speed(const oscillators::Model& model) { return std::max(std::abs(model.drive.speed.level()), 1e-12); }

/// True where the force against slip of the contact is at an extremum in the slip rate, beyond which the contact's slip
/// rate cannot follow the spring force and must jump. The resistance ∂F/∂v then passes through zero within a share of
/// that slip rate: steps end that close to it by rounding error of the forces, or beyond it, with forces out of
/// balance.
bool slip_rate_must_jump(const oscillators::SliderSystem& system, double t, const double* y) {
  const int n = system.size(), at = system.contact_slip_rate_index();
  if (at < 0) return false;
  std::vector<double> there(y, y + n), f(n), jacobian(n * n);
  const auto resistance = [&](double share) {
    there[at] = share * y[at];
    system.linearise(t, there.data(), f.data(), jacobian.data());
    return -jacobian[at * n + at];
  };
  const double here = resistance(1), to_balance = f[at] / (here * y[at]);
  constexpr double near = 0.1, about = 0.5, digits = 1e4 * std::numeric_limits<double>::epsilon();
  if (resistance(1 - near) * resistance(1 + near) < 0 || resistance(0) * here < 0) return true;
  // Rounding error of the forces may hide a zero farther away.
  for (const double share : {1 - about, 1 + about})
    if (resistance(share) * here < 0 && std::abs(f[at]) < digits * size_of_terms(&jacobian[at * n], y, n)) return true;
  for (const double distance : {0.1, 0.25, 0.5, 1.0, 2.0})
    if (resistance(1 + distance * to_balance) * here < 0) return true;
  // A law of |v| has another resistance on the other side of a reversal.
  constexpr double at_reversal = 1e-4;  // of the drive speed
  return std::abs(y[at]) < at_reversal * reference_speed(system.model()) && resistance(-1) * here < 0;
}

/// Steady friction close to rest; nothing where it overflows.
std::optional<FrictionLaw::Steady> close_to_rest(const FrictionLaw& law, double normal_load) {
  try {
    return law.steady_friction({nearly_rest, normal_load});
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::string rises_without_bound(const FrictionLaw& law, double t) {
  return fmt::format(
      "law.lambda = 0 leaves '{}' a friction curve that rises without bound toward rest: at rest at t = {:.9g} s, "
      "nothing slips again; give the law its memory (lambda > 0)",
      law.card().name, t);
}
}  // namespace

bool unbounded_at_rest(const FrictionLaw& law, double normal_load) {
  if (law.set_valued()) return false;
  const auto there = close_to_rest(law, normal_load);
  return !there || (!(there->slope > 0) && there->friction > 0);
}

bool jumps_at_rest(const FrictionLaw& law, double normal_load) {
  if (law.set_valued()) return false;
  const auto there = close_to_rest(law, normal_load);
  return there && std::abs(there->slope) * nearly_rest < 1e-10 * there->friction;
}

std::optional<std::string> why_nothing_slips_again(const oscillators::SliderSystem& system, double t, const double* y) {
  const auto& model = system.model();
  const auto& law = *model.law;
  if (model.lambda != 0 || !law.has_states() || !(std::abs(system.contact_slip_rate(t, y)) < nearly_rest) ||
      !unbounded_at_rest(law, model.drive.normal_load.value(t)))
    return std::nullopt;
  return rises_without_bound(law, t);
}

std::optional<std::string> why_rest_lasts(const oscillators::SliderSystem& system, double t, const double* y) {
  const auto& model = system.model();
  const auto& law = *model.law;
  const double N = model.drive.normal_load.value(t), V = reference_speed(model);
  if (model.lambda != 0 || !law.has_states()) return std::nullopt;
  if (const auto never = why_nothing_slips_again(system, t, y)) return never;
  constexpr double at_rest = 1e-5;  // of the drive speed
  if (jumps_at_rest(law, N) && std::abs(system.contact_slip_rate(t, y)) < at_rest * V)
    return fmt::format(
        "law.lambda = 0 leaves '{}' a friction curve that jumps at rest, which slip came to at t = {:.9g} s: what "
        "holds "
        "there is the deflection; give the law its memory (lambda > 0), or take a curve that sticks, such as stribeck",
        law.card().name, t);
  return std::nullopt;
}

namespace {
constexpr double out_of_hand = 1e8;  // times the drive speed

std::string reaches_infinite_speed(double t) {
  return fmt::format(
      "between friction and a spring is neither mass nor damping: slip reaches infinite speed at t = {:.9g} s; give "
      "the slider mass or damping (of radiation), and leave out a contact stiffness as low as this",
      t);
}
}  // namespace

std::optional<std::string> why_slip_runs_away(const oscillators::SliderSystem& system, double t, const double* y) {
  const auto& model = system.model();
  const bool constant = system.autonomous();  // a drive that reverses is at rest for moments
  if (system.mechanics() != oscillators::Mechanics::elastic || model.lambda == 0 || !constant) return std::nullopt;
  // Without inertia a spring never overshoots: slip so fast against the drive comes from a step across infinite slip.
  const double along = system.contact_slip_rate(t, y) * (model.drive.speed.level() < 0 ? -1 : 1);
  if (along > -out_of_hand * reference_speed(model)) return std::nullopt;
  return reaches_infinite_speed(t);
}

std::optional<std::string> why_motion_ends(const oscillators::SliderSystem& system, double t, const double* y) {
  const auto& model = system.model();
  const auto& law = *model.law;
  if (!law.has_states()) return std::nullopt;
  if (slip_rate_must_jump(system, t, y))
    return fmt::format(
        "friction falls with the slip rate of the contact faster than its damping resists: at t = {:.9g} s that slip "
        "rate, {:.3g} m/s, would have to jump; give the contact more damping (law.contact_stiffness.damping) or none "
        "of its springs",
        t, system.contact_slip_rate(t, y));
  const double N = model.drive.normal_load.value(t);
  if (!system.rigid() && std::abs(system.contact_slip_rate(t, y)) > out_of_hand * reference_speed(model))
    return reaches_infinite_speed(t);
  if (model.lambda != 0) return std::nullopt;
  if (!(system.rigid() && model.slider.mass > 0) && steady::weakens_somewhere(law, N))
    return fmt::format(
        "law.lambda = 0 leaves '{}' a friction curve that weakens, and between it and a spring is no mass: at t = "
        "{:.9g} s, where the curve turns back, slip would have to jump; give the law its memory (lambda > 0), or mass "
        "to a rigid contact",
        law.card().name, t);
  if (const auto rest = why_rest_lasts(system, t, y)) return rest;
  if (unbounded_at_rest(law, N)) return rises_without_bound(law, t);
  return std::nullopt;
}

}  // namespace rosin::analysis::motion
