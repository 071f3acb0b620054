/// A slider is a structure of one coordinate: the same cycle by both searches, over the catalogue; and the list of
/// metrics against closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/steady/stability.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis;
using oscillators::Model;

namespace {

Model slider(const char* law, std::vector<Value> parameters, oscillators::Slider mechanics, double speed, double load) {
  Model model;
  model.law = laws::find_law(law)->with(std::move(parameters));
  model.slider = mechanics;
  model.drive.speed = speed, model.drive.normal_load = load;
  return model;
}

/// Sliders that oscillate, under laws of every kind.
std::vector<Model> sliders() {
  constexpr double speed = 1e-6;
  const oscillators::Slider soft{1, 1, 0}, fault{1, 4000, 0};
  std::vector<Model> models = {slider("coulomb", {1.0, 0.6}, soft, 0.2, 1),
                               slider("hyperbolic", {1.0, 3.0}, soft, 0.2, 1),
                               slider("stribeck", {1.0, 0.5, 0.5, 1.0, 0.0}, {1, 1, 0.1}, 0.5, 1),
                               slider("ageing", {0.6, 0.010, 0.015, 1e-6, speed}, fault, speed, 1),
                               slider("ageing", {0.6, 0.010, 0.015, 1e-6, speed}, {0, 4000, 1}, speed, 1),
                               slider("slip", {0.6, 0.010, 0.015, 1e-6, speed}, fault, speed, 1),
                               slider("prz", {0.6, 0.010, 0.015, 1e-6, speed}, fault, speed, 1)};
  for (const double lambda : {1.0, 10.0}) {
    Model board;
    board.slider = {1, 1.09, 0};
    board.drive.speed = 1e-5, board.drive.normal_load = 9.81e-4;
    board.law = laws::preset(*laws::find_law("spinodal"), "bristol-board");
    board.lambda = lambda;
    models.push_back(board);
  }
  return models;
}

cycles::StructureCycle as_structure(const Model& model, double tolerance) {
  motion::StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = motion::Start::Kind::rest;
  return cycles::find_cycle(structure, {.tolerance = tolerance});
}

}  // namespace

TEST_CASE("a slider is a structure of one coordinate: its cycle has the same metrics within their errors", "[cycle]") {
  for (const auto& model : sliders()) {
    CAPTURE(model.law->card().name, model.slider.mass, model.lambda);
    const auto expected = cycles::find_cycle(model, {.tolerance = 1e-8});
    REQUIRE(expected.outcome.complete());
    const auto found = as_structure(model, 1e-8);
    REQUIRE(found.outcome.complete());
    for (const auto& metric : cycles::metric_names()) {
      CAPTURE(metric.name);
      REQUIRE(found.metrics.contains(metric.name));
      const auto& [value, error, unit, meaning] = found.metrics.at(metric.name);
      CHECK(unit == metric.unit);
      // Where the lowest speed touches the threshold a fraction jumps.
      if (expected.ill_conditioned_stick && cycles::is_stick(metric)) continue;
      CHECK(std::abs(value - expected.metrics.*metric.member) <= error + expected.error.*metric.member);
    }
    REQUIRE(!expected.multipliers.empty());
    REQUIRE(!found.multipliers.empty());
    CHECK(std::abs(std::abs(found.multipliers[0]) - std::abs(expected.multipliers[0])) <=
          found.multiplier_errors[0] + expected.multiplier_errors[0]);
  }
}

TEST_CASE("a slider is a structure of one coordinate: its steady sliding has the same eigenvalues", "[stability]") {
  for (const auto& model : sliders()) {
    CAPTURE(model.law->card().name, model.slider.mass, model.lambda);
    const auto expected = steady::stability(model);
    const auto found = steady::stability(oscillators::one_slider(model));
    CHECK(found.stable == expected.stable);
    REQUIRE(found.eigenvalues.size() == expected.eigenvalues.size());
    for (std::size_t i = 0; i < expected.eigenvalues.size(); ++i) {
      const double apart = std::min(std::abs(found.eigenvalues[i] - expected.eigenvalues[i]),
                                    std::abs(std::conj(found.eigenvalues[i]) - expected.eigenvalues[i]));
      CHECK(apart <= 2 * expected.eigenvalue_errors[i] + found.modes.front().error);
    }
  }
}

TEST_CASE("harmonics, distortion, way and heat of a linear oscillation are those of the closed form", "[cycle]") {
  // Friction that does not change leaves m ẍ + c ẋ + k x = μN + 0.3 cos(1.3 t) + 0.1 cos(3.9 t + 0.4).
  constexpr double m = 1.2, c = 0.3, k = 2, w = 1.3, N = 0.7, mu = 0.4, V = 5;
  auto model = slider("coulomb", {mu, mu}, {m, k, c}, V, N);
  model.drive.force = Signal(Signal::Harmonics{0, {{0.3, w, 0}, {0.1, 3 * w, 0.4}}});
  const auto cycle = as_structure(model, 1e-9);
  REQUIRE(cycle.outcome.complete());
  const auto answer = [&](double force, double omega) {
    return force / std::complex<double>(k - m * omega * omega, c * omega);
  };
  const auto first = answer(0.3, w), third = answer(0.1, 3 * w) * std::polar(1.0, 0.4);
  const double period = 2 * std::numbers::pi / w;
  const std::pair<const char*, double> wanted[] = {{"displacement_mean", mu * N / k},
                                                   {"displacement_harmonic_1", std::abs(first)},
                                                   {"displacement_phase_1", std::arg(first)},
                                                   {"displacement_harmonic_2", 0},
                                                   {"displacement_harmonic_3", std::abs(third)},
                                                   {"displacement_phase_3", std::arg(third)},
                                                   {"displacement_distortion", std::abs(third) / std::abs(first)},
                                                   {"slip_distance", V * period},
                                                   {"stick_fraction", 0},
                                                   {"slow_fraction", 0},
                                                   {"loop_area", 0},
                                                   {"friction_work", mu * N * V * period}};
  for (const auto& [name, value] : wanted) {
    CAPTURE(name);
    const auto& metric = cycle.metrics.at(name);
    constexpr double rounding = 1e-13;
    CHECK(std::abs(metric.value - value) <= metric.error + rounding * std::max(1.0, std::abs(value)));
    CHECK(metric.error < 1e-7 * std::max(1.0, std::abs(value)));
  }
}
