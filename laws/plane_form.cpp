/// The part of a turning state, asked at slip either way.
#include "laws/plane_form.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "laws/catalogue.hpp"
#include "laws/regions.hpp"

namespace rosin::laws {

namespace {

/// What friction and the rates are at a slip rate, the turning state moved to `z`.
std::vector<double> answers(const FrictionLaw& law, Sliding<double> at, std::vector<double> state, int turning,
                            double z) {
  state[std::size_t(turning)] = z;
  auto all = law.rate(at, state);
  all.push_back(law.friction(at, state));
  return all;
}

/// True where the turning state's part of friction and of its own rate, and the rates of other states, do not depend on
/// the direction of slip. Mirrored motion shows slip the other way: f(v, z) + f(v, −z) = 2 f(v, 0) of what changes
/// sign, f(v, z) = f(v, −z) of what does not.
bool separates(const FrictionLaw& law, double load, int turning) {
  constexpr double least = 1e-9, most = 10, rounding = 1e-9;
  for (double v = least; v <= most; v *= 10) {
    const auto steady = law.steady({v, load});
    for (const double part : {0.1, 0.7, 1.3}) {
      const double z = part * steady[std::size_t(turning)];
      const auto along = answers(law, {v, load}, steady, turning, z),
                 back = answers(law, {v, load}, steady, turning, -z),
                 none = answers(law, {v, load}, steady, turning, 0);
      for (std::size_t i = 0; i < along.size(); ++i) {
        const bool odd = i == std::size_t(turning) || i + 1 == along.size();
        const double apart = odd ? along[i] + back[i] - 2 * none[i] : along[i] - back[i];
        const double size = std::abs(along[i]) + std::abs(back[i]) + 2 * std::abs(none[i]);
        if (!(std::abs(apart) <= rounding * size)) return false;
      }
    }
  }
  return true;
}

}  // namespace

int turning_state(const FrictionLaw& law) {
  const auto& states = law.states();
  const auto found = std::ranges::find(states, Parity::odd, &Quantity::parity);
  return found == states.end() ? -1 : int(found - states.begin());
}

std::string refusal_in_plane(const FrictionLaw& law, double normal_load) {
  if (law.set_valued())
    return "has states and is set-valued at rest, which is followed along a line only; solver.smoothing makes it "
           "smooth";
  if (region_width(law) > 0) return "by regions needs the force that would hold the contact";
  const auto turning = std::ranges::count(law.states(), Parity::odd, &Quantity::parity);
  if (turning == 0) return "";
  if (turning > 1)
    return fmt::format("has {} states that turn with the slip, and one has a form in the plane", turning);
  const int k = turning_state(law);
  if (separates(law, normal_load, k)) return "";
  return fmt::format(
      "has no known form in the plane: what '{}' does to its friction or rates depends on whether slip goes with it or "
      "against it, which a vector leaves open at other angles",
      law.states()[std::size_t(k)].name);
}

std::vector<std::string_view> names_in_plane() {
  std::vector<std::string_view> names;
  for (const auto& law : catalogue())
    if (law->has_states() && refusal_in_plane(*law, 1).empty()) names.push_back(law->card().name);
  return names;
}

}  // namespace rosin::laws
