/// The reasons, from the law's limits and from the speed reached.
#include "analysis/motion_end.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/curve.hpp"

namespace rosin::analysis {

bool unbounded_at_rest(const FrictionLaw& law, double normal_load) {
  if (law.set_valued()) return false;
  constexpr double nearly_rest = 1e-140;  // m/s: ages L/v and their slopes stay finite
  const auto there = law.steady_friction({nearly_rest, normal_load});
  return !(there.slope > 0) && there.friction > 0;
}

std::optional<std::string> why_motion_ends(const oscillators::SliderSystem& system, double t, const double* y) {
  const auto& model = system.model();
  const auto& law = *model.law;
  if (!law.has_states()) return std::nullopt;
  const double N = model.drive.normal_load.value(t);
  constexpr double out_of_hand = 1e8;  // times the drive speed
  const double V = std::max(std::abs(model.drive.speed.level()), 1e-12);
  if (!system.rigid() && std::abs(system.contact_slip_rate(t, y)) > out_of_hand * V)
    return fmt::format(
        "between friction and a spring is neither mass nor damping: slip reaches infinite speed at t = {:.9g} s; give "
        "the slider mass or damping (of radiation), and leave out a contact stiffness as low as this",
        t);
  if (model.lambda != 0) return std::nullopt;
  if (!(system.rigid() && model.slider.mass > 0) && weakens_somewhere(law, N))
    return fmt::format(
        "law.lambda = 0 leaves '{}' a friction curve that weakens, and between it and a spring is no mass: at t = "
        "{:.9g} s, where the curve turns back, slip would have to jump; give the law its memory (lambda > 0), or mass "
        "to a rigid contact",
        law.card().name, t);
  if (unbounded_at_rest(law, N))
    return fmt::format(
        "law.lambda = 0 leaves '{}' a friction curve that rises without bound toward rest: at rest at t = {:.9g} s, "
        "nothing slips again; give the law its memory (lambda > 0)",
        law.card().name, t);
  return std::nullopt;
}

}  // namespace rosin::analysis
