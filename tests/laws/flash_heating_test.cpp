/// Flash heating after Noda, Dunham & Rice (2009): the steady curve, and decay towards it over slip.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("flash-heating: the steady curve turns from logarithmic to 1/v", "[laws][flash-heating]") {
  const auto law = laws::find_law("flash-heating");
  const struct {
    double v, mu, slope;
  } expected[] = {{1e-6, 0.7, -4000.0},
                  {1e-2, 0.663158638502541492, -0.400000007635854},
                  {0.17, 0.608516354818045192, -1.42897760930495},
                  {1, 0.217505445190377117, -0.0881853840894497},
                  {10, 0.138593969495734827, -0.000866196949573477}};  // the paper's formula in 40-digit arithmetic
  for (const auto& e : expected) {
    CHECK(law->steady_friction({e.v, 1}).friction == Approx(e.mu).epsilon(1e-13));
    CHECK(law->steady_friction({e.v, 1}).slope == Approx(e.slope).epsilon(1e-12));
  }
  // Beeler et al. (2008): mu_w + (mu_LV - mu_w) v_w/v above v_w.
  const double low_speed = 0.7 - 0.004 * std::log(1e6);
  CHECK(law->steady_friction({1, 1}).friction == Approx(0.13 + (low_speed - 0.13) * 0.17).epsilon(1e-6));
}

TEST_CASE("flash-heating: far below v_w it is the slip law", "[laws][flash-heating]") {
  const auto slip = laws::find_law("slip")->with("mu0", 0.7)->with("a", 0.016)->with("b", 0.02)->with("L", 20e-6);
  const auto law = laws::find_law("flash-heating");
  for (const double v : {1e-8, 1e-5}) {
    const double theta = 3.0, psi = 0.7 + 0.02 * std::log(1e-6 * theta / 20e-6);
    CHECK(law->friction({v, 1}, std::vector{psi}) == Approx(slip->friction({v, 1}, std::vector{theta})).epsilon(1e-12));
    const double psi_rate = 0.02 * slip->rate({v, 1}, std::vector{theta})[0] / theta;
    CHECK(law->rate({v, 1}, std::vector{psi})[0] == Approx(psi_rate).epsilon(1e-9));
  }
}

TEST_CASE("flash-heating: at constant speed friction decays over the slip L", "[laws][flash-heating]") {
  const auto law = laws::find_law("flash-heating");
  const double v = 2, steady = law->steady({v, 1})[0];
  for (const double away : {-0.05, 0.2})
    CHECK(law->rate({v, 1}, std::vector{steady + away})[0] == Approx(-v / 20e-6 * away).epsilon(1e-12));
}
