/// Steady curves against the closed-form extrema of the spinodal law and mpmath values.
#include "analysis/steady/curve.hpp"

#include <catch2/catch.hpp>

#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::steady;

TEST_CASE("the extrema of the Bristol-board curve are those of the closed form", "[curve]") {
  // a c y² + [2ac − (b−a)(1+R)] y + a(c+1+R) = 0, V = y L/t; evaluated with 40 digits.
  const auto extrema = steady_extrema(*laws::find_law("spinodal"), 1e-12, 1);
  REQUIRE(extrema.size() == 2);
  CHECK(extrema[0].maximum);
  CHECK_FALSE(extrema[1].maximum);
  CHECK(extrema[0].slip_rate == Approx(2.493158313443845e-8).epsilon(1e-12));
  CHECK(extrema[1].slip_rate == Approx(4.051126615400747e-4).epsilon(1e-12));
  CHECK(std::abs(extrema[0].slip_rate - 2.493158313443845e-8) <= extrema[0].slip_rate_error);
  CHECK(std::abs(extrema[1].slip_rate - 4.051126615400747e-4) <= extrema[1].slip_rate_error);
  CHECK(extrema[0].friction_coefficient == Approx(0.4046791231914262).epsilon(1e-14));
  CHECK(extrema[1].friction_coefficient == Approx(0.3019193540022322).epsilon(1e-14));
}

TEST_CASE("a law that only weakens or only strengthens has no extremum", "[curve]") {
  const auto ageing = laws::find_law("ageing");
  CHECK(steady_extrema(*ageing, 1e-12, 1).empty());
  CHECK(weakens_somewhere(*ageing, 1));
  CHECK_FALSE(weakens_somewhere(*ageing->with("b", 0.005), 1));
}
