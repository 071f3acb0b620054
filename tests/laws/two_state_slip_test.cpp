/// Two-state slip law against Ruina (1983) and Gu, Rice, Ruina & Tse (1984): two exponential relaxations in slip.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("two-state-slip: friction, and no healing at rest", "[laws][two-state-slip]") {
  const auto law = laws::find_law("two-state-slip");
  const std::vector theta{0.5, 70.0};
  CHECK(law->friction({3e-6, 1}, theta) == Approx(0.601867168364214617).epsilon(1e-15));  // 30-digit arithmetic
  CHECK(law->rate({0, 1}, theta) == std::vector{0.0, 0.0});
}

TEST_CASE("two-state-slip: each state relaxes exponentially with its own slip distance", "[laws][two-state-slip]") {
  // After a velocity step ln(v theta_i/L_i) = ln(V2/V1) e^{-x/L_i} (Gu et al. 1984): d ln theta_i/dx = -ln(V2/V1)/L_i
  // at x = 0.
  const auto law = laws::find_law("two-state-slip");
  const auto before = law->steady({1e-6, 1});
  const double v = 1e-5;
  const auto rate = law->rate({v, 1}, before);
  CHECK(rate[0] / before[0] / v == Approx(-std::log(10) / 2e-6).epsilon(1e-13));
  CHECK(rate[1] / before[1] / v == Approx(-std::log(10) / 40e-6).epsilon(1e-13));
  // Direct effect a ln 10, then a fall by (b1 + b2) ln 10.
  CHECK(law->friction({v, 1}, before) == Approx(0.6 + 0.010 * std::log(10)).epsilon(1e-14));
  CHECK(law->steady_friction({v, 1}).friction == Approx(0.6 - 0.005 * std::log(10)).epsilon(1e-14));
}

TEST_CASE("two-state-slip: negative b2, and exponents beyond the range of doubles", "[laws][two-state-slip]") {
  const auto law = laws::find_law("two-state-slip")->with("mu0", 5.0)->with("a", 0.005)->with("b2", -0.006);
  CHECK(law->friction({1e-6, 1}, law->steady({1e-6, 1})) == Approx(5).epsilon(1e-14));
  CHECK(law->steady_friction({1e-6, 1}).slope == Approx((0.005 - 0.009 + 0.006) / 1e-6).epsilon(1e-10));
}
