/// Coulomb friction: constant in motion, set-valued at rest, static never below dynamic.
#include "laws/coulomb.hpp"

#include <catch2/catch.hpp>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("coulomb: a force that knows only the direction of slip", "[laws][coulomb]") {
  const auto law = laws::make_law<laws::Coulomb>({.mu_s = 0.4, .mu_d = 0.3});
  CHECK(law->set_valued());
  CHECK(law->static_limit(2) == 0.4);
  for (const double v : {1e-300, 1e-6, 1e3}) {
    CHECK(law->friction({v, 2}, {}) == 0.3);
    CHECK(law->friction({-v, 2}, {}) == -0.3);
    CHECK(law->steady_friction({-v, 2}).slope == 0);
  }
  const auto contact = law->contact({.unknowns = Unknowns::states});
  double F;
  for (const double direction : {1.0, -1.0}) {  // slip about to start: u = 0, the direction decides
    contact->evaluate({0, 2, 0, direction}, nullptr, nullptr, F);
    CHECK(F == direction * 0.6);
  }
}

TEST_CASE("coulomb: refuses friction at rest below friction in motion", "[laws][coulomb]") {
  CHECK_THROWS_WITH(laws::make_law<laws::Coulomb>({.mu_s = 0.2, .mu_d = 0.3}),
                    Catch::Contains("law.mu_s = 0.2 is below law.mu_d = 0.3"));
  CHECK_NOTHROW(laws::make_law<laws::Coulomb>({.mu_s = 0.3, .mu_d = 0.3}));
}
