/// Perrin-Rice-Zheng law (1995): steady age 2L/v, ageing at rest, relaxation at constant speed as a hyperbolic tangent.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("prz: steady age and friction", "[laws][prz]") {
  const auto law = laws::find_law("prz");
  CHECK(law->steady({1e-6, 1})[0] == Approx(20).epsilon(1e-15));                                     // 2L/v, L = 10 um
  CHECK(law->friction({3e-6, 1}, std::vector{2.0}) == Approx(0.576447346491770412).epsilon(1e-15));  // 30 digits
  CHECK(law->rate({0, 1}, std::vector{2.0})[0] == 1);
}

TEST_CASE("prz: constant-speed relaxation follows 2L/v tanh(v t/2L)", "[laws][prz]") {
  // theta' = 1 - (v theta/2L)^2 from theta = 0: the rate at that solution must be sech^2(v t/2L).
  const auto law = laws::find_law("prz");
  const double v = 1e-5, L = 10e-6;
  for (const double t : {0.1, 1.0, 3.0}) {
    const double theta = 2 * L / v * std::tanh(v * t / (2 * L));
    CHECK(law->rate({v, 1}, std::vector{theta})[0] == Approx(std::pow(std::cosh(v * t / (2 * L)), -2)).epsilon(1e-13));
  }
}

TEST_CASE("prz: one steady curve with ageing and slip, also beyond the range of exponentials", "[laws][prz]") {
  for (const double mu0 : {0.6, 5.0})
    for (const double v : {1e-9, 1e-5, 1e-1}) {
      const auto curve = [&](const char* name) {
        return laws::find_law(name)->with("mu0", mu0)->with("a", 0.005)->steady_friction({v, 1});
      };
      CHECK(curve("prz").friction == Approx(curve("ageing").friction).epsilon(1e-14));
      CHECK(curve("prz").slope == Approx(curve("slip").slope).epsilon(1e-12));
    }
}

TEST_CASE("prz: how far from steady sliding the three laws with one steady curve part", "[laws][prz]") {
  // With w = ln(theta/steady theta): L dw/dx = -sinh w (prz), -w (slip), -(1 - e^{-w}) (ageing); equal for small w.
  const double v = 1e-5, L = 10e-6;
  for (const double w : {-5.0, -0.3, 1e-6, 0.3, 5.0}) {
    const auto decay = [&](const char* name) {
      const auto law = laws::find_law(name);
      const double theta = law->steady({v, 1})[0] * std::exp(w);
      return L * law->rate({v, 1}, std::vector{theta})[0] / theta / v;
    };
    CHECK(decay("prz") == Approx(-std::sinh(w)).epsilon(1e-9));
    CHECK(decay("slip") == Approx(-w).epsilon(1e-9));
    CHECK(decay("ageing") == Approx(std::expm1(-w)).epsilon(1e-9));
  }
}
