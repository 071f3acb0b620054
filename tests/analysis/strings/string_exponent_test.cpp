/// How fast neighbouring motions of a bowed string approach each other or diverge.
#include "analysis/strings/string_exponent.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::strings;
using Catch::Matchers::Contains;
using std::numbers::pi;

namespace {

BowedStringModel bowed(std::shared_ptr<const FrictionLaw> law, double load) {
  BowedStringModel model;
  model.string.sample_rate = 24000;
  model.law = std::move(law);
  model.speed.signal = Signal(0.1);
  model.load.signal = Signal(load);
  return model;
}

}  // namespace

TEST_CASE("under a bow that slides by Coulomb friction strings approach each other by the losses of their ends",
          "[string][lyapunov]") {
  // No friction changes with the slip rate: each partial decays by e^{-pi/Q} a period.
  for (const double quality : {20.0, 60.0}) {
    auto model = bowed(laws::find_law("coulomb")->with({0.3, 0.3}), 0.02);
    model.string.quality = quality;
    model.string.corner_rounding = 0;
    model.string.frequency = 150, model.string.delays = oscillators::DelayLine::integer;  // which lose nothing
    model.string.torsion.reset();
    const double decay = -pi / quality * model.string.frequency;
    const auto spectrum = lyapunov_spectrum(model, {.duration = 0.3, .transient = 0.6});
    CAPTURE(quality);
    REQUIRE(spectrum.outcome.complete());
    REQUIRE(spectrum.exponents.size() == 1);
    const auto& exponent = spectrum.exponents[0];
    CHECK(std::abs(exponent.value - decay) <= exponent.error + 1e-3 * std::abs(decay));
    CHECK(exponent.error < 0.02 * std::abs(decay));
  }
}

TEST_CASE("a string goes on from its state as it would have gone on, with hair, body, stiffness and states",
          "[string][lyapunov]") {
  auto model = bowed(laws::find_law("ageing"), 1);
  for (const bool all : {false, true}) {
    if (all) {
      model.law = laws::find_law("two-exponential");
      model.start = oscillators::StringStart::helmholtz;
      model.string.inharmonicity = 1e-6, model.string.bow_position = 0.2;
      model.string.body = {{300, 0.1, 30}};
      model.string.bow = {.contacts = 2, .width = 0.03, .hair_stiffness = 5e4, .hair_damping = 1};
      model.string.sample_rate = 192000;
    }
    const auto oscillator = stepped(model);
    const auto one = oscillator.motion(1e-6, false);
    const auto other = oscillator.motion(1e-6, false);
    one->start(0, oscillator.start);
    for (int i = 0; i < 3000; ++i) one->advance(1);
    other->start(one->time(), one->state());
    for (int i = 0; i < 3000; ++i) one->advance(1), other->advance(1);
    CHECK(other->time() == Approx(one->time()));
    CHECK(one->state() == other->state());
    CHECK(one->state() != oscillator.start);
  }
  model.speed.signal = Signal(0);
  CHECK_THROWS_WITH(stepped(model), Contains("a bow at rest moves no string"));
}
