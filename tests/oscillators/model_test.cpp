/// Models: every path can be read and changed within its range, and parts that do not fit are refused.
#include "oscillators/model.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/error.hpp"
#include "core/units.hpp"
#include "laws/catalogue.hpp"

using rosin::infinity;
using rosin::oscillators::Model;

namespace {
Model slider(const char* law) {
  Model model;
  model.law = rosin::laws::find_law(law);
  return model;
}
}  // namespace

TEST_CASE("every parameter of a model can be read back after it was changed") {
  for (const char* law : {"spinodal", "ageing"}) {
    const Model model = slider(law);
    for (const auto& quantity : model.parameters()) {
      CAPTURE(quantity.name);
      CHECK(rosin::unit_known(quantity.unit));
      CHECK_FALSE(quantity.meaning.empty());
      const double low = quantity.range.low;
      CHECK(model.with(quantity.name, low).get(quantity.name) == low);
      CHECK(model.describe(quantity.name).unit == quantity.unit);
      CHECK_THROWS_WITH(model.with(quantity.name, std::nextafter(low, -infinity)), Catch::StartsWith(quantity.name));
      CHECK_THROWS_WITH(model.with(quantity.name, NAN), Catch::Contains("NaN"));
    }
  }
}

TEST_CASE("changing a law's parameter leaves the other values alone") {
  const Model model = slider("ageing"), changed = model.with("law.L", 2e-5);
  CHECK(changed.get("law.L") == 2e-5);
  CHECK(changed.get("law.a") == model.get("law.a"));
  CHECK(model.get("law.L") != 2e-5);
}

TEST_CASE("an unknown path names the nearest one") {
  const Model model = slider("ageing");
  CHECK_THROWS_WITH(model.get("oscillator.stifness"), Catch::Contains("did you mean 'oscillator.stiffness'?"));
  CHECK_THROWS_AS(model.with("law.mu_s", 1), rosin::InputError);
  CHECK_THROWS_AS(slider("coulomb").get("law.lambda"), rosin::InputError);  // it has no states
}

TEST_CASE("the level of an oscillating load changes, its swing stays") {
  Model model = slider("ageing");
  model.drive.normal_load = rosin::Signal(rosin::Signal::Harmonics{9.8, {{5, 15, 0}}});
  CHECK(model.get("drive.normal_load") == 9.8);
  CHECK(model.with("drive.normal_load", 20).drive.normal_load.value(0) == 25);
  CHECK_FALSE(model.drive.constant());
}

TEST_CASE("parts that do not fit together are refused with the reason") {
  Model coulomb = slider("coulomb");
  CHECK_NOTHROW(coulomb.check());
  coulomb.slider.mass = 0;
  CHECK_THROWS_WITH(coulomb.check(), Catch::Contains("oscillator.mass = 0 does not go with law 'coulomb'"));

  Model spring = slider("coulomb");
  spring.contact_stiffness.tangential = 1e6;
  CHECK_THROWS_WITH(spring.check(), Catch::Contains("give mu_s = mu_d (a Jenkins element)"));

  Model ageing = slider("ageing");
  ageing.contact_stiffness = {1e6, 1e5};
  CHECK_THROWS_WITH(ageing.check(), Catch::Contains("not both"));
  ageing.contact_stiffness = {1e6, infinity, 1, 1};
  CHECK_THROWS_WITH(ageing.check(), Catch::Contains("damping or damping_per_load, not both"));
  ageing.contact_stiffness = {infinity, infinity, 1};
  CHECK_THROWS_WITH(ageing.check(), Catch::Contains("damping without a spring"));
  ageing.contact_stiffness = {};
  ageing.slider.stiffness = infinity;
  CHECK_THROWS_WITH(ageing.check(), Catch::Contains("needs oscillator.mass = 0"));
  ageing.slider.mass = 0;
  CHECK_NOTHROW(ageing.check());
  ageing.slider.stiffness = 0;
  CHECK_THROWS_WITH(ageing.check(), Catch::Contains("nothing resists"));
  ageing.slider.damping = 1;
  CHECK_NOTHROW(ageing.check());
  ageing.lambda = -1;
  CHECK_THROWS_WITH(ageing.check(), Catch::Contains("law.lambda = -1 is outside"));
}

TEST_CASE("numbers whose products leave the range of numbers are refused by their keys", "[oscillators]") {
  Model model;
  model.law = rosin::laws::find_law("coulomb");
  CHECK_THROWS_WITH(model.with("oscillator.mass", 1e-310),
                    Catch::Contains("is outside 0 … 1000000000000, with magnitudes other than 0 from 1e-60 on"));
  CHECK_THROWS_WITH(model.with("oscillator.stiffness", 1e200),
                    Catch::Contains("is outside 0 … inf, with magnitudes other than 0 from 1e-60 on up to 1e+60"));
  CHECK_THROWS_WITH(model.with("drive.speed", -5e-324), Catch::Contains("drive.speed = -5e-324 is outside"));
  for (const auto& [path, value] : {std::pair{"oscillator.mass", 0.0}, std::pair{"oscillator.mass", 1e-60},
                                    std::pair{"drive.speed", -1e-60}, std::pair{"oscillator.stiffness", 1e60}})
    CHECK(model.with(path, value).get(path) == value);
}
