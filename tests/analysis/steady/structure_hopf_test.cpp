/// Hopf points of structures: a slider's own coefficient, a closed form's threshold, and small cycles.
#include "analysis/steady/structure_hopf.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/steady/mode_windows.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::steady;
using oscillators::Model;

namespace {

Crossing crossing_of(const HopfPoint& point) { return {point.value, point.value_error, true, point.angular_frequency}; }

}  // namespace

TEST_CASE("a structure of one coordinate has the first Lyapunov coefficient of the slider") {
  for (const auto* name : {"ageing", "slip", "prz", "two-state-slip", "nagata"}) {
    INFO(name);
    Model model;
    model.law = laws::find_law(name);
    model.slider = {1, 1e4, 0};
    model.drive.speed = 1e-3, model.drive.normal_load = 1.0;
    const auto points = hopf_points(model, "drive.normal_load");
    REQUIRE_FALSE(points.empty());
    const auto& slider = points.front();
    const auto structure =
        hopf_at([&](double load) { return oscillators::one_slider(model.with("drive.normal_load", load)); },
                crossing_of(slider));
    REQUIRE(structure);
    INFO(slider.first_lyapunov_coefficient << ' ' << structure->first_lyapunov_coefficient << ' ' << structure->error);
    CHECK(structure->error < 1e-4 * std::abs(slider.first_lyapunov_coefficient) + 1e-8);
    CHECK(std::abs(structure->first_lyapunov_coefficient - slider.first_lyapunov_coefficient) <
          3 * structure->error + 1e-8);
    CHECK(structure->criticality == slider.criticality);
  }
}

TEST_CASE("an oscillator whose friction falls exponentially loses stability with a jump, at the closed form's speed") {
  // 2ζ = (F_s − F_d)/v_s e^(−V/v_s); with a linear spring Re c₁ = −F'''V²/16 alone, by averaging.
  const auto at = [](double speed) {
    Model model;
    model.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5, 1.0, 0.0});
    model.slider = {1, 1, 0.1};
    model.drive.speed = speed, model.drive.normal_load = 1.0;
    return oscillators::one_slider(model);
  };
  std::vector<double> speeds;
  for (int i = 0; i < 20; ++i) speeds.push_back(0.5 + 0.1 * i);
  const auto found = scan([&](double speed) { return stability(at(speed)); }, speeds);
  REQUIRE(found.thresholds.size() == 1);
  CHECK(found.thresholds[0].value == Approx(1.151292546497).epsilon(1e-11));
  const auto hopf = hopf_at(at, found.thresholds[0]);
  REQUIRE(hopf);
  CHECK(hopf->criticality == Criticality::subcritical);
  const double V = found.thresholds[0].value, third = -0.1 * 0.5 / (0.5 * 0.5 * 0.5);
  CHECK(hopf->first_lyapunov_coefficient == Approx(-third * V * V / 16).epsilon(1e-6));
}

TEST_CASE("small cycles of two coupled blocks are as large as the normal form says") {
  const auto at = [](double load) {
    Model model;
    model.law = laws::find_law("ageing");
    model.drive.speed = 1e-3, model.drive.normal_load = load;
    const auto contact = oscillators::contact_of(model);
    return oscillators::chain({{1, 1.5}, {8e3}, {0}, {1e4, 1.2e4}, {2, 3}}, {contact, contact});
  };
  const auto found = scan([&](double load) { return stability(at(load)); }, {10, 11, 12});
  REQUIRE(found.thresholds.size() == 1);
  const double threshold = found.thresholds[0].value, beyond = 3e-3 * threshold;
  const auto hopf = hopf_at(at, found.thresholds[0]);
  REQUIRE(hopf);
  CHECK(hopf->criticality == Criticality::supercritical);
  const auto structure = at(threshold + beyond);
  const auto steady = stability(structure).coordinates;
  analysis::motion::StructureModel model{structure, {analysis::motion::Start::Kind::given, {}, {}}};
  model.start.coordinates = {steady[0] + 2e-7, steady[1]};
  const auto cycle = analysis::cycles::find_cycle(model, {.tolerance = 1e-5});
  REQUIRE(cycle.returns == 1);
  // The next term is linear in the distance: 0.0008 here, 0.0003 at a third of it.
  CHECK(cycle.metrics.at("slip_rate_1_amplitude").value / 1e-3 ==
        Approx(hopf->amplitude * std::sqrt(beyond)).epsilon(2e-3));
}
