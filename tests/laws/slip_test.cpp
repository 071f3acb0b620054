/// Slip law against Ruina (1983): no healing at rest, linearised like the ageing law, steps up and down alike.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("slip: friction of the ageing law, evolution by slip alone", "[laws][slip]") {
  const auto law = laws::find_law("slip"), ageing = laws::find_law("ageing");
  const std::vector theta{2.0};
  CHECK(law->friction({3e-6, 1}, theta) == Approx(0.586844554200169591).epsilon(1e-15));  // 30-digit arithmetic
  CHECK(law->friction({3e-6, 1}, theta) == ageing->friction({3e-6, 1}, theta));
  CHECK(law->rate({0, 1}, theta)[0] == 0);
  // x = v theta/L = 0.2 and its mirror image x = 5 about the steady state: d ln x/dt = -(v/L) ln x is odd in ln x.
  CHECK(law->rate({1e-6, 1}, theta)[0] == Approx(0.2 * std::log(5.0)).epsilon(1e-14));
  CHECK(law->rate({1e-6, 1}, std::vector{50.0})[0] / 50 == Approx(-law->rate({1e-6, 1}, theta)[0] / 2).epsilon(1e-14));
}

TEST_CASE("slip: indistinguishable from ageing for small departures from steady sliding", "[laws][slip]") {
  // At steady state both have dG/dtheta = v/L and dG/dv = 1/v, so that linear stability cannot tell them apart.
  const ContactSetup setup{.unknowns = Unknowns::states};
  double z, weight, g, F;
  Slopes<double> s, t;
  const auto slip = laws::find_law("slip")->contact(setup), ageing = laws::find_law("ageing")->contact(setup);
  slip->steady(0, 1e-5, 5, &z, &weight);
  slip->linearise({1e-5, 5, 0, 1}, &z, &g, F, s);
  ageing->linearise({1e-5, 5, 0, 1}, &z, &g, F, t);
  CHECK(s.g_z[0] == Approx(-1.0).epsilon(1e-14));  // v/L, with z = ln theta
  CHECK(s.g_z[0] == Approx(t.g_z[0]).epsilon(1e-14));
  CHECK(s.g_u[0] == Approx(t.g_u[0]).epsilon(1e-14));
  CHECK(s.F_u == Approx(t.F_u).epsilon(1e-14));
}

TEST_CASE("slip: exponents beyond the range of doubles", "[laws][slip]") {
  const auto law = laws::find_law("slip")->with("mu0", 5.0)->with("a", 0.005);
  CHECK(law->friction({1e-6, 1}, law->steady({1e-6, 1})) == Approx(5).epsilon(1e-14));
  CHECK(law->steady_friction({1e-6, 1}).slope == Approx((0.005 - 0.015) / 1e-6).epsilon(1e-12));
}
