/// Growth of the partials of a string under a sliding bow, against closed forms, and against the motion itself.
#include "analysis/strings/sliding.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::strings;
using Catch::Matchers::Contains;
using std::numbers::pi;

namespace {

/// A string without losses and torsion, of whole delays, under a bow at 0.1 m/s on which friction falls by `slope`
/// (N s/m) with the slip rate: F_s/(1 + δ|v|) by a load of 1 N.
BowedStringModel lossless(int period, int to_bridge, double slope) {
  BowedStringModel model;
  auto& string = model.string;
  string.sample_rate = 1e5;
  string.frequency = string.sample_rate / period;
  string.bow_position = double(to_bridge) / period;
  string.quality = oscillators::BowedString::none;
  string.corner_rounding = 0;
  string.torsion.reset();
  string.delays = oscillators::DelayLine::integer;
  constexpr double V = 0.1, delta = 10;  // m/s, s/m
  model.law = laws::find_law("hyperbolic")->with({slope * (1 + delta * V) * (1 + delta * V) / delta, delta});
  model.speed.signal = Signal(V);
  model.load.signal = Signal(1);
  return model;
}

const StringSliding::Mode& partial(const StringSliding& sliding, int n) {
  return *std::ranges::find_if(sliding.modes, [&](const auto& mode) { return mode.partial == n && !mode.torsional; });
}

}  // namespace

TEST_CASE("under a bow in the middle of a lossless string odd partials grow by the closed form", "[string]") {
  // Z₀ (coth(T s/4) + coth(T s/4)) = κ: s = (2/T) (ln((2Z₀ + κ)/(2Z₀ − κ)) + iπ (2k + 1)).
  const double kappa = 0.4;
  const auto model = lossless(200, 100, kappa);
  const double f = model.string.frequency, Z = model.string.impedance;
  const auto sliding = sliding_stability(model);
  REQUIRE(sliding.outcome.complete());
  CHECK(sliding.slope == Approx(-kappa).epsilon(1e-12));
  CHECK(sliding.impedance == Approx(2 * Z));
  CHECK_FALSE(sliding.stable);
  const double growth = 2 * f * std::log((2 * Z + kappa) / (2 * Z - kappa));
  for (const int n : {1, 3, 11, 49}) {
    CAPTURE(n);
    const auto& mode = partial(sliding, n);
    CHECK(mode.eigenvalue.real() == Approx(growth).epsilon(1e-10));
    CHECK(mode.eigenvalue.imag() == Approx(2 * pi * n * f).epsilon(1e-10));
    CHECK(mode.error < 1e-8 * growth);
  }
  for (const int n : {2, 10}) {  // the bow is at a node
    CHECK(std::abs(partial(sliding, n).eigenvalue.real()) < 1e-6);
    CHECK(partial(sliding, n).eigenvalue.imag() == Approx(2 * pi * n * f).epsilon(1e-10));
  }
  CHECK(sliding.unstable_modes() == 25);
}

TEST_CASE("a sliding bow lets a lossless string move by the closed form, with hair and without", "[string]") {
  // Y = (i/Z₀) sin(ωβT/2) sin(ω(1 − β)T/2)/sin(ωT/2); friction adds −κ of the slip rate, hair H = s/(k + c s).
  using Complex = std::complex<double>;
  const double kappa = 0.4, beta = 1.0 / 3;
  for (const bool hair : {false, true}) {
    auto model = lossless(300, 100, kappa);
    if (hair) model.string.bow.hair_stiffness = 5e4, model.string.bow.hair_damping = 3;
    const auto receptance = sliding_receptance(model, 0);
    for (const double f : {20.0, 150.0, 700.0, 1234.0}) {
      CAPTURE(hair, f);
      const double angle = pi * f / model.string.frequency;
      const Complex s(0, 2 * pi * f), H = hair ? s / (5e4 + 3.0 * s) : 0.0;
      const Complex Y = Complex(0, 1) / model.string.impedance * std::sin(beta * angle) * std::sin((1 - beta) * angle) /
                        std::sin(angle);
      const Complex expected = (Y + Y * kappa * Y / (1.0 - kappa * (Y + H))) / s;
      const auto answer = receptance.at(s);
      CHECK(std::abs(answer.contact - expected) <= answer.contact_error);
      CHECK(answer.contact_error < 1e-9 * std::abs(expected));
    }
  }
  auto idle = lossless(300, 100, kappa);
  idle.speed.signal = Signal(0);
  CHECK_THROWS_WITH(sliding_receptance(idle, 0), Contains("drive.speed is 0 m/s"));
}

TEST_CASE("under a bow at a third of a lossless string partials grow and shift by the closed form", "[string]") {
  // With z = e^{−T s/3} and k = κ/Z₀: (2 + k) z² + 2 z + 2 − k = 0.
  const double k = 0.9;
  auto model = lossless(300, 100, k * 0.55);
  const double T = 1 / model.string.frequency;
  const auto sliding = sliding_stability(model);
  REQUIRE(sliding.outcome.complete());
  const double growth = 1.5 / T * std::log((2 + k) / (2 - k)), angle = std::atan2(std::sqrt(3 - k * k), -1);
  CHECK(partial(sliding, 1).eigenvalue.real() == Approx(growth).epsilon(1e-10));
  CHECK(partial(sliding, 1).eigenvalue.imag() == Approx(3 / T * angle).epsilon(1e-10));
  CHECK(partial(sliding, 2).eigenvalue.imag() == Approx(3 / T * (2 * pi - angle)).epsilon(1e-10));
  CHECK(std::abs(partial(sliding, 3).eigenvalue.real()) < 1e-6);
  // A weak slope: κ sin²(nπβ) over the mass Z₀/(2f₀) of the string.
  const auto weak = sliding_stability(lossless(300, 30, 1e-4));
  for (const int n : {1, 2, 7})
    CHECK(partial(weak, n).eigenvalue.real() ==
          Approx(2 / T * 1e-4 / 0.55 * std::pow(std::sin(n * pi / 10), 2)).epsilon(1e-3));
}

TEST_CASE("friction that rises, or that losses outweigh, leaves the bow sliding", "[string]") {
  auto viscous = lossless(200, 60, 0.1);
  viscous.law = laws::find_law("stribeck")->with({0.1, 0.1, 0.5, 1.0, 0.2});
  const auto rising = sliding_stability(viscous);
  CHECK(rising.slope == Approx(0.2));
  CHECK(rising.outcome.complete());
  CHECK(rising.unstable_modes() == 0);
  CHECK(partial(rising, 1).eigenvalue.real() < 0);
  auto damped = lossless(200, 60, 1e-3);
  damped.string.quality = 50;
  const auto quiet = sliding_stability(damped);
  CHECK(quiet.stable);
  // e^{−π/Q} in a period.
  CHECK(partial(quiet, 10).eigenvalue.real() == Approx(-pi * damped.string.frequency / 50).epsilon(1e-3));
}

TEST_CASE("friction that falls by more than the impedance of the string makes slip jump", "[string]") {
  const auto nearly = sliding_stability(lossless(200, 60, 1.09));
  CHECK_FALSE(nearly.jumps);
  CHECK(nearly.outcome.complete());
  CHECK(nearly.unstable_modes() == 45);
  const auto jumps = sliding_stability(lossless(200, 60, 1.11));
  CHECK(jumps.jumps);
  CHECK_FALSE(jumps.stable);
  CHECK(jumps.modes.empty());
  auto still = lossless(200, 60, 0.1);
  still.speed.signal = Signal(0);
  CHECK_THROWS_WITH(sliding_stability(still), Contains("drive.speed is 0 m/s"));
}

TEST_CASE("the motion of the sampled string grows at a partial as linear theory says", "[string]") {
  // The bow sets off at its speed: friction of 4 % of Z V is a step that excites all partials.
  for (const bool rounded : {false, true}) {
    CAPTURE(rounded);
    auto model = lossless(200, 50, 0.01);
    if (rounded) {
      model.string.delays = oscillators::DelayLine::lagrange;
      model.string.corner_rounding = 40e-6, model.string.quality = 300;
      model.string.bow_position = 0.2237;
      model.string.torsion.emplace();
    }
    const auto sliding = sliding_stability(model);
    REQUIRE(sliding.outcome.complete());
    const auto s = partial(sliding, 2).eigenvalue;
    oscillators::StringLanes strings(model.string, model.law, 1);
    strings.begin(0, model);
    // The part of the velocity at the frequency of the mode, in two windows of twenty periods.
    constexpr int length = 20 * 200, apart = 40 * 200, first = 10 * 200;
    std::complex<double> early = 0, late = 0;
    for (int n = 0; n < first + apart + length; ++n) {
      strings.step();
      for (const auto& [begin, part] : {std::pair{first, &early}, std::pair{first + apart, &late}}) {
        if (n < begin || n >= begin + length) continue;
        const double weight = 1 - std::cos(2 * pi * (n - begin + 0.5) / length);
        *part += weight * strings.velocity(0)[0] * std::polar(1.0, -s.imag() * n * model.string.step());
      }
    }
    const double growth = std::log(std::abs(late) / std::abs(early)) / (apart * model.string.step());
    CHECK(growth == Approx(s.real()).epsilon(0.03));
    CHECK(std::abs(std::arg(late / early)) / (apart * model.string.step()) < 1e-4 * s.imag());
  }
}
