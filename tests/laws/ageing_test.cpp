/// Ageing law against the classical logarithmic form of Dieterich (1979), 30-digit arithmetic, and overflow.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("ageing: the classical form far above the regularised speeds", "[laws][ageing]") {
  const auto law = laws::find_law("ageing");
  const double mu0 = 0.6, a = 0.010, b = 0.015, L = 10e-6, v0 = 1e-6;
  for (const double v : {1e-12, 1e-6, 1e-2})
    for (const double theta : {1e-3, 10.0, 1e5}) {
      const double classical = mu0 + a * std::log(v / v0) + b * std::log(v0 * theta / L);
      CHECK(law->friction({v, 1}, std::vector{theta}) == Approx(classical).epsilon(1e-14));
    }
  CHECK(law->friction({3e-6, 1}, std::vector{2.0}) == Approx(0.586844554200169591).epsilon(1e-15));
  CHECK(law->steady_friction({1e-5, 1}).friction == Approx(0.6 - 0.005 * std::log(10)).epsilon(1e-14));
}

TEST_CASE("ageing: linear in the slip rate at rest, where the logarithm would diverge", "[laws][ageing]") {
  const auto law = laws::find_law("ageing");
  CHECK(law->friction({1e-32, 1}, std::vector{2.0}) == Approx(5.10499466799108687e-4).epsilon(1e-13));
  CHECK(law->rate({0, 1}, std::vector{2.0})[0] == 1);  // contacts age by a second each second
}

TEST_CASE("ageing: exponents beyond the range of doubles", "[laws][ageing]") {
  const auto law = laws::find_law("ageing")->with("mu0", 5.0)->with("a", 0.005);  // mu0/a = 1000
  const auto steady = law->steady({1e-6, 1});
  CHECK(law->friction({1e-6, 1}, steady) == Approx(5).epsilon(1e-14));
  CHECK(law->slip_rate(5, 1, steady) == Approx(1e-6).epsilon(1e-11));
  const auto curve = law->steady_friction({1e-6, 1});
  CHECK(curve.slope == Approx((0.005 - 0.015) / 1e-6).epsilon(1e-12));
  for (const double v : {1e-300, 1e-100, 1e-20, 1.0, 1e5}) CHECK(std::isfinite(law->friction({v, 1}, steady)));
}
