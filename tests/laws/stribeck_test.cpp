/// Stribeck curve against the parameters of Table I in Canudas de Wit et al. (1995).
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("stribeck: the curve of the LuGre paper", "[laws][stribeck]") {
  // F_S = 1.5 N, F_C = 1 N, v_s = 0.001 m/s, sigma_2 = 0.4 N s/m: F(v_s) = 1 + 0.5/e + 0.0004 N.
  const auto law = laws::preset(*laws::find_law("stribeck"), "canudas-de-wit");
  CHECK(law->friction({1e-3, 1}, {}) == Approx(1.18433972058572117).epsilon(1e-15));
  CHECK(law->steady_friction({1e-3, 1}).slope == Approx(0.4 - 2 * 0.5 * std::exp(-1) / 1e-3).epsilon(1e-13));
  CHECK(law->static_limit(1) == 1.5);
  CHECK(law->friction({1.0, 1}, {}) == Approx(1.4).epsilon(1e-15));
}

TEST_CASE("stribeck: other exponents, small and large arguments", "[laws][stribeck]") {
  const auto exponential = laws::find_law("stribeck")->with("exponent", 1.0);
  CHECK(exponential->friction({0.02, 1}, {}) == Approx(0.3 + 0.1 * std::exp(-2)).epsilon(1e-15));
  CHECK(exponential->steady_friction({1e-12, 1}).slope == Approx(-10).epsilon(1e-9));  // -(mu_s - mu_d)/v_s
  for (const double exponent : {0.1, 2.0, 10.0}) {
    const auto law = laws::find_law("stribeck")->with("exponent", exponent);
    CHECK(law->friction({1e-300, 1}, {}) == Approx(0.4).epsilon(1e-9));
    CHECK(law->friction({1e30, 1}, {}) == Approx(0.3).epsilon(1e-9));
  }
}
