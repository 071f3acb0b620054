/// Two-state ageing law against 30-digit arithmetic and the one-state law that it contains (Ruina 1983).
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("two-state-ageing: friction and rates of both states", "[laws][two-state-ageing]") {
  const auto law = laws::find_law("two-state-ageing");
  const std::vector theta{0.5, 70.0};
  CHECK(law->friction({3e-6, 1}, theta) == Approx(0.601867168364214617).epsilon(1e-15));
  const auto rate = law->rate({-3e-6, 1}, theta);
  CHECK(rate[0] == Approx(1 - 3e-6 * 0.5 / 2e-6).epsilon(1e-14));
  CHECK(rate[1] == Approx(1 - 3e-6 * 70 / 40e-6).epsilon(1e-14));
  // Steady curve mu0 + (a - b1 - b2) ln(v/v0).
  CHECK(law->steady_friction({1e-5, 1}).friction == Approx(0.6 + (0.010 - 0.015) * std::log(10)).epsilon(1e-14));
}

TEST_CASE("two-state-ageing: without its second state it is the ageing law", "[laws][two-state-ageing]") {
  const auto two = laws::find_law("two-state-ageing")->with("b1", 0.015)->with("L1", 10e-6)->with("b2", 0.0);
  const auto one = laws::find_law("ageing");
  for (const double v : {1e-9, 1e-3})
    CHECK(two->friction({v, 1}, std::vector{3.0, 8.0}) ==
          Approx(one->friction({v, 1}, std::vector{3.0})).epsilon(1e-15));
}

TEST_CASE("two-state-ageing: negative b2, and exponents beyond the range of doubles", "[laws][two-state-ageing]") {
  const auto law = laws::find_law("two-state-ageing")->with("mu0", 5.0)->with("a", 0.005)->with("b2", -0.004);
  CHECK(law->friction({1e-6, 1}, law->steady({1e-6, 1})) == Approx(5).epsilon(1e-14));
  CHECK(law->steady_friction({1e-6, 1}).slope == Approx((0.005 - 0.009 + 0.004) / 1e-6).margin(1e-7));
}
