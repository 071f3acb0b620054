/// Dry friction behind a spring: its force, slopes and refusals.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

namespace {

ContactSetup behind(SeriesSpring spring) { return {.unknowns = Unknowns::states, .spring = spring}; }

}  // namespace

TEST_CASE("dry friction behind a spring bears k e + c u in stick and the limit in slip", "[laws][dry-spring]") {
  const auto law = laws::find_law("coulomb")->with({0.5, 0.3});
  const auto contact = law->contact(behind({.compliance = 1 / 8.0, .damping = 2}));
  const double e = 0.1;
  double g, F;
  contact->evaluate({0.25, 4, 0, 0}, &e, &g, F);
  CHECK(g == 0.25);
  CHECK(F == 8 * 0.1 + 2 * 0.25);
  contact->evaluate({0.25, 4, 0, -1}, &e, &g, F);
  CHECK(F == Approx(-0.3 * 4).epsilon(1e-15));
  CHECK(g == Approx((-0.3 * 4 - 8 * 0.1) / 2).epsilon(1e-15));
}

TEST_CASE("slopes of dry friction behind a spring are those of its values", "[laws][dry-spring]") {
  const SeriesSpring springs[] = {{.compliance = 0.125},
                                  {.compliance_per_load = 0.5},
                                  {.compliance = 0.125, .damping = 2},
                                  {.compliance_per_load = 0.5, .damping_per_load = 0.7}};
  const auto law = laws::find_law("coulomb")->with({0.3, 0.3});
  for (const auto& spring : springs)
    for (const double direction : {-1.0, 0.0, 1.0}) {
      const auto contact = law->contact(behind(spring));
      const double e = 0.1, u = 0.25 * (direction == 0 ? 1 : direction), N = 4, d = 1e-6;
      double g, F;
      Slopes<double> slopes;
      contact->linearise({u, N, 0, direction}, &e, &g, F, slopes);
      const auto difference = [&](double du, double dN, double de, double& of_F) {
        double high[2], low[2];
        const double above = e + de, below = e - de;
        contact->evaluate({u + du, N + dN, 0, direction}, &above, &high[0], high[1]);
        contact->evaluate({u - du, N - dN, 0, direction}, &below, &low[0], low[1]);
        of_F = (high[1] - low[1]) / (2 * d);
        return (high[0] - low[0]) / (2 * d);
      };
      double F_u, F_N, F_e;
      const double g_u = difference(d, 0, 0, F_u), g_N = difference(0, d, 0, F_N), g_e = difference(0, 0, d, F_e);
      CAPTURE(direction, spring.compliance, spring.damping);
      CHECK(slopes.g_u[0] == Approx(g_u).margin(1e-8));
      CHECK(slopes.g_N[0] == Approx(g_N).margin(1e-8));
      CHECK(slopes.g_z[0] == Approx(g_e).margin(1e-8));
      CHECK(slopes.F_u == Approx(F_u).margin(1e-8));
      CHECK(slopes.F_N == Approx(F_N).margin(1e-8));
      CHECK(slopes.F_z[0] == Approx(F_e).margin(1e-8));
    }
}

TEST_CASE("friction that would jump behind a spring is refused with the reason", "[laws][dry-spring]") {
  const auto above = laws::find_law("coulomb")->with({0.4, 0.3});
  CHECK_THROWS_WITH(above->contact(behind({.compliance = 1})), Catch::Contains("mu_s = 0.4 is above mu_d = 0.3") &&
                                                                   Catch::Contains("slip would begin with a jump"));
  CHECK_NOTHROW(above->contact(behind({.compliance = 1, .damping = 1})));
  const auto falling = laws::find_law("stribeck");
  CHECK_THROWS_WITH(falling->contact(behind({.compliance = 1, .damping = 1})), Catch::Contains("changes with slip"));
}
