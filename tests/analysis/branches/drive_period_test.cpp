/// Branches along the frequency of a drive, whose period the cycles take at each value.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/branches/branches.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"
#include "oscillators/structure.hpp"

using namespace rosin;
using namespace rosin::analysis;
using oscillators::Model;

namespace {

Signal swinging(double mean, double amplitude, double angular_frequency) {
  return Signal(Signal::Harmonics{mean, {{amplitude, angular_frequency, 0}}});
}

/// A slider whose force, load or belt swings with a frequency.
std::function<Model(double)> random_scene(int what, std::mt19937& dice) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(dice); };
  Model model;
  const double mu = between(0.1, 0.4);
  const int law = std::uniform_int_distribution(0, 2)(dice);
  if (law == 0) model.law = laws::find_law("coulomb")->with({mu, mu});
  if (law == 1) model.law = laws::find_law("stribeck")->with({1.05 * mu, mu, between(0.2, 0.6), 1.0, 0.0});
  if (law == 2) model.law = laws::find_law("coulomb")->with({1.1 * mu, mu});
  model.slider = {between(0.5, 2), between(0.5, 2), between(0.1, 0.4)};
  const double amplitude = between(0.3, 0.6);
  if (what == 0) {
    model.drive.speed = 0, model.drive.normal_load = 1;
    return [=](double w) {
      Model at = model;
      at.drive.force = swinging(0, 3 * amplitude, w);
      return at;
    };
  }
  model.drive.speed = between(0.5, 1), model.drive.normal_load = 1;
  return [=](double w) {
    Model at = model;
    (what == 1 ? at.drive.normal_load : at.drive.speed) =
        what == 1 ? swinging(1, amplitude, w) : swinging(model.drive.speed.level(), amplitude, w);
    return at;
  };
}

}  // namespace

TEST_CASE(
    "along the frequency of force, load or belt each cycle has the drive's period there, and is that of the search",
    "[long][branches][drive_period]") {
  std::mt19937 dice(7);
  int compared = 0;
  for (int k = 0; k < 30; ++k) {
    const int what = k % 3;
    const auto model_at = random_scene(what, dice);
    const double from = std::uniform_real_distribution(0.6, 1.5)(dice), to = 1.25 * from;
    INFO("scene " << k);
    const auto settled = branches::settle(model_at(from), 1e-8);
    REQUIRE(settled.outcome.complete());
    branches::BranchOptions options;
    options.parameter = {from, to, false};
    options.at = {1.07 * from, 1.19 * from};
    options.doublings = 0;
    const auto found =
        branches::from_cycle([&](double w) { return branches::oscillator_of(model_at(w)); }, settled, from, options);
    for (const auto& cycle : found.cycles)
      for (const auto& point : cycle.branch.points) {
        const double period = point.view.metrics.at("period");
        CHECK(std::abs(period / (settled.turns * 2 * std::numbers::pi / point.p) - 1) < 1e-12);
        if (!point.asked || !point.view.stable) continue;
        motion::StructureModel there{oscillators::one_slider(model_at(point.p)), {}};
        there.start.unknowns = point.view.start;
        const auto searched = cycles::find_cycle(there, {.tolerance = 1e-8, .multipliers = false});
        if (!searched.outcome.complete()) continue;
        ++compared;
        REQUIRE(searched.returns == settled.turns);
        CHECK(std::abs(searched.start[0] - point.view.start[0]) < 1e-7);
        CHECK(std::abs(searched.start[1] - point.view.start[1]) < 1e-7);
        const double amplitude = searched.metrics.at("displacement_amplitude").value;
        const double size = std::abs(searched.metrics.at("displacement_max").value);
        CHECK(std::abs(point.view.metrics.at("displacement_amplitude") - amplitude) < 1e-4 * amplitude + 1e-9 * size);
      }
  }
  CHECK(compared >= 40);
}

TEST_CASE("a frequency of one of two terms of a drive has no period along it, which is said",
          "[branches][drive_period]") {
  Model model;
  model.law = laws::find_law("coulomb")->with({0.2, 0.2});
  model.slider = {1, 1, 0.2};
  model.drive.speed = 0, model.drive.normal_load = 1;
  const branches::Family family = [&](double w) {
    Model at = model;
    at.drive.force = Signal(Signal::Harmonics{0, {{1, w, 0}, {0.5, 2, 0}}});
    return branches::oscillator_of(at);
  };
  CHECK_THROWS_WITH(branches::require_continuous_period(family, {1, 2, false}, 1),
                    Catch::Matchers::Contains("does not vary continuously along the parameter"));
}
