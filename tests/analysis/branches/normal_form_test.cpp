/// Small cycles of the friction oscillator by averaging, in closed form, and beside the cycles that are computed.
#include "analysis/branches/normal_form.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/branches/branches.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::branches;

namespace {

/// m = k = N = 1, damping 0.1, friction 0.5 + 0.5 e^(−v/0.5): F′ = −e^(−2V), F‴ = −4 e^(−2V). Averaging over a period
/// of the velocity a cos t leaves (c + F′(V)) + F‴ a²/8 = 0; steady sliding loses stability where c + F′ = 0.
oscillators::Model friction_oscillator(double speed) {
  oscillators::Model model;
  model.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5, 1.0, 0.0});
  model.slider = {1, 1, 0.1};
  model.drive.normal_load = 1.0, model.drive.speed = speed;
  return model;
}
const double critical = 0.5 * std::log(10);

}  // namespace

TEST_CASE("small cycles of the friction oscillator over speed and damping are those of averaging", "[branches]") {
  const auto model = friction_oscillator(critical);
  // a² = 4 (V − V_c) over the speed, 20 (c − 0.1) over the damping; both above the threshold, where sliding is stable.
  const struct {
    const char* parameter;
    double value, squared;
  } cases[] = {{"drive.speed", critical, 4}, {"oscillator.damping", 0.1, 20}};
  for (const auto& [parameter, value, squared] : cases) {
    CAPTURE(parameter);
    const analysis::steady::Crossing crossing{value, 1e-14, false, 1};
    const auto of_slider = small_cycles(model, parameter, crossing);
    const auto of_structure = small_cycles(
        [&, path = std::string(parameter)](double p) { return oscillators::one_slider(model.with(path, p)); },
        crossing);
    for (const auto& found : {of_slider, of_structure}) {
      REQUIRE(found);
      CHECK(found->slope == Approx(squared / (critical * critical)).epsilon(1e-6));
      // Re c₁ = −μ′/slope, of a growth rate −(c + F′)/2: subcritical, +V²/40 in both parameters.
      CHECK(found->first_lyapunov_coefficient == Approx(critical * critical / 40).epsilon(1e-6));
      CHECK(std::isnan(found->amplitude(value - 1e-3)));
      CHECK(found->amplitude(value + 0.01) == Approx(std::sqrt(0.01 * squared) / critical).epsilon(1e-6));
      CHECK(std::isnan(found->amplitude(value + 2 * critical * critical / squared)));
    }
  }
}

TEST_CASE("computed cycles come to those of the normal form in proportion to the square of their size", "[branches]") {
  const auto model = friction_oscillator(1.5);
  BranchOptions options;
  options.parameter = {1.0, 1.3, false};
  const auto crossings = crossings_of(model, "drive.speed", options.parameter);
  auto found =
      from_steady_sliding([&](double p) { return oscillator_of(model.with("drive.speed", p)); }, options, crossings);
  for (const auto& crossing : found.crossings)
    found.small_cycles.push_back(small_cycles(model, "drive.speed", crossing));
  REQUIRE(found.cycles.size() == 1);
  const auto* small = small_cycles_of(found, found.cycles.front());
  REQUIRE(small);
  int compared = 0;
  for (const auto& point : found.cycles.front().branch.points) {
    const double amplitude = small->amplitude(point.p);
    if (!(amplitude < 0.3)) continue;
    ++compared;
    CAPTURE(point.p, amplitude);
    CHECK(std::abs(point.view.metrics.at("slip_rate_max") / point.p - 1 - amplitude) < 0.5 * amplitude * amplitude);
  }
  CHECK(compared >= 3);
}
