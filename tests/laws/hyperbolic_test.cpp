/// Hyperbolic curve against the block on a belt of Leine, van Campen, de Kraker & van den Steen (1998).
#include <catch2/catch.hpp>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("hyperbolic: friction of the block on a belt", "[laws][hyperbolic]") {
  // F_s = 1 N, delta = 3 s/m, belt speed 0.2 m/s, k = 1 N/m: steady sliding at x = F/k = 1/1.6 = 0.625 m.
  const auto law = laws::preset(*laws::find_law("hyperbolic"), "leine");
  CHECK(law->friction({0.2, 1}, {}) == Approx(0.625).epsilon(1e-15));
  CHECK(law->steady_friction({0.2, 1}).slope == Approx(-3 / 2.56).epsilon(1e-14));
  CHECK(law->static_limit(1) == 1);
}

TEST_CASE("hyperbolic: delta = 0 is a constant, extremes stay finite", "[laws][hyperbolic]") {
  const auto flat = laws::find_law("hyperbolic")->with("mu_s", 1.0)->with("delta", 0.0);
  for (const double v : {1e-300, 1.0, 1e300}) CHECK(flat->friction({v, 1}, {}) == 1);
  CHECK(flat->steady_friction({1.0, 1}).slope == 0);
  CHECK(laws::find_law("hyperbolic")->with("delta", 1e9)->friction({1e300, 1}, {}) >= 0);
}
