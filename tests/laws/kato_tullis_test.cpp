/// Composite law of Kato & Tullis (2001): its steady age by Lambert's function, and the laws that it lies between.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("kato-tullis: steady age and friction", "[laws][kato-tullis]") {
  // theta = (L/v) y/W(y), y = exp(-v/v_c), W Lambert's function, in 40 digits.
  const auto law = laws::find_law("kato-tullis");
  const struct {
    double v, mu, theta;
  } expected[] = {{1e-12, 0.677584159312634867, 17631590.2643124229},
                  {3e-9, 0.636024133384565665, 5307.92347718046713},
                  {1e-8, 0.627202819071356564, 1321.09976201561746},
                  {1e-7, 0.611513606433001467, 100.004539889924805}};
  for (const auto& e : expected) {
    CHECK(law->steady({e.v, 1})[0] == Approx(e.theta).epsilon(1e-14));
    CHECK(law->steady_friction({e.v, 1}).friction == Approx(e.mu).epsilon(1e-14));
  }
}

TEST_CASE("kato-tullis: heals at rest like ageing and evolves at speed like slip", "[laws][kato-tullis]") {
  const auto law = laws::find_law("kato-tullis"), slip = laws::find_law("slip");
  CHECK(law->rate({0, 1}, std::vector{30.0})[0] == 1);
  for (const double theta : {0.1, 1.0, 50.0}) {
    const std::vector<double> state{theta};
    CHECK(law->rate({1e-5, 1}, state)[0] == Approx(slip->rate({1e-5, 1}, state)[0]).epsilon(1e-14));
    CHECK(law->friction({1e-5, 1}, state) == slip->friction({1e-5, 1}, state));
  }
}
