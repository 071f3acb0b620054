/// Simulated small-signal responses against prediction: swept sine to 1e-6, noise within its own error bars.
#include "analysis/response/frf_simulation.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::response;
using oscillators::Model;
using tests::slider_under;
using Complex = std::complex<double>;

namespace {

const oscillators::Slider any_slider{.mass = 1, .stiffness = 1, .damping = 0};

struct Case {
  Model model;
  double frequency;  ///< Hz, about where the response turns
};

/// Six laws, each about where its state turns.
std::vector<Case> cases() {
  auto sprung = slider_under("slip", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-5, 5);
  sprung.contact_stiffness.tangential = 2e4;
  return {{slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-5, 5), 0.2},
          {slider_under("slip", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-5, 5), 0.2},
          {sprung, 0.2},
          {tests::bristol_board(1e-4, 10), 0.2},
          {slider_under("lugre", {1e4, 3.0, 0.04, 0.4, 0.3, 1e-3}, any_slider, 1e-3, 10), 8.0},
          {slider_under("two-state-slip", laws::find_law("two-state-slip")->values(), any_slider, 1e-5, 5), 0.2},
          {slider_under("nagata", laws::find_law("nagata")->values(), any_slider, 1e-5, 5), 0.2}};
}

}  // namespace

TEST_CASE("swept sine finds the predicted response to 1e-6, within the error that it states", "[frf-simulation]") {
  for (const auto& [model, frequency] : cases()) {
    INFO(model.law->card().name);
    const FrictionResponse response(model);
    const std::vector<double> hertz = {frequency / 8, frequency, 8 * frequency};
    const auto swept = simulate_sweep(model, {.frequencies = hertz, .amplitude = 0.01});
    for (std::size_t k = 0; k < hertz.size(); ++k) {
      const Complex Z = response.tangential({0, 2 * std::numbers::pi * hertz[k]});
      const double off = std::abs(swept.tangential[k] - Z);
      INFO(hertz[k] << " Hz: off " << off << " of " << std::abs(Z) << ", stated " << swept.error[k]);
      CHECK(off <= 1e-6 * std::abs(Z));
      CHECK(off <= swept.error[k] + 1e-9 * std::abs(Z));
      CHECK(swept.coherence[k] > 0.99);
      // The second harmonic grows with amplitude as second-order theory says: share at ε is ε over the amplitude of 1.
      const double foretold =
          0.01 * model.drive.speed.level() / response.amplitude_of_harmonic(2 * std::numbers::pi * hertz[k], 1.0);
      CHECK(swept.second_harmonic[k] == Approx(foretold).epsilon(2e-3).margin(1e-8));
      CHECK(std::abs(swept.at_amplitude[k] - swept.tangential[k]) < 1e-3 * std::abs(Z));
    }
  }
}

TEST_CASE("laws that stick exactly answer in steady slip as predicted", "[frf-simulation]") {
  for (const char* name : {"coulomb", "stribeck", "two-exponential", "static-growth", "slip-weakening"}) {
    INFO(name);
    const auto model = slider_under(name, laws::find_law(name)->values(), any_slider, -2e-3, 7);
    const Complex Z = FrictionResponse(model).tangential({0, 2 * std::numbers::pi});
    const auto swept = simulate_sweep(model, {.frequencies = {1}});
    CHECK(std::abs(swept.tangential[0] - Z) <= 1e-7 * std::abs(Z) + 1e-9);
    CHECK(std::abs(swept.tangential[0] - Z) <= swept.error[0]);
    CHECK(swept.warnings.empty());
  }
  // A friction curve has no memory: closed form, here of Stribeck's.
  const auto stribeck = slider_under("stribeck", {0.4, 0.3, 0.01, 1.0, 0.0}, any_slider, 2e-3, 7);
  const double slope = -0.1 / 0.01 * std::exp(-0.2);
  CHECK(simulate_sweep(stribeck, {.frequencies = {1}}).tangential[0].real() == Approx(7 * slope).epsilon(1e-8));
}

TEST_CASE("moving the load gives the other column of the matrix, and a live mass adds its inertia",
          "[frf-simulation]") {
  auto all = cases();
  auto remembers = all[0].model;
  remembers.load_memory = 0.3;
  auto damped = all[2].model;
  damped.contact_stiffness.damping = 2e3;
  all.push_back({remembers, 0.2});
  all.push_back({damped, 0.2});
  for (const auto& [model, frequency] : all) {
    INFO(model.law->card().name);
    const FrictionResponse response(model);
    const NormalContact normal{.stiffness = 1e4, .damping = 30, .lift = -5};
    const auto swept = simulate_sweep(
        model,
        {.frequencies = {frequency}, .amplitude = 1e-3, .rig = {.sensor_mass = 0.5, .matrix = true, .normal = normal}});
    const Complex s(0, 2 * std::numbers::pi * frequency);
    auto matrix = response.matrix(s, normal);
    matrix.tt += 0.5 * s;
    for (const auto entry : {&ResponseMatrix::tt, &ResponseMatrix::tn, &ResponseMatrix::nt, &ResponseMatrix::nn}) {
      const double off = std::abs(swept.matrix[0].*entry - matrix.*entry);
      INFO("off " << off << " of " << std::abs(matrix.*entry));
      CHECK(off <= 1e-6 * std::abs(matrix.*entry));
      CHECK(off <= (swept.matrix_error[0].*entry).real() + 1e-9 * std::abs(matrix.*entry));
    }
  }
}

TEST_CASE("a sine too large for linear theory says so", "[frf-simulation]") {
  const auto model = cases()[0].model;
  CHECK(simulate_sweep(model, {.frequencies = {1}, .amplitude = 0.01}).warnings.empty());
  const auto warnings = simulate_sweep(model, {.frequencies = {1}, .amplitude = 0.5}).warnings;
  REQUIRE_FALSE(warnings.empty());
  CHECK_THAT(warnings[0], Catch::Contains("second harmonic"));
}

TEST_CASE("noise in slip rate and load finds both columns within their errors", "[frf-simulation][long]") {
  for (const std::size_t which : {0, 2}) {
    const auto [model, frequency] = cases()[which];
    INFO(model.law->card().name);
    const FrictionResponse response(model);
    const auto noise = simulate_noise(model, {.amplitude = 0.001,
                                              .low = frequency / 10,
                                              .high = 4 * frequency,
                                              .resolution = frequency / 20,
                                              .averages = 128,
                                              .rig = {.sensor_mass = 1e4, .matrix = true, .normal = {}},
                                              .welch = {}});
    const auto& m = noise.measured;
    REQUIRE(m.matrix.size() == m.frequency.size());
    int by_slip_rate = 0, by_load = 0;
    for (std::size_t k = 0; k < m.frequency.size(); ++k) {
      const Complex s(0, 2 * std::numbers::pi * m.frequency[k]);
      const auto matrix = response.matrix(s);
      by_slip_rate +=
          std::abs(m.matrix[k].tt - matrix.tt - 1e4 * s) <= 3 * m.matrix_error[k].tt.real() + m.bias_error[k];
      by_load += std::abs(m.matrix[k].tn - matrix.tn) <= 3 * m.matrix_error[k].tn.real();
    }
    CHECK(by_slip_rate >= 0.95 * double(m.frequency.size()));
    CHECK(by_load >= 0.95 * double(m.frequency.size()));
  }
}

TEST_CASE("noise finds the predicted response within three standard errors at 95 % of the frequencies or more",
          "[frf-simulation][long]") {
  for (const auto& [model, frequency] : cases()) {
    INFO(model.law->card().name);
    const FrictionResponse response(model);
    long inside = 0, all = 0;
    for (const std::uint64_t seed : {1, 2}) {
      const auto noise = simulate_noise(model, {.amplitude = 0.02,
                                                .low = frequency / 10,
                                                .high = 4 * frequency,
                                                .resolution = frequency / 20,
                                                .averages = 64,
                                                .seed = seed,
                                                .welch = {}});
      const auto& m = noise.measured;
      for (std::size_t k = 0; k < m.frequency.size(); ++k) {
        const Complex Z = response.tangential({0, 2 * std::numbers::pi * m.frequency[k]});
        ++all;
        inside += std::abs(m.tangential[k] - Z) <= 3 * m.standard_error[k] + m.bias_error[k];
      }
      for (const auto& warning : m.warnings) UNSCOPED_INFO(warning);
      CHECK(m.warnings.empty());
    }
    CHECK(all > 100);
    CHECK(double(inside) / double(all) >= 0.95);
  }
}

TEST_CASE("what cannot be simulated is refused", "[frf-simulation]") {
  const auto coulomb = slider_under("coulomb", {0.5, 0.3}, any_slider, 1e-3, 7);
  CHECK_THROWS_WITH(simulate_noise(coulomb, {.amplitude = 0.5, .low = 1, .high = 2, .resolution = 0.1, .welch = {}}),
                    Catch::Contains("drive.speed reaches or passes 0"));
  auto soft = slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-5, 5);
  soft.contact_stiffness.tangential = 1000;  // below N (b − a)/L = 2500 N/m
  CHECK_THROWS_WITH(simulate_sweep(soft, {.frequencies = {1}}), Catch::Contains("unstable by itself"));
}
