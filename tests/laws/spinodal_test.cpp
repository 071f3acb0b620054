/// Spinodal law against 40-digit arithmetic and the closed forms of Woodhouse, Putelat & McKay (2015).
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

namespace {

/// Zero of the slope of the steady curve between two slip rates, by bisection of ln v.
double extremum(const FrictionLaw& law, double low, double high) {
  const auto slope = [&](double v) { return law.steady_friction({v, 1}).slope; };
  const bool rising = slope(low) > 0;
  while (high / low > 1 + 1e-14) {
    const double middle = std::sqrt(low * high);
    ((slope(middle) > 0) == rising ? low : high) = middle;
  }
  return low;
}

}  // namespace

TEST_CASE("spinodal: steady curve of Bristol board", "[laws][spinodal]") {
  const auto board = laws::preset(*laws::find_law("spinodal"), "bristol-board");
  // Table 1 of the paper, mu0 = 0.369; values from 40-digit arithmetic without hand-written derivatives.
  struct {
    double v, mu, slope;
  } const expected[] = {{1e-9, 0.3489385988881746, 30454593.743874},  {1e-8, 0.4000650249642715, 1045048.414652},
                        {1e-6, 0.3690488755890891, -13467.474092451}, {1e-5, 0.3376837611535792, -1347.1741680293},
                        {1e-4, 0.3096263736154155, -95.89744394061},  {1e-3, 0.306429969113871, 10.328725679781}};
  for (const auto& e : expected) {
    CHECK(board->steady_friction({e.v, 1}).friction == Approx(e.mu).epsilon(1e-14));
    CHECK(board->steady_friction({e.v, 1}).slope == Approx(e.slope).epsilon(1e-12));
  }

  const double v_max = extremum(*board, 1e-9, 1e-6), v_min = extremum(*board, 1e-6, 1e-2);
  CHECK(v_max == Approx(2.493158313443845e-8).epsilon(1e-12));
  CHECK(v_min == Approx(4.051126615400747e-4).epsilon(1e-12));
  CHECK(board->steady_friction({v_max, 1}).friction == Approx(0.4046791231914262).epsilon(1e-14));
  CHECK(board->steady_friction({v_min, 1}).friction == Approx(0.3019193540022322).epsilon(1e-14));
  // Section 2 of the paper approximates the extrema by (L/t)/(b/a - 1) and (b/a - 1) v0/c.
  CHECK(v_max == Approx(0.9e-6 / 90 / (0.0489 / 0.0349 - 1)).epsilon(1e-3));
  CHECK(v_min == Approx((0.0489 / 0.0349 - 1) * 1e-6 / 1e-3).epsilon(0.02));
}

TEST_CASE("spinodal: partial derivatives at steady sliding", "[laws][spinodal]") {
  const auto board = laws::find_law("spinodal");
  const auto contact = board->contact({.lambda = 10, .unknowns = Unknowns::states});
  double z, weight, g, F;
  Slopes<double> s;
  contact->steady(0, 1e-5, 1, &z, &weight);
  contact->linearise({1e-5, 1, 0, 1}, &z, &g, F, s);
  const double psi = std::exp(z);
  CHECK(psi == Approx(1 / 1001.0).epsilon(1e-14));
  CHECK(s.F_u == Approx(3489.9999724828).epsilon(1e-13));
  CHECK(s.F_z[0] / psi == Approx(48.468533259673).epsilon(1e-13));  // z = ln psi
  CHECK(s.g_z[0] == Approx(-11.122222222222).epsilon(1e-13));       // -dG/dpsi at lambda = 1: 1/t_heal + v/L
}

TEST_CASE("spinodal: healing saturates and large exponents do not overflow", "[laws][spinodal]") {
  const auto law = laws::find_law("spinodal");
  const double healed[] = {1.0};
  CHECK(law->rate({0, 1}, healed)[0] == 0);
  CHECK(law->rate({0, 1}, std::vector{0.0})[0] == Approx(1 / 90.0));
  CHECK(law->steady({0, 1})[0] == 1);
  const auto stiff = law->with("mu0", 5.0)->with("a", 0.005);  // mu0/a = 1000: e^1000 is not a double
  CHECK(stiff->friction({1e-6, 1}, law->steady({1e-6, 1})) == Approx(5 + 0.0489 * std::log(1.001)).epsilon(1e-14));
  CHECK(stiff->steady_friction({1e-6, 1}).slope == Approx((0.005 - 0.0489 * 100 / 101 / 1.001) / 1e-6).epsilon(1e-12));
}
