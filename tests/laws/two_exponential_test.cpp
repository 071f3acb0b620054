/// Two-exponential curve against the violin rosin of Smith & Woodhouse (2000).
#include <catch2/catch.hpp>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("two-exponential: violin rosin", "[laws][two-exponential]") {
  const auto rosin_law = laws::preset(*laws::find_law("two-exponential"), "violin-rosin");
  // mu = 0.4 e^{-v/0.01} + 0.45 e^{-v/0.1} + 0.35 and its derivative, 30-digit arithmetic.
  struct {
    double v, mu, slope;
  } const expected[] = {{1e-12, 1.1999999999555, -44.499999995955},
                        {0.001, 1.157457392401509453, -40.648720973309639},
                        {0.01, 0.904328614584758737, -18.786946028019511},
                        {0.1, 0.515563908499054039, -1.657273482461989841},
                        {1, 0.350020429968393118, -2.042996839311818e-4}};
  for (const auto& e : expected) {
    CHECK(rosin_law->friction({e.v, 1}, {}) == Approx(e.mu).epsilon(1e-15));
    CHECK(rosin_law->steady_friction({e.v, 1}).slope == Approx(e.slope).epsilon(1e-13));
  }
  CHECK(rosin_law->static_limit(1) == Approx(1.2).epsilon(1e-15));
  CHECK(rosin_law->friction({1e6, 1}, {}) == 0.35);
}
